// Figures of chapter 3 but 3.8: 3.4 to 3.6 and 3.9 to 3.17.
#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/analyse/frequencies.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/thesis/drawing.h"
#include "mbk/thesis/exhibits.h"

namespace mbk::thesis {
namespace {

constexpr std::array<const char*, 3> kMatrices = {"inertia", "damping", "stiffness"};

/// The impedance whose reference circle has radius 1, of inertia [kg], damping [N·s/m] and stiffness [N/m], as in the
/// scales of figures 3.11 and 3.16.
constexpr std::array<double, 3> kReference = {1.5, 10.0, 75.0};

/// z_mean of participant P1's stiffness [%], from the caption of figure 3.12.
constexpr double kAntisymmetryOfP1 = 11.5;

std::string simulate_command(Task task, const Workbench& bench) {
  return fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk measure p1.h5 --handle-mass {} --report p1.html",
                     scenario_of(task), bench.seed(1, 1), kHandleMass);
}

Result<void> figure_3_4(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "Ten seconds of sines and twenty of pulses, as recorded, of the first trial of P1. The source shows "
      "them behind its low-pass."};
  exhibit.commands = {simulate_command(Task::relaxed_sinusoidal, bench),
                      simulate_command(Task::relaxed_underdamped, bench)};
  for (const auto& [task, from, to] :
       {std::tuple{Task::relaxed_sinusoidal, 20.0, 30.0}, std::tuple{Task::relaxed_underdamped, 16.0, 36.0}}) {
    const auto result = first_of(bench, task);
    if (!result) return tl::unexpected(result.error());
    const auto charts = signal_charts(text(task), (*result)->first, from, to);
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

Result<void> figure_3_5(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "Gain of the Savitzky–Golay filter of order 6 over 101 samples at 1 kHz, times that of the zero-phase "
      "Butterworth filter of order 5 at 5 Hz: of the signal itself, and of its derivatives beside the ideal "
      "ones. Nothing here is measured or simulated."};
  exhibit.related = {"slip-7", "figure-3.6"};
  exhibit.commands = {simulate_command(Task::relaxed_sinusoidal, bench) + "      # the report draws its filters"};
  const auto result = first_of(bench, Task::relaxed_sinusoidal);
  if (!result) return tl::unexpected(result.error());
  const auto trial = prepared((*result)->first, AccelerationSource::derivative);
  if (!trial) return tl::unexpected(trial.error());
  const auto response = analyse::filter_response(*trial);
  if (!response) return tl::unexpected(response.error());
  // Above it every gain is below what can be drawn.
  constexpr double kHighest = 40.0, kLeastGain = 1e-6;
  const auto chart = [&](const char* title, const char* unit, const Vector& gain, const Vector* ideal) {
    Chart drawing;
    drawing.title = title;
    drawing.x = {"frequency", "Hz", true};
    drawing.y = {"gain", unit, true};
    const Index count = (response->frequency.array() <= kHighest).count();
    const Vector shown = (gain.head(count).array() > kLeastGain).select(gain.head(count).array(), std::nan(""));
    drawing.series.push_back(line("filter", response->frequency.head(count), shown));
    if (ideal != nullptr) {
      drawing.series.push_back(line("ideal differentiator", response->frequency.head(count), ideal->head(count)));
    }
    return drawing;
  };
  exhibit.charts = {chart("Smoothing filter", "", response->smoothing, nullptr),
                    chart("First derivative filter", "1/s", response->first, &response->first_ideal),
                    chart("Second derivative filter", "1/s²", response->second, &response->second_ideal)};
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
  return y + line * line.colPivHouseholderQr().solve(target - y);
}

Result<void> figure_3_6(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "Ten seconds of x: the place and the acceleration integrated twice, the velocity and the acceleration integrated "
      "once, the acceleration from the place and that of the accelerometer, all behind the filters of figure 3.5. A "
      "straight line, which no integral can know, is taken off."};
  exhibit.commands = {simulate_command(Task::relaxed_sinusoidal, bench)};
  const auto result = first_of(bench, Task::relaxed_sinusoidal);
  if (!result) return tl::unexpected(result.error());
  const auto trial = prepared((*result)->first, AccelerationSource::derivative);
  const auto sensed = prepared((*result)->first, AccelerationSource::sensor);
  if (!trial) return tl::unexpected(trial.error());
  if (!sensed) return tl::unexpected(sensed.error());
  const auto begin = static_cast<Index>(10.0 / trial->sample_time),
             count = static_cast<Index>(10.0 / trial->sample_time);
  const auto x = [&](const Matrix& signal) -> Vector { return signal.col(0).segment(begin, count); };
  const Vector time = trial->time.segment(begin, count), acceleration = x(trial->acceleration);
  const Vector once = integral(acceleration, trial->sample_time), twice = integral(once, trial->sample_time);
  const Vector place = 1e3 * (x(trial->position).array() - x(trial->position).mean()).matrix();
  Chart position = over_time("Place", {"x", "mm"}), velocity = over_time("Velocity", {"ẋ", "mm/s"}),
        second = over_time("Acceleration", {"ẍ", "m/s²"});
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

Chart plane(std::string title, ChartAxis x, ChartAxis y) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = std::move(x);
  chart.y = std::move(y);
  chart.equal_scale = true;
  return chart;
}

/// Unit vectors all around.
std::vector<Eigen::Vector2d> directions(int count) {
  std::vector<Eigen::Vector2d> all;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    all.emplace_back(std::cos(angle), std::sin(angle));
  }
  return all;
}

std::vector<Eigen::Vector2d> mapped(const Matrix& Z, const std::vector<Eigen::Vector2d>& points) {
  std::vector<Eigen::Vector2d> all;
  for (const Eigen::Vector2d& point : points) all.emplace_back(Z * point);
  return all;
}

const Eigen::Vector2d kOrigin(0.0, 0.0);

Result<void> figure_3_9(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "A unit vector that goes once round, and the restoring forces −K e towards the middle, whose origins "
      "lie on the ellipse. Force and displacement are collinear along the axes of the ellipse alone. Drawn "
      "of P1's stiffness, rebuilt from table 3.3."};
  exhibit.related = {"table-3.3"};
  const Matrix K = symmetric_matrix(bench.given().sinusoidal.front().ellipses[2]);
  const auto around = directions(16);
  const std::vector<Eigen::Vector2d> middle(around.size(), kOrigin);
  Chart unit = plane("Displacement", {"e_x", "m"}, {"e_y", "m"});
  unit.series = {ellipse_curve("unit circle", Matrix::Identity(2, 2), kOrigin, 1.0),
                 rays("displacements", middle, around)};
  Chart force = plane("Restoring force", {"K_xx e_x + K_xy e_y", "N"}, {"K_yx e_x + K_yy e_y", "N"});
  force.series = {ellipse_curve("ellipse", K, kOrigin, 1.0),
                  rays("forces, towards the middle", mapped(K, around), middle)};
  const impedance::Ellipse ellipse = impedance::ellipse(K);
  const Eigen::Vector2d major(std::cos(ellipse.orientation), std::sin(ellipse.orientation)), minor(-major[1], major[0]);
  force.series.push_back(
      rays("axes: λ_max and λ_min", {kOrigin, kOrigin}, {ellipse.lambda_max * major, ellipse.lambda_min * minor}));
  exhibit.charts = {std::move(unit), std::move(force)};
  return {};
}

/// Mean of a matrix over the trials.
Matrix mean_matrix(const TaskResult& result, int matrix) {
  Matrix mean = Matrix::Zero(2, 2);
  for (const TaskTrial& trial : result.trials) {
    mean += impedance::symmetric_part(impedance::matrix_of(trial.identification.model, matrix));
  }
  return mean / static_cast<double>(result.trials.size());
}

Result<void> figure_3_10(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {fmt::format(
      "P1's arm with the hand at the test location, seen from above, and the ellipses of M, B and K at the "
      "hand: whole lines as rebuilt from table 3.3. The circle at the left is that of an isotropic {:g} kg, "
      "{:g} N·s/m or {:g} N/m. The links of 0.31 and 0.34 m are ours; the source does not give the "
      "participant's.",
      kReference[0], kReference[1], kReference[2])};
  exhibit.related = {"table-3.3", "figure-3.11"};
  const auto limb = participant::participant_limb(1);
  if (!limb) return tl::unexpected(limb.error());
  const auto angles = participant::joint_angles(limb->geometry, limb->equilibrium);
  const Eigen::Vector2d shoulder = limb->geometry.shoulder, hand = limb->equilibrium;
  const Eigen::Vector2d elbow = participant::elbow_position(limb->geometry, angles);
  Chart chart = plane("Arm and ellipses", {"x from the shoulder", "m"}, {"y from the shoulder", "m"});
  constexpr double kRadius = 0.08;  // of the reference circle [m]
  Vector x(3), y(3);
  x << 0.0, elbow[0] - shoulder[0], hand[0] - shoulder[0];
  y << 0.0, elbow[1] - shoulder[1], hand[1] - shoulder[1];
  chart.series.push_back(line("arm", x, y));
  for (std::size_t k = 0; k < 3; ++k) {
    const Matrix Z = symmetric_matrix(bench.given().sinusoidal.front().ellipses[k]);
    chart.series.push_back(ellipse_curve(kMatrices[k], Z, hand - shoulder, kRadius / kReference[k]));
  }
  chart.series.push_back(
      ellipse_curve("reference circle", Matrix::Identity(2, 2), Eigen::Vector2d(-0.3, 0.52), kRadius));
  exhibit.charts = {std::move(chart)};
  return {};
}

Result<void> ellipses_figure(Workbench& bench, Task task, const std::vector<PrintedArm>& arms, Exhibit& exhibit) {
  exhibit.text = {fmt::format(
      "One drawing for each participant: the ellipses of the matrices rebuilt from the printed A, R and θ, and those "
      "that the simulated participant was measured to have, mean of four trials. A unit is {:g} kg, {:g} N·s/m and "
      "{:g} N/m.",
      kReference[0], kReference[1], kReference[2])};
  const auto results = bench.results(task);
  if (!results) return tl::unexpected(results.error());
  for (const TaskResult& result : **results) {
    Chart chart = plane(person(result.participant), {"x", "of the reference"}, {"y", "of the reference"});
    const auto arm = std::ranges::find(arms, person(result.participant), &PrintedArm::name);
    for (std::size_t k = 0; k < 3; ++k) {
      if (arm == arms.end()) continue;
      chart.series.push_back(ellipse_curve(fmt::format("{}, rebuilt", kMatrices[k]), symmetric_matrix(arm->ellipses[k]),
                                           kOrigin, 1.0 / kReference[k]));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      chart.series.push_back(ellipse_curve(fmt::format("{}, simulated and measured", kMatrices[k]),
                                           mean_matrix(result, static_cast<int>(k)), kOrigin, 1.0 / kReference[k]));
    }
    exhibit.charts.push_back(std::move(chart));
  }
  return {};
}

Result<void> figure_3_11(Workbench& bench, Exhibit& exhibit) {
  exhibit.related = {"table-3.3"};
  return ellipses_figure(bench, Task::relaxed_sinusoidal, bench.given().sinusoidal, exhibit);
}

Result<void> figure_3_16(Workbench& bench, Exhibit& exhibit) {
  exhibit.related = {"table-3.5"};
  const auto made = ellipses_figure(bench, Task::relaxed_underdamped, bench.given().underdamped, exhibit);
  exhibit.text.emplace_back(
      "The simulated arms are those of table 3.3: one linear limb cannot have more damping against pulses than against "
      "sines, as the source found its participants to have.");
  return made;
}

Result<void> figure_3_12(Workbench& bench, Exhibit& exhibit) {
  const Matrix K = symmetric_matrix(bench.given().sinusoidal.front().ellipses[2]);
  const impedance::Ellipse ellipse = impedance::ellipse(K);
  const double k_a = kAntisymmetryOfP1 / 100.0 * std::sqrt(ellipse.lambda_max * ellipse.lambda_min);
  const Matrix curl = (Eigen::Matrix2d() << 0.0, k_a, -k_a, 0.0).finished();
  exhibit.text = {
      fmt::format("Forces at unit displacements, from P1's symmetric stiffness (rebuilt from table 3.3) and from an "
                  "antisymmetric part of {:g} %, which is |k_a| = {:.2f} N/m. Its sign is not printed; drawn is +. The "
                  "forces are small, but over all frequencies they decide: see slip 4.",
                  kAntisymmetryOfP1, k_a)};
  exhibit.related = {"slip-4", "figure-3.13"};
  const auto around = directions(16);
  for (const auto& [title, Z] : {std::pair{"(a) symmetric part", K}, std::pair{"(b) antisymmetric part", curl}}) {
    Chart chart = plane(title, {"x and force x", "m, 60 N"}, {"y and force y", "m, 60 N"});
    std::vector<Eigen::Vector2d> ends;
    for (const Eigen::Vector2d& from : around) ends.emplace_back(from - Z * from / 60.0);
    ChartSeries places;
    places.name = "unit displacements";
    for (const Eigen::Vector2d& at : around) {
      places.x.push_back(at[0]);
      places.y.push_back(at[1]);
    }
    chart.series = {rays("forces", around, ends), std::move(places)};
    exhibit.charts.push_back(std::move(chart));
  }
  return {};
}

/// z_mean of everyone, from the pooled trials, with 95 % intervals.
Result<void> antisymmetry_figure(Workbench& bench, std::size_t which, const char* what, Exhibit& exhibit) {
  const auto results = bench.results(Task::relaxed_sinusoidal);
  if (!results) return tl::unexpected(results.error());
  Chart chart;
  chart.title = fmt::format("Antisymmetry of the relaxed arm's {}", what);
  chart.x = {"participant", ""};
  chart.y = {"z_mean", "%"};
  ChartSeries marks;
  marks.name = "simulated participants, four trials in one fit, with 95 % intervals";
  ReproducedTable table;
  table.id = exhibit.id;
  table.title = chart.title;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "participant";
  table.columns = {{"z_mean", "%", 1}, {"95 %, low", "%", 1}, {"95 %, high", "%", 1}};
  for (const TaskResult& result : **results) {
    const AntisymmetryFinding& finding = result.pooled.findings->antisymmetry[which];
    marks.x.push_back(result.participant);
    marks.y.push_back(finding.zmean_percent);
    marks.intervals.push_back(finding.zmean95);
    table.rows.push_back({person(result.participant),
                          {cell(finding.zmean_percent), cell(finding.zmean95.first), cell(finding.zmean95.second)}});
  }
  chart.series = {std::move(marks)};
  chart.vertical.clear();
  exhibit.tables = {std::move(table)};
  exhibit.charts = {std::move(chart)};
  exhibit.commands = {simulate_command(Task::relaxed_sinusoidal, bench)};
  return {};
}

Result<void> figure_3_13(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "The simulated limbs have symmetric stiffness, for the signs of the participants' antisymmetric parts are not "
      "printed: all that is seen here is noise and the bend of the arm's geometry. Noise alone gives values of many "
      "percent in one trial, so that a value without an interval proves nothing. The source found less than 15 %, and "
      "11.5 % for P1.",
      "Part (b) of the figure shows other people's data, which this program does not hold."};
  exhibit.related = {"slip-4", "figure-3.12"};
  return antisymmetry_figure(bench, 1, "stiffness", exhibit);
}

Result<void> figure_3_14(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {"As figure 3.13, of the inertia."};
  exhibit.related = {"figure-3.13"};
  return antisymmetry_figure(bench, 0, "inertia", exhibit);
}

Result<void> energy_figure(Workbench& bench, Task task, Exhibit& exhibit) {
  const auto results = bench.results(task);
  if (!results) return tl::unexpected(results.error());
  exhibit.charts = {energy_chart(**results)};
  exhibit.commands = {fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {}",
                                  scenario_of(task), bench.seed(1, 1), kHandleMass)};
  return {};
}

Result<void> figure_3_15(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {
      "E(t) = −∫ F_h·v dt from the beginning of the published window. It rises throughout: the arm absorbs."};
  exhibit.related = {"table-4.3"};
  return energy_figure(bench, Task::relaxed_sinusoidal, exhibit);
}

Result<void> figure_3_17(Workbench& bench, Exhibit& exhibit) {
  exhibit.text = {"As figure 3.15, with pulses: a step up at each."};
  exhibit.related = {"figure-3.15"};
  return energy_figure(bench, Task::relaxed_underdamped, exhibit);
}

constexpr auto kFigure = Exhibit::Kind::figure;
constexpr std::array kMakers = {
    Maker{kFigure, 3, "figure-3.4", "Typical signals of the relaxed arm", Provenance::simulated, figure_3_4},
    Maker{kFigure, 3, "figure-3.5", "Gain of the filters", Provenance::recomputed, figure_3_5},
    Maker{kFigure, 3, "figure-3.6", "The derivatives agree with integrals and accelerometer", Provenance::simulated,
          figure_3_6},
    Maker{kFigure, 3, "figure-3.9", "From a matrix to its ellipse", Provenance::recomputed, figure_3_9},
    Maker{kFigure, 3, "figure-3.10", "Ellipses and arm of P1", Provenance::recomputed, figure_3_10},
    Maker{kFigure, 3, "figure-3.11", "Ellipses of the six relaxed arms, sinusoidal perturbations",
          Provenance::recomputed, figure_3_11},
    Maker{kFigure, 3, "figure-3.12", "Forces of P1's symmetric and antisymmetric stiffness", Provenance::recomputed,
          figure_3_12},
    Maker{kFigure, 3, "figure-3.13", "Antisymmetry of the stiffness", Provenance::simulated, figure_3_13},
    Maker{kFigure, 3, "figure-3.14", "Antisymmetry of the inertia", Provenance::simulated, figure_3_14},
    Maker{kFigure, 3, "figure-3.15", "Energy that relaxed arms absorb, sinusoidal perturbations", Provenance::simulated,
          figure_3_15},
    Maker{kFigure, 3, "figure-3.16", "Ellipses of two relaxed arms, underdamped perturbations", Provenance::recomputed,
          figure_3_16},
    Maker{kFigure, 3, "figure-3.17", "Energy that relaxed arms absorb, underdamped perturbations",
          Provenance::simulated, figure_3_17}};

}  // namespace

std::span<const Maker> relaxed_figures() {
  return kMakers;
}

}  // namespace mbk::thesis
