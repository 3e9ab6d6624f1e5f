// Signals of the relaxed arm and what the filters do to them: figures 3.4 to 3.6.
#include <array>
#include <cmath>
#include <tuple>

#include "mbk/base/numeric/dense.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/frequencies.h"
#include "mbk/measure/preprocess/prepare.h"
#include "thesis/drawing.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

Result<void> figure_3_4(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {report_command(bench, Task::relaxed_sinusoidal),
                      report_command(bench, Task::relaxed_underdamped)};
  for (const auto& [task, from, to] :
       {std::tuple{Task::relaxed_sinusoidal, 20.0, 30.0}, std::tuple{Task::relaxed_underdamped, 16.0, 36.0}}) {
    const auto result = MBK_TRY(first_of(bench, task));
    const auto charts = signal_charts(text(task), result->first, from, to);
    exhibit.charts.insert(exhibit.charts.end(), charts.begin(), charts.end());
  }
  return {};
}

Result<PreparedTrial> prepared(const Recording& recording, AccelerationSource acceleration) {
  preprocess::Options options;
  options.mode = Mode::reference;
  options.acceleration = acceleration;
  return preprocess::prepare(recording, recording::inspect(recording), options);
}

Result<void> figure_3_5(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"erratum-7", "figure-3.6"};
  exhibit.commands = {report_command(bench, Task::relaxed_sinusoidal) + "      # the report draws its filters"};
  const auto result = MBK_TRY(first_of(bench, Task::relaxed_sinusoidal));
  const auto trial = MBK_TRY(prepared(result->first, AccelerationSource::derivative));
  const auto response = MBK_TRY(analyse::filter_response(trial));
  // Above it every gain is below what can be drawn.
  constexpr double kHighest = 40.0, kMinGain = 1e-6;
  const auto chart = [&](const char* unit, const Vector& gain, const Vector* ideal) {
    Chart drawing;
    drawing.x = {"frequency", "Hz", true};
    drawing.y = {"gain", unit, true};
    const Index count = (response.frequency.array() <= kHighest).count();
    const Vector shown = (gain.head(count).array() > kMinGain).select(gain.head(count).array(), std::nan(""));
    drawing.series.push_back(line("filter", response.frequency.head(count), shown));
    if (ideal != nullptr) {
      drawing.series.push_back(line("ideal differentiator", response.frequency.head(count), ideal->head(count)));
    }
    return drawing;
  };
  exhibit.charts = {chart("", response.smoothing, nullptr), chart("1/s", response.first, &response.first_ideal),
                    chart("1/s²", response.second, &response.second_ideal)};
  return {};
}

/// Trapezoids from 0.
Vector integral(const Vector& y, double step) {
  Vector sum = Vector::Zero(y.size());
  for (Index i = 1; i < y.size(); ++i) sum[i] = sum[i - 1] + 0.5 * step * (y[i - 1] + y[i]);
  return sum;
}

/// y with the straight line added that brings it nearest to `target`: where an integral starts is not in what is
/// integrated.
Vector on_line_of(const Vector& y, const Vector& target) {
  const Index n = y.size();
  Matrix line(n, 2);
  line << Vector::Ones(n), Vector::LinSpaced(n, -1.0, 1.0);
  return y + line * numeric::PivotedQr(line).solve(target - y);
}

Result<void> figure_3_6(Workbench& bench, Draft& exhibit) {
  exhibit.commands = {report_command(bench, Task::relaxed_sinusoidal)};
  const auto result = MBK_TRY(first_of(bench, Task::relaxed_sinusoidal));
  const auto trial = prepared(result->first, AccelerationSource::derivative);
  const auto sensed = prepared(result->first, AccelerationSource::sensor);
  if (!trial) return tl::unexpected(trial.error());
  if (!sensed) return tl::unexpected(sensed.error());
  const auto begin = static_cast<Index>(10.0 / trial->sample_time),
             count = static_cast<Index>(10.0 / trial->sample_time);
  const auto x = [&](const Matrix& signal) -> Vector { return signal.col(0).segment(begin, count); };
  const Vector time = trial->time.segment(begin, count), acceleration = x(trial->acceleration);
  const Vector once = integral(acceleration, trial->sample_time), twice = integral(once, trial->sample_time);
  const Vector place = 1e3 * (x(trial->position).array() - x(trial->position).mean()).matrix();
  Chart position = over_time({"x", "mm"}), velocity = over_time({"ẋ", "mm/s"}), second = over_time({"ẍ", "m/s²"});
  position.series = {line("from the encoders", time, place),
                     line("acceleration integrated twice", time, on_line_of(1e3 * twice, place))};
  const Vector speed = 1e3 * x(trial->velocity);
  velocity.series = {line("first derivative filter", time, speed),
                     line("acceleration integrated", time, (1e3 * once).array() + (speed - 1e3 * once).mean())};
  second.series = {line("second derivative filter", time, acceleration),
                   line("accelerometer", time, x(sensed->acceleration))};
  exhibit.charts = {std::move(position), std::move(velocity), std::move(second)};
  return {};
}

constexpr std::array kSignalFigures = {Maker{kFigure, 3, "figure-3.4", Provenance::simulated, figure_3_4},
                                       Maker{kFigure, 3, "figure-3.5", Provenance::recomputed, figure_3_5},
                                       Maker{kFigure, 3, "figure-3.6", Provenance::simulated, figure_3_6}};

}  // namespace

std::span<const Maker> signal_figures() {
  return kSignalFigures;
}

}  // namespace mbk::thesis
