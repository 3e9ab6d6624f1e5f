// Figures of chapter 4: 4.1 and 4.3 to 4.8.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/measure/measurement/measure.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/drawing.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

Result<void> figure_4_1(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"figure-3.4"};
  for (const auto& [task, from, to] :
       {std::tuple{Task::rigid_underdamped, 16.0, 36.0}, std::tuple{Task::rigid_sinusoidal, 20.0, 30.0}}) {
    const auto results = MBK_TRY(bench.results(task));
    const auto charts = signal_charts(text(task), results->front().first, from, to);
    exhibit.charts.insert(exhibit.charts.end(), charts.begin(), charts.end());
    exhibit.commands.push_back(report_command(bench, task));
  }
  return {};
}

Result<void> rigid_energy_figure(Workbench& bench, Task task, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(task));
  exhibit.charts = {energy_chart(*results)};
  exhibit.commands = {
      fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {}", scenario_of(task),
                  bench.seed(1, 1), kHandleMass),
      "mbk validate participant --charts charts      # many seeds, and the amplitude at which it turns"};
  return {};
}

Result<void> figure_4_3(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3", "table-4.5", "figure-4.5"};
  return rigid_energy_figure(bench, Task::rigid_underdamped, exhibit);
}

Result<void> figure_4_4(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3", "figure-4.3"};
  return rigid_energy_figure(bench, Task::rigid_sinusoidal, exhibit);
}

/// Energy and distance from where it began, of one pulse, from half a second before its onset on.
void add_pulse(const Recording& recording, const Energy& energy, Draft& exhibit) {
  constexpr double kBefore = 0.2, kAfter = 1.5;  // [s]
  // The pulse whose energy is in the middle of all.
  std::vector<const EnergyPart*> parts;
  for (const EnergyPart& part : energy.parts) parts.push_back(&part);
  std::ranges::nth_element(parts, parts.begin() + std::ssize(parts) / 2, {}, &EnergyPart::absorbed);
  const EnergyPart& pulse = *parts[parts.size() / 2];
  const Part part = part_of(recording, pulse.from_s - kBefore, pulse.from_s + kAfter);
  const auto segment = [&](const char* channel) -> Vector {
    return recording.find(channel)->values.segment(part.begin, part.size);
  };
  const Vector time = recording.time.segment(part.begin, part.size).array() - recording.time[0] - pulse.from_s;
  Matrix place(part.size, 2), force(part.size, 2);
  place << segment("hand_x"), segment("hand_y");
  force << segment("force_x"), segment("force_y");
  const auto onset = static_cast<Index>((time.array() < 0.0).count());
  Vector absorbed = Vector::Zero(part.size);
  for (Index i = 1; i < part.size; ++i) {
    absorbed[i] = absorbed[i - 1] - 0.5 * (force.row(i - 1) + force.row(i)).dot(place.row(i) - place.row(i - 1));
  }
  absorbed.array() -= absorbed[onset];
  const Vector distance = (place.rowwise() - place.row(onset)).rowwise().norm();
  Chart joules = over_time({"energy absorbed", "J"});
  joules.series = {line("energy", time, absorbed)};
  joules.horizontal = {{0.0, "as at the onset"}};
  joules.vertical = {{0.0, "onset"}};
  Chart millimetres = over_time({"distance", "mm"});
  millimetres.series = {line("distance", time, 1e3 * distance)};
  millimetres.vertical = {{0.0, "onset"}};
  exhibit.charts.push_back(std::move(joules));
  exhibit.charts.push_back(std::move(millimetres));
}

Result<void> figure_4_5(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"figure-4.3", "future-work-3"};
  exhibit.commands = {fmt::format(
      "mbk simulate rigid_underdamped_8N --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {} --json",
      bench.seed(1, 1), kHandleMass)};
  const auto relaxed = MBK_TRY(bench.results(Task::relaxed_underdamped));
  const auto rigid = MBK_TRY(bench.results(Task::rigid_underdamped));
  auto scenarios = MBK_TRY(validation::ready("rigid_underdamped_8N"));
  scenarios.front().seed = bench.seed(1, 1);
  const auto strong = MBK_TRY(laboratory::simulate(scenarios.front()));
  const auto measured = MBK_TRY(measurement::measure({&strong.recording, 1}, {}));
  const auto add = [&](const TaskResult& result) { add_pulse(result.first, result.trials.front().energy, exhibit); };
  add(relaxed->front());
  add(rigid->front());
  add_pulse(strong.recording, measured.energies.front(), exhibit);
  return {};
}

Result<void> figure_4_6(Workbench& bench, Draft& exhibit) {
  const auto grasps = MBK_TRY(bench.one_axis_grasps());
  exhibit.related = {"table-4.4", "figure-4.7"};
  exhibit.commands = {"mbk simulate one_axis_random_binary --out binary.h5"};
  exhibit.charts = signal_charts("one axis", grasps->front().recording, 12.0, 42.0, 1);
  return {};
}

Result<void> figure_4_7(Workbench& bench, Draft& exhibit) {
  const auto grasps = MBK_TRY(bench.one_axis_grasps());
  const OneAxisGrasp& first = grasps->front();
  exhibit.values = {{"vaf", first.vaf}};
  exhibit.related = {"table-4.4"};
  exhibit.commands = {"mbk validate one-dimensional --charts charts"};
  Chart chart = over_time({"force of the hand on the robot", "N"});
  chart.series = {line("measured", first.output.time, first.output.measured),
                  line("model", first.output.time, first.output.modelled)};
  exhibit.charts = {std::move(chart)};
  return {};
}

/// The curve Z(jω) in the plane of Re and Im, from `low` to `high` Hz.
Chart nyquist(const char* border, double at, double low, double high,
              const std::function<std::complex<double>(std::complex<double>)>& Z) {
  constexpr int kPoints = 400;
  Chart chart;
  chart.x = {"Re Z(jω)", "N·s/m"};
  chart.y = {"Im Z(jω)", "N·s/m"};
  Vector re(kPoints), im(kPoints);
  for (int k = 0; k < kPoints; ++k) {
    const double hertz = low * std::pow(high / low, static_cast<double>(k) / (kPoints - 1));
    const std::complex<double> z = Z({0.0, 2.0 * std::numbers::pi * hertz});
    re[k] = z.real();
    im[k] = z.imag();
  }
  chart.series = {line(fmt::format("{:g} to {:g} Hz", low, high), re, im)};
  chart.vertical = {{at, border}};
  if (at != 0.0) chart.vertical.push_back({0.0, "0"});
  return chart;
}

Result<void> figure_4_8(Workbench& bench, Draft& exhibit) {
  // P1 along y: the arm, and the same with a delayed correction of its place, k g e^(−sT)/s, as a rigid grasp has it.
  const auto& ellipses = bench.given().sinusoidal.front().ellipses;
  const double m = symmetric_matrix(ellipses[0])(1, 1), b = symmetric_matrix(ellipses[1])(1, 1),
               k = symmetric_matrix(ellipses[2])(1, 1);
  constexpr double kDelay = 0.15, kGain = 1.4;  // [s]
  const auto relaxed = [=](std::complex<double> s) { return m * s + b + k / s; };
  const auto corrected = [=](std::complex<double> s) {
    return m * s + b + k * (1.0 + kGain * std::exp(-s * kDelay)) / s;
  };
  // A damper behind a spring: passive, without any excess.
  const auto behind_spring = [=](std::complex<double> s) { return b * k / (b * s + k); };
  double shortage = 0.0;
  for (double omega = 0.1; omega < 60.0; omega += 0.001) {
    shortage = std::max(shortage, -corrected({0.0, omega}).real());
  }
  exhibit.values = {{"m", m}, {"b", b}, {"k", k}, {"delay", kDelay}, {"shortage", shortage}};
  exhibit.related = {"table-3.6", "table-4.5"};
  exhibit.charts = {nyquist("passive to the right", 0.0, 0.01, 20.0, behind_spring), nyquist("δ", b, 0.5, 6.0, relaxed),
                    nyquist("−λ", -shortage, 0.2, 6.0, corrected)};
  return {};
}

constexpr std::array kRigidFigures = {Maker{kFigure, 4, "figure-4.1", Provenance::simulated, figure_4_1},
                                      Maker{kFigure, 4, "figure-4.3", Provenance::simulated, figure_4_3},
                                      Maker{kFigure, 4, "figure-4.4", Provenance::simulated, figure_4_4},
                                      Maker{kFigure, 4, "figure-4.5", Provenance::simulated, figure_4_5},
                                      Maker{kFigure, 4, "figure-4.6", Provenance::simulated, figure_4_6},
                                      Maker{kFigure, 4, "figure-4.7", Provenance::simulated, figure_4_7},
                                      Maker{kFigure, 4, "figure-4.8", Provenance::recomputed, figure_4_8}};

}  // namespace

std::span<const Maker> rigid_figures() {
  return kRigidFigures;
}

}  // namespace mbk::thesis
