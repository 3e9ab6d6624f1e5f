#pragma once

#include <array>
#include <cstddef>

#include "mbk/model/trial/recording.h"

namespace mbk {

/// The channels of one quantity that a trial measures.
struct QuantityChannels {
  const char* one_axis;              ///< where there is one axis; null: the plane alone has it
  std::array<const char*, 2> plane;  ///< of x and y, or of joint 1 and 2
  const char* unit;                  ///< in the plane
  const char* frame;                 ///< in the plane

  /// "hand_x", "force_y"; with one axis "position", "reaction".   @param axes 1 or 2
  [[nodiscard]] constexpr const char* name(int axes, Index axis) const {
    return axes == 1 ? one_axis : plane[static_cast<std::size_t>(axis)];
  }
};

inline constexpr QuantityChannels kPositionChannels = {"position", {"hand_x", "hand_y"}, "m", "base"};
inline constexpr QuantityChannels kForceChannels = {"reaction", {"force_x", "force_y"}, "N", "base"};
/// In N where a force is commanded.
inline constexpr QuantityChannels kReferenceChannels = {"reference", {"reference_x", "reference_y"}, "m", "base"};
inline constexpr QuantityChannels kAccelerationChannels = {
    "acceleration", {"acceleration_x", "acceleration_y"}, "m/s2", "base"};
inline constexpr QuantityChannels kJointChannels = {nullptr, {"joint_1", "joint_2"}, "rad", "joint"};
inline constexpr QuantityChannels kTorqueChannels = {nullptr, {"torque_1", "torque_2"}, "N.m", "joint"};

/// The channels of a quantity side by side, as recorded; nothing where one is missing.   @param axes 1 or 2
[[nodiscard]] inline Matrix recorded(const Recording& recording, const QuantityChannels& quantity, int axes) {
  Matrix columns(recording.samples(), axes);
  for (Index axis = 0; axis < axes; ++axis) {
    const Channel* channel = recording.find(quantity.name(axes, axis));
    if (channel == nullptr) return {};
    columns.col(axis) = channel->values;
  }
  return columns;
}

}  // namespace mbk
