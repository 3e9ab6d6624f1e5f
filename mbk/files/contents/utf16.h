#pragma once

#include <string>
#include <string_view>

namespace mbk::recording {

/// Halves of surrogate pairs that stand alone become U+FFFD.
[[nodiscard]] std::string utf8_from_utf16(std::u16string_view text);

/// @param text  valid UTF-8, as `printable` gives it
[[nodiscard]] std::u16string utf16_from_utf8(std::string_view text);

}  // namespace mbk::recording
