#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {

/// The unit of a number that counts time since 1970 ("s", "ms", "us", "ns": the years 2001 to 2096), or nullptr.
[[nodiscard]] const Unit* unit_since_1970(double stamp);

/// Recognises the time under a name other than "time" or "t" ("timestamp", "tout", "Elapsed
/// Time", "Zeit", "__time", "rosbagTimestamp(ns)", …), with the unit given by its name or, for times since 1970, by its
/// size. A file with an array called "time" or with clocks is unchanged.
/// @fails  data: two arrays have such names, and different times.
[[nodiscard]] Result<void> name_time(Contents& contents);

/// Increasing arrays whose names suggest time: "t_robot", "sensor.stamp".
[[nodiscard]] std::vector<const Array*> possible_times(const Contents& contents);

/// Notes on such arrays that differ from the time in use by more than a sample and their rounding.
[[nodiscard]] std::vector<std::string> other_times(const Contents& contents, const Array& time, const Unit* unit);

}  // namespace mbk::recording
