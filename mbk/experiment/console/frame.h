#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "mbk/files/journal/tick.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::console {

inline constexpr std::size_t kFrameHeader = 32;   ///< [bytes]
inline constexpr std::size_t kFrameColumns = 13;  ///< of one sample

/// Samples as a page gets them, low byte first:
///   "MBKF", version 1 and columns (16 bits each), samples and trial (32 bits each), time of the first sample [s] and
///   its tick's number (64-bit floating point), then sample by sample 32-bit floating point numbers: time since the
///   first sample [s], hand x, y [m], force of the hand on the robot x, y [N], reference x, y [m or N; NaN behind a
///   stop and at the end], acceleration of the hand x, y [m/s²], torques [N·m], compute time of the tick before [µs],
///   lateness [µs].
/// @param ticks  at least one   @param trial  number in the list, from 0
[[nodiscard]] std::string frame(std::span<const journal::Tick> ticks, const robot::Geometry& geometry,
                                std::uint32_t trial);

}  // namespace mbk::console
