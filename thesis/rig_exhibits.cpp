// The rigs of springs and payloads: tables 3.1 and 5.1, figure 3.8.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/calibration/spring_array.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/apparatus.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

/// A rig and the field of its springs at rest.
struct Rig {
  std::string name;  ///< "configuration 1", "K1"
  laboratory::Scenario scenario;
  double mass;  ///< [kg]
  SpringField field;
};

Result<Rig> rig_of(laboratory::Scenario scenario, std::string name) {
  constexpr double kRadius = 0.025;    // of the circle in which the hand was moved (Dyck 2013, §5.1.2.1) [m]
  constexpr double kGridStep = 15e-5;  // (appendix D) [m]
  constexpr double kGridReach = 3e-3;  // [m]
  const laboratory::PlanarTrial& trial = validation::planar(scenario);
  const auto& plan = std::get<laboratory::RigPlan>(trial.load);
  const auto array = MBK_TRY(calibration::SpringArray::create(plan.springs));
  auto field = MBK_TRY(calibration::spring_field(array, trial.home, kRadius));
  auto grid = MBK_TRY(calibration::grid_field(array, trial.home, kGridReach, kGridStep));
  field.grid = std::move(grid);
  const double mass = plan.mass;
  return Rig{std::move(name), std::move(scenario), mass, std::move(field)};
}

/// The six of table 3.1.
Result<std::vector<Rig>> rigs_3_1() {
  auto scenarios = MBK_TRY(validation::ready("rig_springs_table_3_1"));
  std::vector<Rig> rigs;
  for (laboratory::Scenario& scenario : scenarios) {
    auto rig = MBK_TRY(rig_of(std::move(scenario), fmt::format("configuration {}", rigs.size() + 1)));
    rigs.push_back(std::move(rig));
  }
  return rigs;
}

/// Of the twenty-five of table 5.1, those that are called so.
Result<std::vector<Rig>> rigs_5_1(bool stiffnesses) {
  auto scenarios = MBK_TRY(validation::ready(kSpringRigs));
  std::vector<Rig> rigs;
  for (laboratory::Scenario& scenario : scenarios) {
    const auto [stiffness, mass] = validation::rig_names(scenario.name);
    if (stiffnesses ? mass != "M1" : stiffness != "K1") continue;
    auto rig = MBK_TRY(rig_of(std::move(scenario), stiffnesses ? stiffness : mass));
    rigs.push_back(std::move(rig));
  }
  return rigs;
}

const std::array kStiffnessColumns = {ReproducedColumn{"k_xx", "N/m", 2}, ReproducedColumn{"k_yy", "N/m", 2},
                                      ReproducedColumn{"k_s", "N/m", 2}};
const std::array kPlaceColumns = {ReproducedColumn{"x0", "mm", 1}, ReproducedColumn{"y0", "mm", 1}};

/// K and x₀ as rows of the tables have them.
std::vector<ReproducedCell> field_cells(const Eigen::Matrix2d& K, const Eigen::Vector2d& x0) {
  return {cell(K(0, 0)), cell(K(1, 1)), cell(0.5 * (K(0, 1) + K(1, 0))), cell(kMillimetres * x0[0]),
          cell(kMillimetres * x0[1])};
}

ReproducedTable rig_table(const char* id, bool places = true) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "rig";
  if (places) {
    table.columns.assign(kStiffnessColumns.begin(), kStiffnessColumns.end());
    table.columns.insert(table.columns.end(), kPlaceColumns.begin(), kPlaceColumns.end());
  }
  return table;
}

/// K and x₀ from forces on a grid, as the source found its own.
ReproducedTable grid_table(const char* id, const std::vector<Rig>& rigs) {
  ReproducedTable table = rig_table(id);
  for (const Rig& rig : rigs)
    table.rows.push_back({rig.name, field_cells(rig.field.grid->K, rig.field.grid->equilibrium)});
  return table;
}

/// What a linear model leaves out.
ReproducedTable linearity_table(const char* id, const std::vector<Rig>& rigs) {
  ReproducedTable table = rig_table(id, false);
  table.columns = {{"springs", "", 0},
                   {"largest force", "N", 2},
                   {"largest deviation from K (x − x₀)", "N", 3},
                   {"deviation", "%", 1},
                   {"least extension", "mm", 1}};
  for (const Rig& rig : rigs) {
    const Linearisation& line = rig.field.linearisation;
    table.rows.push_back(
        {rig.name,
         {cell(static_cast<double>(rig.field.springs.size())), cell(line.largest_force), cell(line.largest_error),
          cell(100.0 * line.relative_error()), cell(kMillimetres * line.smallest_extension)}});
  }
  return table;
}

Result<void> table_3_1(Workbench& /*bench*/, Draft& exhibit) {
  const auto rigs = MBK_TRY(rigs_3_1());
  exhibit.commands = {"mbk springs field rig_springs_table_3_1 --trial config_1 --grid-step 0.15 --radius 25",
                      "mbk springs find --disc --stiffness 443.86,232.34,16.74 --at 393:-55"};
  exhibit.related = {"figure-3.8", "table-5.1"};
  ReproducedTable table = rig_table("3.1");
  table.columns.push_back({"m", "kg", 3});
  for (const Rig& rig : rigs) {
    ReproducedRow row{rig.name, field_cells(rig.field.K, rig.field.equilibrium)};
    row.cells.push_back(cell(rig.mass));
    table.rows.push_back(std::move(row));
  }
  exhibit.tables = {std::move(table), grid_table("3.1 by grid", rigs), linearity_table("3.1 linearity", rigs)};
  return {};
}

Result<void> table_5_1(Workbench& /*bench*/, Draft& exhibit) {
  const auto stiffnesses = MBK_TRY(rigs_5_1(true));
  const auto masses = MBK_TRY(rigs_5_1(false));
  exhibit.commands = {"mbk springs field rig_springs_table_5_1 --trial K5_M5 --grid-step 0.15 --radius 25",
                      "mbk springs find --disc --stiffness 373.81,377.10,73.16 --at 332:-61"};
  exhibit.related = {"table-3.1", "table-5.3", "table-5.4"};
  ReproducedTable stiffness = rig_table("5.1 stiffness");
  for (const Rig& rig : stiffnesses) {
    stiffness.rows.push_back({rig.name, field_cells(rig.field.K, rig.field.equilibrium)});
  }
  ReproducedTable mass = rig_table("5.1 mass", false);
  mass.columns = {{"m", "kg", 3}};
  for (const Rig& rig : masses) mass.rows.push_back({rig.name, {cell(rig.mass)}});
  exhibit.tables = {std::move(stiffness), std::move(mass), grid_table("5.1 by grid", stiffnesses),
                    linearity_table("5.1 linearity", stiffnesses)};
  return {};
}

// --- figure 3.8

/// One rig of table 3.1, identified by the published procedure.
Result<Identification> identified(laboratory::Scenario scenario, std::uint64_t seed) {
  scenario.seed = seed;
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  measurement::Options options = validation::mass_and_springs();
  options.preprocess.mode = Mode::reference;
  options.identify.parameters_from = ParametersFrom::all;
  options.passivity = false;
  auto measured = MBK_TRY(measurement::measure({&performance.recording, 1}, options));
  return std::move(measured.identification);
}

using Identifications = std::vector<Identification>;

ReproducedCell with_error(double value, double standard_error) {
  ReproducedCell made = cell(value);
  made.spread = standard_error;
  return made;
}

ReproducedTable identified_table(const std::vector<Rig>& rigs, const Identifications& found) {
  ReproducedTable table = rig_table("3.8");
  table.spread_is = "standard error";
  table.columns.push_back({"m", "kg", 3});
  table.columns.push_back({"VAF x", "%", 2});
  table.columns.push_back({"VAF y", "%", 2});
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    const impedance::Model &model = found[i].model, &error = found[i].standard_error;
    table.rows.push_back(
        {rigs[i].name,
         {with_error(model.K(0, 0), error.K(0, 0)), with_error(model.K(1, 1), error.K(1, 1)),
          with_error(model.K(0, 1), error.K(0, 1)), with_error(kMillimetres * model.x0[0], kMillimetres * error.x0[0]),
          with_error(kMillimetres * model.x0[1], kMillimetres * error.x0[1]), with_error(model.M(0, 0), error.M(0, 0)),
          cell(found[i].fit.vaf[0]), cell(found[i].fit.vaf[1])}});
  }
  return table;
}

/// Identified − theoretical, both of ours.
ReproducedTable error_table(const std::vector<Rig>& rigs, const Identifications& found) {
  ReproducedTable table = rig_table("3.8 errors");
  table.columns[3].decimals = table.columns[4].decimals = 3;
  table.columns.push_back({"m", "kg", 4});
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    const impedance::Model& model = found[i].model;
    ReproducedRow row{rigs[i].name, field_cells(model.K - rigs[i].field.K, model.x0 - rigs[i].field.equilibrium)};
    row.cells.push_back(cell(model.M(0, 0) - rigs[i].mass));
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReproducedTable claims_3_8(const std::vector<Rig>& rigs, const Identifications& found) {
  ReproducedTable table = claims_table("3.8 claims");
  double furthest = 0.0;
  int stiffer = 0, heavier = 0;
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    const impedance::Model& model = found[i].model;
    furthest = std::max(furthest, (model.x0 - rigs[i].field.equilibrium).norm());
    stiffer += model.K(1, 1) > rigs[i].field.K(1, 1) ? 1 : 0;
    heavier += model.M(0, 0) > rigs[i].mass ? 1 : 0;
  }
  const auto all = rigs.size();
  add_claim(table, "identified x₀ from the theoretical", fmt::format("at most {:.2f} mm", kMillimetres * furthest));
  add_claim(table, "k_yy overestimated", fmt::format("{} of {}", stiffer, all));
  add_claim(table, "m overestimated", fmt::format("{} of {}", heavier, all));
  return table;
}

/// The linear fields of table 3.1, with the damper of the ready scenario or without any.
std::vector<Rig> linear_rigs(const std::vector<laboratory::Scenario>& scenarios, bool damper) {
  std::vector<Rig> rigs;
  for (laboratory::Scenario scenario : scenarios) {
    auto& plan = std::get<laboratory::RigPlan>(validation::planar(scenario).load);
    if (!damper) plan.damping.setZero();
    SpringField field;
    field.K = plan.stiffness;
    field.equilibrium = plan.equilibrium;
    const double mass = plan.mass;
    rigs.push_back({scenario.name, std::move(scenario), mass, std::move(field)});
  }
  return rigs;
}

Result<Identifications> identify_all(Workbench& bench, const std::vector<Rig>& rigs) {
  Identifications found(rigs.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(rigs.size()), bench.options().threads, [&](int i) -> Result<void> {
    const auto at = static_cast<std::size_t>(i);
    found[at] = MBK_TRY(identified(rigs[at].scenario, rig_seed(bench, rigs[at].scenario)));
    return {};
  }));
  return found;
}

/// Mean errors over the six rigs.
ReproducedRow mean_errors(const char* name, const std::vector<Rig>& rigs, const Identifications& found) {
  const std::array<std::pair<Index, Index>, 3> places = {{{0, 0}, {1, 1}, {0, 1}}};
  ReproducedRow row{name, {}};
  for (const auto& [i, j] : places) {
    std::vector<double> errors;
    for (std::size_t k = 0; k < rigs.size(); ++k) errors.push_back(found[k].model.K(i, j) - rigs[k].field.K(i, j));
    row.cells.push_back(cell(errors, Spread::standard_deviation));
  }
  std::vector<double> errors;
  for (std::size_t k = 0; k < rigs.size(); ++k) errors.push_back(found[k].model.M(0, 0) - rigs[k].mass);
  row.cells.push_back(cell(errors, Spread::standard_deviation));
  return row;
}

/// Where the errors come from: springs against linear fields, a damper against none.
Result<ReproducedTable> cause_table(Workbench& bench, const std::vector<Rig>& rigs, const Identifications& found) {
  const auto scenarios = MBK_TRY(validation::ready("rig_table_3_1"));
  ReproducedTable table = rig_table("3.8 causes", false);
  table.what_rows_are = "what is simulated";
  table.spread_is = "standard deviation over the rigs";
  table.columns.assign(kStiffnessColumns.begin(), kStiffnessColumns.end());
  table.columns.push_back({"m", "kg", 4});
  table.rows.push_back(mean_errors("springs on the disc, damper of 1 N·s/m", rigs, found));
  for (const bool damper : {true, false}) {
    const std::vector<Rig> linear = linear_rigs(scenarios, damper);
    const auto of_linear = MBK_TRY(identify_all(bench, linear));
    table.rows.push_back(
        mean_errors(damper ? "linear fields, damper of 1 N·s/m" : "linear fields, no damper", linear, of_linear));
  }
  return table;
}

/// Points of one quantity over the rigs.
ChartSeries series_of(const char* name, const std::vector<Rig>& rigs, const Identifications& found,
                      double (*theoretical)(const Rig&), double (*identified)(const impedance::Model&)) {
  ChartSeries series;
  series.name = name;
  for (std::size_t i = 0; i < rigs.size(); ++i) {
    const double value = identified(found[i].model), reach = numeric::kNormal95 * identified(found[i].standard_error);
    series.x.push_back(theoretical(rigs[i]));
    series.y.push_back(value);
    series.intervals.emplace_back(value - reach, value + reach);
  }
  return series;
}

Result<void> figure_3_8(Workbench& bench, Draft& exhibit) {
  const auto rigs = MBK_TRY(rigs_3_1());
  const auto found = MBK_TRY(identify_all(bench, rigs));
  auto causes = MBK_TRY(cause_table(bench, rigs, found));
  exhibit.commands = {fmt::format("mbk simulate rig_springs_table_3_1 --trial config_1{} --out rig.h5 && mbk measure "
                                  "rig_config_1.h5 --mode reference --structure mass-spring --parameters-from all",
                                  seed_option(bench, rigs.front().scenario)),
                      "mbk validate springs --runs 1      # these and table 5.1, by mbk's own procedure"};
  exhibit.related = {"table-3.1", "figure-5.4"};
  exhibit.tables = {identified_table(rigs, found), error_table(rigs, found), claims_3_8(rigs, found),
                    std::move(causes)};
  Chart stiffness = validation::identified_against_true("", "N/m");
  stiffness.x.label = "theoretical stiffness";
  stiffness.y.label = "identified stiffness";
  stiffness.series = {series_of(
                          "k_xx", rigs, found, [](const Rig& rig) { return rig.field.K(0, 0); },
                          [](const impedance::Model& model) { return model.K(0, 0); }),
                      series_of(
                          "k_yy", rigs, found, [](const Rig& rig) { return rig.field.K(1, 1); },
                          [](const impedance::Model& model) { return model.K(1, 1); }),
                      series_of(
                          "k_s", rigs, found, [](const Rig& rig) { return rig.field.K(0, 1); },
                          [](const impedance::Model& model) { return model.K(0, 1); })};
  Chart mass = validation::identified_against_true("", "kg");
  mass.x.label = "theoretical mass";
  mass.y.label = "identified mass";
  mass.series = {series_of(
      "m", rigs, found, [](const Rig& rig) { return rig.mass; },
      [](const impedance::Model& model) { return model.M(0, 0); })};
  exhibit.charts = {std::move(stiffness), std::move(mass)};
  return {};
}

constexpr std::array kRigExhibits = {Maker{Exhibit::Kind::table, 3, "table-3.1", Provenance::simulated, table_3_1},
                                     Maker{Exhibit::Kind::figure, 3, "figure-3.8", Provenance::simulated, figure_3_8},
                                     Maker{Exhibit::Kind::table, 5, "table-5.1", Provenance::simulated, table_5_1}};

}  // namespace

std::span<const Maker> rig_exhibits() {
  return kRigExhibits;
}

}  // namespace mbk::thesis
