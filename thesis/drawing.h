#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/chart.h"
#include "thesis/workbench.h"

/// What the figures are drawn with. For the sources of this module only.
namespace mbk::thesis {

inline constexpr Index kDrawnPoints = 600;  ///< of a line, at most about

/// A line through every Nth point.
[[nodiscard]] ChartSeries line(std::string name, const Vector& x, const Vector& y);

/// An empty chart over time.
[[nodiscard]] Chart over_time(ChartAxis y);

/// Samples of a recording, by time from its first sample [s].
struct Part {
  Index begin = 0, size = 0;
};
[[nodiscard]] Part part_of(const Recording& recording, double from_s, double to_s);

/// Force and hand position as recorded, with the reference that the robot followed beside the one it is of: typical
/// data, as figures 3.4, 4.1 and 4.6 show. Places are from the mean.
/// @param axes  1: only y
[[nodiscard]] std::vector<Chart> signal_charts(const std::string& what, const Recording& recording, double from_s,
                                               double to_s, int axes = 2);

/// Energy absorbed by everyone in the first trial of a task, J over s.
[[nodiscard]] Chart energy_chart(const std::vector<TaskResult>& results);

/// The closed curve centre + scale Z e(φ), φ from 0 to 2π: the forces of a unit motion that goes once round.
[[nodiscard]] ChartSeries ellipse_curve(std::string name, const Matrix& Z, const Eigen::Vector2d& centre, double scale);

/// Lines from each of the first points to that of the second, as one series.
[[nodiscard]] ChartSeries rays(std::string name, const std::vector<Eigen::Vector2d>& from,
                               const std::vector<Eigen::Vector2d>& to);

}  // namespace mbk::thesis
