#include "thesis/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "thesis/exhibits.h"

namespace mbk::thesis {

ChartSeries line(std::string name, const Vector& x, const Vector& y) {
  ChartSeries series;
  series.name = std::move(name);
  series.drawn = ChartSeries::Drawn::line;
  const Index every = std::max<Index>(1, x.size() / kDrawnPoints);
  for (Index i = 0; i < x.size(); i += every) {
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  }
  return series;
}

Chart over_time(ChartAxis y) {
  Chart chart;
  chart.x = {"time", "s"};
  chart.y = std::move(y);
  return chart;
}

Part part_of(const Recording& recording, double from_s, double to_s) {
  const double zero = recording.time[0];
  const auto at = [&](double seconds) {
    return std::lower_bound(recording.time.begin(), recording.time.end(), zero + seconds) - recording.time.begin();
  };
  return {at(from_s), at(to_s) - at(from_s)};
}

std::vector<Chart> signal_charts(const std::string& what, const Recording& recording, double from_s, double to_s,
                                 int axes) {
  const Part part = part_of(recording, from_s, to_s);
  const Vector time = recording.time.segment(part.begin, part.size).array() - recording.time[0];
  const auto values = [&](const char* quantity, const char* axis) -> Vector {
    return recording.find(fmt::format("{}_{}", quantity, axis))->values.segment(part.begin, part.size);
  };
  const bool force_mode = recording.find("reference_y")->unit == "N";
  std::vector<Chart> charts;
  for (const char* axis : {"x", "y"}) {
    if (axes == 1 && axis[0] == 'x') continue;
    Chart force = over_time({fmt::format("force {}", axis), "N"});
    force.title = fmt::format("{}: force, {}", what, axis);
    force.series.push_back(line("of the hand on the robot", time, values("force", axis)));
    if (force_mode) force.series.push_back(line("commanded", time, values("reference", axis)));
    Chart place = over_time({axis, "mm"});
    place.title = fmt::format("{}: hand position, {}", what, axis);
    const Vector hand = values("hand", axis);
    place.series.push_back(line("hand", time, 1e3 * (hand.array() - hand.mean()).matrix()));
    if (!force_mode) {
      place.series.push_back(line("reference", time, 1e3 * (values("reference", axis).array() - hand.mean()).matrix()));
    }
    charts.push_back(std::move(force));
    charts.push_back(std::move(place));
  }
  return charts;
}

Chart energy_chart(const std::vector<TaskResult>& results) {
  Chart chart = over_time({"energy absorbed", "J"});
  for (const TaskResult& result : results) {
    const Energy& energy = result.trials.front().energy;
    const auto inside = [&](double t) { return t >= energy.from_s && t <= energy.to_s; };
    std::vector<double> time, absorbed;
    for (Index i = 0; i < energy.curve.time.size(); ++i) {
      if (!inside(energy.curve.time[i])) continue;
      time.push_back(energy.curve.time[i] - energy.from_s);
      absorbed.push_back(energy.curve.absorbed[i]);
    }
    const auto count = std::ssize(time);
    const Vector from_zero = Eigen::Map<const Vector>(absorbed.data(), count).array() - absorbed.front();
    chart.series.push_back(line(person(result.participant), Eigen::Map<const Vector>(time.data(), count), from_zero));
  }
  chart.horizontal = {{0.0, "neither absorbed nor generated"}};
  return chart;
}

ChartSeries ellipse_curve(std::string name, const Matrix& Z, const Eigen::Vector2d& centre, double scale) {
  constexpr int kPoints = 120;
  ChartSeries series;
  series.name = std::move(name);
  series.drawn = ChartSeries::Drawn::line;
  for (int k = 0; k <= kPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kPoints;
    const Eigen::Vector2d at = centre + scale * (Z * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    series.x.push_back(at[0]);
    series.y.push_back(at[1]);
  }
  return series;
}

ChartSeries rays(std::string name, const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to) {
  constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
  ChartSeries series;
  series.name = std::move(name);
  series.drawn = ChartSeries::Drawn::line;
  for (std::size_t k = 0; k < from.size(); ++k) {
    series.x.insert(series.x.end(), {from[k][0], to[k][0], kBreak});
    series.y.insert(series.y.end(), {from[k][1], to[k][1], kBreak});
  }
  return series;
}

}  // namespace mbk::thesis
