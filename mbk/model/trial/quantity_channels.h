#pragma once

#include <array>
#include <cstddef>

#include "mbk/base/core/columns.h"
#include "mbk/model/trial/recording.h"

namespace mbk {

/// The channels of one quantity that a trial measures.
struct QuantityChannels {
  const char* one_axis;                ///< for one axis; null: exists only with several
  std::array<const char*, 3> several;  ///< of x, y and z, or of joints 1, 2 and 3
  const char* unit;                    ///< with several axes
  const char* frame;                   ///< with several axes

  /// "hand_x", "force_y"; with one axis "position", "reaction".   @param axes 1, 2 or 3
  [[nodiscard]] constexpr const char* name(int axes, Index axis) const {
    return axes == 1 ? one_axis : several[static_cast<std::size_t>(axis)];
  }
};

inline constexpr QuantityChannels kPositionChannels = {"position", {"hand_x", "hand_y", "hand_z"}, "m", "base"};
inline constexpr QuantityChannels kForceChannels = {"reaction", {"force_x", "force_y", "force_z"}, "N", "base"};
/// In N if a force is commanded.
inline constexpr QuantityChannels kReferenceChannels = {
    "reference", {"reference_x", "reference_y", "reference_z"}, "m", "base"};
inline constexpr QuantityChannels kAccelerationChannels = {
    "acceleration", {"acceleration_x", "acceleration_y", "acceleration_z"}, "m/s2", "base"};
inline constexpr QuantityChannels kJointChannels = {nullptr, {"joint_1", "joint_2", "joint_3"}, "rad", "joint"};
inline constexpr QuantityChannels kTorqueChannels = {nullptr, {"torque_1", "torque_2", "torque_3"}, "N.m", "joint"};

/// References to the channels of a quantity in the recording; nothing if one is missing.   @param axes 1, 2 or 3
[[nodiscard]] inline Columns channels_of(const Recording& recording, const QuantityChannels& quantity, int axes) {
  Columns columns;
  for (Index axis = 0; axis < axes; ++axis) {
    const Channel* channel = recording.find(quantity.name(axes, axis));
    if (channel == nullptr) return {};
    columns.add(channel->values);
  }
  return columns;
}

/// The same, copied.
[[nodiscard]] inline Matrix recorded(const Recording& recording, const QuantityChannels& quantity, int axes) {
  const Columns columns = channels_of(recording, quantity, axes);
  return columns.middle_rows(0, columns.rows());
}

}  // namespace mbk
