#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A CSV file of Delsys EMGworks or Trigno Discover, in which each signal has its own column of time before it.
[[nodiscard]] bool looks_like_delsys(std::string_view text);

/// Reads each signal with its own clock; signals of equal times share one.
/// @fails  data: what is not a number; a row with too many cells.
[[nodiscard]] Result<Contents> decode_delsys(std::span<const std::byte> file);

}  // namespace mbk::recording
