// Ellipses, antisymmetry and energy of relaxed arms: figures 3.9 to 3.17.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"
#include "mbk/simulate/participant/arm.h"
#include "thesis/drawing.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

/// The impedance whose reference circle has radius 1, of inertia [kg], damping [N·s/m] and stiffness [N/m], as in the
/// scales of figures 3.11 and 3.16.
constexpr std::array<double, 3> kReference = {1.5, 10.0, 75.0};

TextValues references() {
  return {{"inertia", kReference[0]}, {"damping", kReference[1]}, {"stiffness", kReference[2]}};
}

/// z_mean of participant P1's stiffness [%], from the caption of figure 3.12.
constexpr double kAntisymmetryOfP1 = 11.5;

Chart plane(ChartAxis x, ChartAxis y) {
  Chart chart;
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

Result<void> figure_3_9(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.3"};
  const Matrix K = symmetric_matrix(bench.given().sinusoidal.front().ellipses[2]);
  const auto around = directions(16);
  const std::vector<Eigen::Vector2d> middle(around.size(), kOrigin);
  Chart unit = plane({"e_x", "m"}, {"e_y", "m"});
  unit.series = {ellipse_curve("unit circle", Matrix::Identity(2, 2), kOrigin, 1.0),
                 rays("displacements", middle, around)};
  Chart force = plane({"K_xx e_x + K_xy e_y", "N"}, {"K_yx e_x + K_yy e_y", "N"});
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

Result<void> figure_3_10(Workbench& bench, Draft& exhibit) {
  exhibit.values = references();
  exhibit.related = {"table-3.3", "figure-3.11"};
  const auto limb = MBK_TRY(participant::participant_limb(1));
  const auto angles = participant::joint_angles(limb.geometry, limb.equilibrium);
  const Eigen::Vector2d shoulder = limb.geometry.shoulder, hand = limb.equilibrium;
  const Eigen::Vector2d elbow = participant::elbow_position(limb.geometry, angles);
  Chart chart = plane({"x from the shoulder", "m"}, {"y from the shoulder", "m"});
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

Result<void> ellipses_figure(Workbench& bench, Task task, const std::vector<PrintedArm>& arms, Draft& exhibit) {
  exhibit.values = references();
  const auto results = MBK_TRY(bench.results(task));
  for (const TaskResult& result : *results) {
    Chart chart = plane({"x", "of the reference"}, {"y", "of the reference"});
    chart.title = person(result.participant);
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

Result<void> figure_3_11(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.3"};
  return ellipses_figure(bench, Task::relaxed_sinusoidal, bench.given().sinusoidal, exhibit);
}

Result<void> figure_3_16(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-3.5"};
  const auto made = ellipses_figure(bench, Task::relaxed_underdamped, bench.given().underdamped, exhibit);
  return made;
}

Result<void> figure_3_12(Workbench& bench, Draft& exhibit) {
  const Matrix K = symmetric_matrix(bench.given().sinusoidal.front().ellipses[2]);
  const impedance::Ellipse ellipse = impedance::ellipse(K);
  const double k_a = kAntisymmetryOfP1 / 100.0 * std::sqrt(ellipse.lambda_max * ellipse.lambda_min);
  exhibit.values = {{"share", kAntisymmetryOfP1}, {"k_a", k_a}};
  const Matrix curl = (Eigen::Matrix2d() << 0.0, k_a, -k_a, 0.0).finished();
  exhibit.related = {"erratum-4", "figure-3.13"};
  const auto around = directions(16);
  for (const Matrix& Z : {K, curl}) {
    Chart chart = plane({"x and force x", "m, 60 N"}, {"y and force y", "m, 60 N"});
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
Result<void> antisymmetry_figure(Workbench& bench, std::size_t which, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(Task::relaxed_sinusoidal));
  Chart chart;
  chart.x = {"participant", ""};
  chart.y = {"z_mean", "%"};
  ChartSeries marks;
  marks.name = "simulated participants, four trials in one fit, with 95 % intervals";
  ReproducedTable table;
  table.id = exhibit.id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "participant";
  table.columns = {{"z_mean", "%", 1}, {"95 %, low", "%", 1}, {"95 %, high", "%", 1}};
  for (const TaskResult& result : *results) {
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
  exhibit.commands = {report_command(bench, Task::relaxed_sinusoidal)};
  return {};
}

Result<void> figure_3_13(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"erratum-4", "figure-3.12"};
  return antisymmetry_figure(bench, 1, exhibit);
}

Result<void> figure_3_14(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"figure-3.13"};
  return antisymmetry_figure(bench, 0, exhibit);
}

Result<void> energy_figure(Workbench& bench, Task task, Draft& exhibit) {
  const auto results = MBK_TRY(bench.results(task));
  exhibit.charts = {energy_chart(*results)};
  exhibit.commands = {fmt::format("mbk simulate {} --seed {} --out p1.h5 && mbk passivity p1.h5 --handle-mass {}",
                                  scenario_of(task), bench.seed(1, 1), kHandleMass)};
  return {};
}

Result<void> figure_3_15(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"table-4.3"};
  return energy_figure(bench, Task::relaxed_sinusoidal, exhibit);
}

Result<void> figure_3_17(Workbench& bench, Draft& exhibit) {
  exhibit.related = {"figure-3.15"};
  return energy_figure(bench, Task::relaxed_underdamped, exhibit);
}

constexpr std::array kRelaxedFigures = {Maker{kFigure, 3, "figure-3.9", Provenance::recomputed, figure_3_9},
                                        Maker{kFigure, 3, "figure-3.10", Provenance::recomputed, figure_3_10},
                                        Maker{kFigure, 3, "figure-3.11", Provenance::recomputed, figure_3_11},
                                        Maker{kFigure, 3, "figure-3.12", Provenance::recomputed, figure_3_12},
                                        Maker{kFigure, 3, "figure-3.13", Provenance::simulated, figure_3_13},
                                        Maker{kFigure, 3, "figure-3.14", Provenance::simulated, figure_3_14},
                                        Maker{kFigure, 3, "figure-3.15", Provenance::simulated, figure_3_15},
                                        Maker{kFigure, 3, "figure-3.16", Provenance::recomputed, figure_3_16},
                                        Maker{kFigure, 3, "figure-3.17", Provenance::simulated, figure_3_17}};

}  // namespace

std::span<const Maker> relaxed_figures() {
  return kRelaxedFigures;
}

}  // namespace mbk::thesis
