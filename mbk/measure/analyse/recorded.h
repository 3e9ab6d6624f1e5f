#pragma once

#include <array>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// A quantity's channel with one axis, and those of x and y with two.
using Names = std::array<const char*, 3>;
inline constexpr Names kPosition = {"position", "hand_x", "hand_y"};
inline constexpr Names kForce = {"reaction", "force_x", "force_y"};
inline constexpr Names kReference = {"reference", "reference_x", "reference_y"};

/// The channels of a quantity side by side, as recorded; nothing where one is missing.   @param axes 1 or 2
[[nodiscard]] inline Matrix recorded(const Recording& recording, int axes, const Names& names) {
  Matrix columns(recording.samples(), axes);
  for (Index k = 0; k < axes; ++k) {
    const Channel* channel = recording.find(names[axes == 1 ? 0 : static_cast<std::size_t>(k) + 1]);
    if (channel == nullptr) return {};
    columns.col(k) = channel->values;
  }
  return columns;
}

}  // namespace mbk::analyse
