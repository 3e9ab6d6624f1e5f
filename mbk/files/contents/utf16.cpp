#include "mbk/files/contents/utf16.h"

#include <bit>

namespace mbk::recording {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

bool is_high_surrogate(char32_t c) {
  return c >= 0xD800 && c < 0xDC00;
}

bool is_low_surrogate(char32_t c) {
  return c >= 0xDC00 && c < 0xE000;
}

void append_utf8(std::string& out, char32_t c) {
  const auto continuation = [&](unsigned shift) { out += static_cast<char>(0x80u | ((c >> shift) & 0x3Fu)); };
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0u | (c >> 6u));
    continuation(0);
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0u | (c >> 12u));
    continuation(6);
    continuation(0);
  } else {
    out += static_cast<char>(0xF0u | (c >> 18u));
    continuation(12);
    continuation(6);
    continuation(0);
  }
}

}  // namespace

std::string utf8_from_utf16(std::u16string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char32_t c = text[i];
    if (is_high_surrogate(c) && i + 1 < text.size() && is_low_surrogate(text[i + 1])) {
      c = 0x10000 + ((c - 0xD800) << 10u) + (text[++i] - 0xDC00u);
    } else if (is_high_surrogate(c) || is_low_surrogate(c)) {
      c = kReplacement;
    }
    append_utf8(out, c);
  }
  return out;
}

std::u16string utf16_from_utf8(std::string_view text) {
  std::u16string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int more = first < 0x80 ? 0 : std::countl_one(first) - 1;
    char32_t c = more == 0 ? first : first & (0x3Fu >> static_cast<unsigned>(more));
    for (int k = 0; k < more && i < text.size(); ++k) c = (c << 6u) | (static_cast<unsigned char>(text[i++]) & 0x3Fu);
    if (c < 0x10000) {
      out += static_cast<char16_t>(c);
    } else {
      out += static_cast<char16_t>(0xD800u + ((c - 0x10000) >> 10u));
      out += static_cast<char16_t>(0xDC00u + ((c - 0x10000) & 0x3FFu));
    }
  }
  return out;
}

}  // namespace mbk::recording
