#include "thesis/exhibits.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/statistics.h"

namespace mbk::thesis {

ReproducedCell cell(const std::vector<double>& values, Spread spread) {
  const Eigen::Map<const Vector> all(values.data(), static_cast<Index>(values.size()));
  ReproducedCell cell = thesis::cell(all.mean());
  if (all.size() > 1) {
    const double deviation = std::sqrt(numeric::variance(all));
    cell.spread =
        spread == Spread::standard_deviation ? deviation : deviation / std::sqrt(static_cast<double>(all.size()));
  }
  return cell;
}

std::vector<double> of_trials(const TaskResult& result, const std::function<double(const TaskTrial&)>& quantity) {
  std::vector<double> values;
  for (const TaskTrial& trial : result.trials) values.push_back(quantity(trial));
  return values;
}

Result<const TaskResult*> first_of(Workbench& bench, Task task) {
  const auto results = MBK_TRY(bench.results(task));
  return &results->front();
}

std::string report_command(const Workbench& bench, Task task) {
  return fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk measure p1.h5 --handle-mass {} --report p1.html",
                     scenario_of(task), bench.seed(1, 1), kHandleMass);
}

std::string person(int participant) {
  return fmt::format("P{}", participant);
}

Matrix symmetric_matrix(const PrintedEllipse& ellipse) {
  const double ratio = ellipse.shape.value, smallest = std::sqrt(ellipse.area.value / (std::numbers::pi * ratio));
  const double angle = ellipse.orientation.value * std::numbers::pi / 180.0;
  const Eigen::Vector2d major(std::cos(angle), std::sin(angle));
  return smallest * (Eigen::Matrix2d::Identity() + (ratio - 1.0) * major * major.transpose());
}

}  // namespace mbk::thesis
