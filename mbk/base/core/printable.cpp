#include "mbk/base/core/printable.h"

#include <algorithm>

namespace mbk {
namespace {

unsigned char code(char c) {
  return static_cast<unsigned char>(c);
}

/// Bytes of the UTF-8 character that begins at `i`; 0 where there is none.
std::size_t character(const std::string& text, std::size_t i) {
  const unsigned char first = code(text[i]);
  if (first < 0x80) return 1;
  const std::size_t size =
      first >= 0xC2 && first < 0xE0 ? 2 : (first >= 0xE0 && first < 0xF0 ? 3 : (first >= 0xF0 && first < 0xF5 ? 4 : 0));
  if (size == 0 || text.size() - i < size) return 0;
  for (std::size_t k = 1; k < size; ++k) {
    if ((code(text[i + k]) & 0xC0u) != 0x80u) return 0;
  }
  const unsigned char second = code(text[i + 1]);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return overlong || beyond ? 0 : size;
}

bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character(text, i);
    if (size == 0) return false;
    i += size;
  }
  return true;
}

}  // namespace

std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return code(c) < 0x20 || c == 0x7F; }, '?');
  if (is_utf8(text)) return text;
  std::string converted;
  for (const char c : text) {
    const unsigned char byte = code(c);
    if (byte < 0x80) {
      converted += c;
    } else if (byte < 0xA0) {
      converted += '?';
    } else {
      converted += static_cast<char>(0xC0u | (byte >> 6u));
      converted += static_cast<char>(0x80u | (byte & 0x3Fu));
    }
  }
  return converted;
}

}  // namespace mbk
