#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {

/// The unit in which a number counts time since 1970 ("s", "ms", "us", "ns": the years 2001 to 2096), or nullptr.
[[nodiscard]] const Unit* unit_since_1970(double stamp);

/// Gives the array its meaning that is the time by another name than "time" or "t" ("timestamp", "tout", "Elapsed
/// Time", "Zeit", "__time", "rosbagTimestamp(ns)", …), with the unit that its name or, since 1970, its size says. A
/// file with an array called "time" or with clocks stays as it is.
/// @fails  data: two arrays have such names, and different times.
[[nodiscard]] Result<void> name_time(Contents& contents);

/// Arrays whose names speak of time and which run on: "t_robot", "sensor.stamp".
[[nodiscard]] std::vector<const Array*> possible_times(const Contents& contents);

/// What such arrays say that differ from the time that was taken by more than a sample and their own rounding.
[[nodiscard]] std::vector<std::string> other_times(const Contents& contents, const Array& time, const Unit* unit);

}  // namespace mbk::recording
