#include "mbk/base/core/printable.h"

#include <algorithm>

namespace mbk {
namespace {

unsigned char code(char c) {
  return static_cast<unsigned char>(c);
}

/// Bytes of the UTF-8 character that begins at `i`; 0 where there is none.
std::size_t character(std::string_view text, std::size_t i) {
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

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character(text, i);
    if (size == 0) return false;
    i += size;
  }
  return true;
}

/// A control character: C0, DEL, or one of C1, which some terminals obey as well.
bool is_control(std::string_view one) {
  const unsigned char first = code(one[0]);
  return first < 0x20 || first == 0x7F || (one.size() == 2 && first == 0xC2 && code(one[1]) < 0xA0);
}

/// The Latin-1 character of a byte, as UTF-8.
void add_latin(std::string& text, unsigned char byte) {
  if (byte < 0xA0) {
    text += '?';
    return;
  }
  text += static_cast<char>(0xC0u | (byte >> 6u));
  text += static_cast<char>(0x80u | (byte & 0x3Fu));
}

/// With '?' for control characters but those in `kept`.    @param utf8  false: every byte is Latin-1
std::string without_controls(std::string_view text, bool utf8, std::string_view kept) {
  std::string made;
  made.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = utf8 || code(text[i]) < 0x80 ? character(text, i) : 0;
    const std::string_view one = text.substr(i, std::max<std::size_t>(size, 1));
    if (size == 0) {
      add_latin(made, code(one[0]));
    } else if (is_control(one) && kept.find(one[0]) == std::string_view::npos) {
      made += '?';
    } else {
      made += one;
    }
    i += one.size();
  }
  return made;
}

}  // namespace

std::string printable(std::string text) {
  return without_controls(text, is_utf8(text), "");
}

std::string printable_lines(std::string_view text) {
  return without_controls(text, true, "\n\t");
}

}  // namespace mbk
