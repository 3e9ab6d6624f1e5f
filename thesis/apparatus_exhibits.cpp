// The robot and its force sensor, appendices A and E: table A.1, figures A.2 and A.4, equation E.2 and figure E.5.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/calibration/force_sensor.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/simulate/laboratory/strain_gauge.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/apparatus.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

// --- table A.1

/// One of the models of a free motion.
using Model = RobotIdentification FreeMotion::*;

std::vector<double> of_motions(const FreeMotions& motions, Model model,
                               const std::function<double(const RobotIdentification&)>& value) {
  std::vector<double> values;
  for (const FreeMotion& trial : motions.trials) values.push_back(value(trial.*model));
  return values;
}

double of_coefficient(const RobotIdentification& found, std::string_view name) {
  const auto at = std::ranges::find(
      found.coefficients, name, [](const RobotCoefficient& one) -> std::string_view { return one.coefficient.name; });
  return at->value;
}

/// A coefficient of the source, and what mbk calls it.
struct Coefficient {
  const char *symbol, *name;
};
constexpr std::array kInertias = {Coefficient{"α1", "alpha1"}, Coefficient{"α2", "alpha2"},
                                  Coefficient{"α3", "alpha3"}};
constexpr std::array kViscous = {Coefficient{"α4", "viscous_1"}, Coefficient{"α5", "viscous_2"}};
constexpr std::array kCoulomb = {Coefficient{"Coulomb, joint 1", "coulomb_1"},
                                 Coefficient{"Coulomb, joint 2", "coulomb_2"}};

/// What the coefficients of a model are found to be, beside what they are.
Result<ReproducedTable> coefficient_table(const char* id, const FreeMotions& motions, Model model, bool coulomb) {
  const auto truth = MBK_TRY(validation::true_parameters(validation::FrictionModel::full));
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "coefficient, in kg·m², N·m·s/rad or N·m";
  table.columns = {{"value", "", 5}, {"standard deviation", "", 5}, {"simulated robot", "", 5}, {"error", "%", 2}};
  std::vector<Coefficient> coefficients(kInertias.begin(), kInertias.end());
  coefficients.insert(coefficients.end(), kViscous.begin(), kViscous.end());
  if (coulomb) coefficients.insert(coefficients.end(), kCoulomb.begin(), kCoulomb.end());
  const RobotIdentification& full = motions.trials.front().full;
  for (const Coefficient& one : coefficients) {
    const ReproducedCell value = cell(
        of_motions(motions, model, [&](const RobotIdentification& found) { return of_coefficient(found, one.name); }),
        Spread::standard_deviation);
    const auto at = std::ranges::find(full.coefficients, std::string_view(one.name), [](const RobotCoefficient& known) {
      return std::string_view(known.coefficient.name);
    });
    const double is = truth[at - full.coefficients.begin()];
    table.rows.push_back(
        {one.symbol,
         {cell(*value.ours), cell(value.spread.value_or(0.0)), cell(is), cell(100.0 * (*value.ours / is - 1.0))}});
  }
  return table;
}

ReproducedTable torque_table(const FreeMotions& motions) {
  ReproducedTable table;
  table.id = "A.1 torque";
  table.provenance = Provenance::simulated;
  table.what_rows_are = "model";
  table.spread_is = fmt::format("standard deviation over {} trials", kFreeMotions);
  table.columns = {{"VAF τ1", "%", 3}, {"VAF τ2", "%", 3}, {"RMSE τ1", "mN·m", 2}, {"RMSE τ2", "mN·m", 2}};
  const auto add = [&](const char* name, Model model) {
    ReproducedRow row{name, {}};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      row.cells.push_back(
          cell(of_motions(motions, model, [&](const RobotIdentification& found) { return found.fit[joint].vaf; }),
               Spread::standard_deviation));
    }
    for (std::size_t joint = 0; joint < 2; ++joint) {
      row.cells.push_back(cell(
          of_motions(motions, model, [&](const RobotIdentification& found) { return 1e3 * found.fit[joint].rmse; }),
          Spread::standard_deviation));
    }
    table.rows.push_back(std::move(row));
  };
  add("viscous friction, as published", &FreeMotion::viscous);
  add("with Coulomb friction", &FreeMotion::full);
  add("with Coulomb friction and the printed Coriolis sign", &FreeMotion::printed_sign);
  add("mbk's own procedure", &FreeMotion::by_default);
  return table;
}

/// " --seed 1001" of the first free motion, where it is not the scenario's own.
Result<std::string> free_motion_seed(const Workbench& bench) {
  const auto scenarios = MBK_TRY(validation::ready("free_motion"));
  return seed_option(bench, scenarios.front());
}

Result<std::vector<std::string>> robot_commands(const Workbench& bench) {
  const auto seed = MBK_TRY(free_motion_seed(bench));
  return std::vector{
      fmt::format("mbk simulate free_motion{} --out free.h5", seed),
      fmt::format("mbk robot identify free.h5 --terms viscous {}      # as published", kPublishedRobotOptions),
      fmt::format("mbk robot identify free.h5 {}      # with Coulomb friction", kPublishedRobotOptions),
      std::string("mbk robot identify free.h5      # mbk's own procedure")};
}

Result<void> table_A_1(Workbench& bench, Draft& exhibit) {
  const auto motions = MBK_TRY(bench.once(make_free_motions));
  auto commands = MBK_TRY(robot_commands(bench));
  exhibit.commands = std::move(commands);
  exhibit.commands.emplace_back("mbk validate robot --runs 6");
  exhibit.related = {"figure-A.4", "erratum-9", "table-5.4"};
  for (const auto& [id, model, coulomb] :
       {std::tuple{"A.1", &FreeMotion::viscous, false}, std::tuple{"A.1 with Coulomb", &FreeMotion::full, true},
        std::tuple{"A.1 by default", &FreeMotion::by_default, true}}) {
    auto table = MBK_TRY(coefficient_table(id, *motions, model, coulomb));
    exhibit.tables.push_back(std::move(table));
  }
  exhibit.tables.push_back(torque_table(*motions));
  ReproducedTable claims = claims_table("A.1 claims");
  for (const int joint : {0, 1}) {
    const std::vector<double> vaf = of_motions(*motions, &FreeMotion::viscous, [&](const RobotIdentification& found) {
      return found.fit[static_cast<std::size_t>(joint)].vaf;
    });
    add_claim(claims, joint == 0 ? "VAF of τ1 in every trial" : "VAF of τ2 in every trial",
              fmt::format("at least {:.2f} %", *std::ranges::min_element(vaf)));
  }
  exhibit.tables.push_back(std::move(claims));
  return {};
}

// --- figure A.2

Result<void> figure_A_2(Workbench& /*bench*/, Draft& exhibit) {
  const auto scenarios = MBK_TRY(validation::ready("relaxed_sinusoidal"));
  laboratory::Scenario scenario = scenarios.front();
  const laboratory::PlanarTrial& trial = validation::planar(scenario);
  const robot::PlanarRobot& robot = trial.robot.robot;
  const auto workspace = MBK_TRY(robot::workspace(robot.geometry));
  const auto posture = MBK_TRY(robot::posture(robot, trial.home));
  exhibit.commands = {
      fmt::format("mbk robot workspace --at {:g},{:g} --out workspace.svg", 1e3 * trial.home[0], 1e3 * trial.home[1])};
  exhibit.related = {"table-A.1", "erratum-8"};
  Chart chart{.x = {"x", "mm"}, .y = {"y", "mm"}};
  chart.equal_scale = true;
  ChartSeries outline{.name = "limit of the workspace", .drawn = ChartSeries::Drawn::line};
  constexpr std::size_t kPoints = 600;
  const std::size_t every = (workspace.outline.size() + kPoints - 1) / kPoints;
  for (std::size_t i = 0; i + 1 < workspace.outline.size(); i += every) {
    outline.x.push_back(1e3 * workspace.outline[i][0]);
    outline.y.push_back(1e3 * workspace.outline[i][1]);
  }
  outline.x.push_back(outline.x.front());
  outline.y.push_back(outline.y.front());
  ChartSeries base{.name = "base of the robot", .x = {0.0}, .y = {0.0}};
  ChartSeries test{.name = "test location", .x = {1e3 * trial.home[0]}, .y = {1e3 * trial.home[1]}};
  chart.series = {std::move(outline), std::move(base), std::move(test)};
  exhibit.charts.push_back(std::move(chart));

  ReproducedTable table;
  table.id = "A.2";
  table.provenance = Provenance::recomputed;
  table.what_rows_are = "quantity";
  table.columns = {{"value", "", 1}, {"unit", "", 0}};
  const auto add = [&](const char* name, double value, const char* unit) {
    table.rows.push_back({name, {cell(value), words(unit)}});
  };
  add("area", 1e4 * workspace.area, "cm²");
  add("least x", 1e3 * workspace.low[0], "mm");
  add("largest x", 1e3 * workspace.high[0], "mm");
  add("least y", 1e3 * workspace.low[1], "mm");
  add("largest y", 1e3 * workspace.high[1], "mm");
  add("θ1 at the test location", kDegrees * posture.theta[0], "°");
  add("θ2 at the test location", kDegrees * posture.theta[1], "°");
  add("nearest limit from there", kDegrees * robot::margin(robot.geometry.limits, posture.theta), "°");
  exhibit.tables.push_back(std::move(table));
  return {};
}

// --- figure A.4

Result<void> figure_A_4(Workbench& bench, Draft& exhibit) {
  const auto motions = MBK_TRY(bench.once(make_free_motions));
  const FreeMotion& first = motions->trials.front();
  auto commands = MBK_TRY(robot_commands(bench));
  exhibit.commands = std::move(commands);
  exhibit.related = {"table-A.1"};
  const auto signals = MBK_TRY(prepare_free_motion(motions->first, first.viscous.model));
  const auto coulomb = MBK_TRY(prepare_free_motion(motions->first, first.full.model));
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const Vector predicted = signals.regressors[joint] * first.viscous.model.parameters;
    const Vector with_coulomb = coulomb.regressors[joint] * first.full.model.parameters;
    Chart torque{.x = {"time", "s"}, .y = {"torque", "N·m"}};
    Chart left{.x = {"time", "s"}, .y = {"recorded − predicted", "mN·m"}};
    ChartSeries recorded{.name = "recorded", .drawn = ChartSeries::Drawn::line},
        model{.name = "predicted", .drawn = ChartSeries::Drawn::line},
        viscous{.name = "viscous friction", .drawn = ChartSeries::Drawn::line},
        full{.name = "with Coulomb friction", .drawn = ChartSeries::Drawn::line};
    for (const Segment& segment : signals.segments) {
      if (segment.purpose != Purpose::validation) continue;
      for (Index i = segment.begin; i < segment.end; ++i) {
        const double time = signals.time[i], measured = signals.torque(i, static_cast<Index>(joint));
        for (ChartSeries* series : {&recorded, &model, &viscous, &full}) series->x.push_back(time);
        recorded.y.push_back(measured);
        model.y.push_back(predicted[i]);
        viscous.y.push_back(1e3 * (measured - predicted[i]));
        full.y.push_back(1e3 * (coulomb.torque(i, static_cast<Index>(joint)) - with_coulomb[i]));
      }
    }
    torque.series = {std::move(recorded), std::move(model)};
    left.series = {std::move(viscous), std::move(full)};
    exhibit.charts.push_back(std::move(torque));
    exhibit.charts.push_back(std::move(left));
  }
  return {};
}

// --- equation E.2

constexpr std::array<const char*, 2> kSensorRows = {"Fx", "Fy"};

/// A converted reading as the voltage that it was.
double voltage_of(const laboratory::StrainGaugeOptions& gauge, double force, Index axis) {
  return (force - gauge.offset[axis]) / gauge.slope[axis];
}

/// Weights of −50 … 50 N, hung at one axis after the other, up and down, and one reading of each once the filter of the
/// sensor has settled.
/// @param scatter  standard deviation of what a load differs from what it is said to be [N]
Result<calibration::SensorRun> hang_weights(std::uint64_t seed, double scatter) {
  constexpr double kSampleTime = 1e-3, kLargest = 50.0, kStep = 10.0;  // [s], [N], [N]
  constexpr int kSettle = 500;                                         // samples
  const laboratory::StrainGaugeOptions options;
  auto gauge = MBK_TRY(laboratory::StrainGauge::create(options, kSampleTime, seed));
  numeric::Random random(seed, 1);
  std::vector<Eigen::Vector4d> rows;
  const auto hang = [&](Index axis, double load) {
    const Eigen::Vector2d said = load * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d hung = said + scatter * random.normal() * Eigen::Vector2d::Unit(axis);
    Eigen::Vector2d reading = gauge.read(hung);
    for (int k = 0; k < kSettle; ++k) reading = gauge.read(hung);
    rows.emplace_back(said[0], said[1], voltage_of(options, reading[0], 0), voltage_of(options, reading[1], 1));
  };
  for (const Index axis : {Index{0}, Index{1}}) {
    for (double load = -kLargest; load <= kLargest; load += kStep) hang(axis, load);
    for (double load = kLargest; load >= -kLargest; load -= kStep) hang(axis, load);
  }
  calibration::SensorRun run;
  run.source.path = "loads.csv";
  run.axes = {"x", "y"};
  run.force.resize(static_cast<Index>(rows.size()), 2);
  run.voltage.resize(static_cast<Index>(rows.size()), 2);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    run.force.row(static_cast<Index>(i)) = rows[i].head<2>().transpose();
    run.voltage.row(static_cast<Index>(i)) = rows[i].tail<2>().transpose();
  }
  return run;
}

/// A guess at how far the loads of the source were from what they were taken for [N].
constexpr double kScatter = 0.6;

struct Gauge {
  calibration::SensorRun exact, scattered;
  SensorCalibration of_exact, of_scattered;
};

Result<Gauge> make_gauge(Workbench& bench) {
  const std::uint64_t seed = bench.seed(0, 1);
  auto exact = MBK_TRY(hang_weights(seed, 0.0));
  auto scattered = MBK_TRY(hang_weights(seed, kScatter));
  calibration::SensorCalibrationOptions options;
  options.lever_arm = laboratory::StrainGaugeOptions{}.calibration_arm;
  options.converter = calibration::Converter{};
  auto first = MBK_TRY(calibration::calibrate_sensor({exact}, options));
  auto second = MBK_TRY(calibration::calibrate_sensor({scattered}, options));
  return Gauge{std::move(exact), std::move(scattered), std::move(first), std::move(second)};
}

ReproducedTable line_table(const char* id, int decimals) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "axis";
  table.columns = {{"slope", "N/V", decimals},
                   {"slope, standard error", "N/V", decimals},
                   {"offset", "N", decimals},
                   {"offset, standard error", "N", decimals},
                   {"R²", "", 7}};
  return table;
}

/// Lines of the force on the voltage, as the source drew them.
ReproducedTable published_lines(const char* id, const SensorCalibration& found, int decimals) {
  ReproducedTable table = line_table(id, decimals);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const ForceOnVoltage& line = found.axes[axis].published;
    table.rows.push_back({kSensorRows[axis],
                          {cell(line.slope), cell(line.slope_error), cell(line.intercept), cell(line.intercept_error),
                           cell(line.r_squared)}});
  }
  return table;
}

/// Lines of the voltage on the load, turned round.
ReproducedTable inverted_lines(const char* id, const SensorCalibration& found, int decimals) {
  ReproducedTable table = line_table(id, decimals);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto at = static_cast<Index>(axis);
    const SensorAxis& one = found.axes[axis];
    table.rows.push_back({kSensorRows[axis],
                          {cell(found.slope(at, at)), cell(found.slope_error(at, at)), cell(one.intercept),
                           cell(one.intercept_error), cell(one.r_squared)}});
  }
  return table;
}

/// What one code is worth, and what a reading is off by when the force lies anywhere between two codes.
Result<ReproducedTable> resolution_table(std::uint64_t seed) {
  constexpr double kSampleTime = 1e-3, kSlowRise = 1e-4;  // [s], [N] each sample
  constexpr int kSamples = 50000;
  const laboratory::StrainGaugeOptions options;
  laboratory::StrainGaugeOptions without_noise = options, without_converter = options;
  without_noise.bridge_noise = 0.0;
  without_converter.converter_bits = 0;
  std::array<Eigen::Vector2d, 3> rms;
  std::size_t at = 0;
  for (const laboratory::StrainGaugeOptions& one : {without_converter, without_noise, options}) {
    auto gauge = MBK_TRY(laboratory::StrainGauge::create(one, kSampleTime, seed));
    Eigen::Vector2d squares(0.0, 0.0);
    // The rise is so slow that the filter's delay is a thousandth of a millinewton.
    for (int k = 0; k < kSamples; ++k) squares += gauge.added(Eigen::Vector2d::Constant(kSlowRise * k)).cwiseAbs2();
    rms[at++] = (squares / kSamples).cwiseSqrt();
  }
  ReproducedTable table;
  table.id = "E.2 resolution";
  table.provenance = Provenance::simulated;
  table.what_rows_are = "axis";
  table.columns = {{"one code", "N", 4},
                   {"one code / √12", "N", 4},
                   {"error, noise alone (RMS)", "N", 4},
                   {"error, converter alone (RMS)", "N", 4},
                   {"error, both (RMS)", "N", 4}};
  const double step = calibration::Converter{options.converter_bits, options.converter_range}.step();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Index>(axis);
    const double code = step * std::abs(options.slope[i]);
    table.rows.push_back(
        {kSensorRows[axis],
         {cell(code), cell(code / std::sqrt(12.0)), cell(rms[0][i]), cell(rms[1][i]), cell(rms[2][i])}});
  }
  return table;
}

/// A few lines of shell and Python that hang the weights as the user's own laboratory would.
constexpr const char* kLoadsCommand =
    "python3 -c \"print('Fx,Fy,Vx,Vy'); [print(f*(a==0), f*(a==1), round((f*(a==0)-0.54)/-8.56*204.8)/204.8, "
    "round((f*(a==1)-2.3)/-8.15*204.8)/204.8, sep=',') for a in (0,1) for f in range(-50,51,10)]\" > loads.csv      # "
    "or your own weights";
constexpr const char* kCalibrateCommand = "mbk sensor calibrate loads.csv --lever-arm-mm 68.8 --bits 12 --range 10";

Result<void> table_E_2(Workbench& bench, Draft& exhibit) {
  const auto gauge = MBK_TRY(bench.once(make_gauge));
  auto resolution = MBK_TRY(resolution_table(bench.seed(0, 2)));
  exhibit.commands = {kLoadsCommand, kCalibrateCommand};
  exhibit.related = {"figure-E.5", "withdrawn-errata"};
  exhibit.tables = {published_lines("E.2", gauge->of_exact, 4), inverted_lines("E.2 inverted", gauge->of_exact, 4),
                    published_lines("E.2 scattered", gauge->of_scattered, 3),
                    inverted_lines("E.2 scattered inverted", gauge->of_scattered, 3), std::move(resolution)};
  return {};
}

Result<void> figure_E_5(Workbench& bench, Draft& exhibit) {
  const auto gauge = MBK_TRY(bench.once(make_gauge));
  exhibit.commands = {kLoadsCommand, kCalibrateCommand};
  exhibit.related = {"table-E.2"};
  const calibration::SensorRun& run = gauge->scattered;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto at = static_cast<Index>(axis);
    const ForceOnVoltage& line = gauge->of_scattered.axes[axis].published;
    Chart chart{.x = {"voltage", "V"}, .y = {"load", "N"}};
    ChartSeries marks{.name = "loads"}, fitted{.name = "line of best fit", .drawn = ChartSeries::Drawn::line};
    const Index loads = run.force.rows() / 2;  // of this axis; the others hang at the other one
    for (Index i = at * loads; i < (at + 1) * loads; ++i) {
      marks.x.push_back(run.voltage(i, at));
      marks.y.push_back(run.force(i, at));
    }
    const auto [low, high] = std::ranges::minmax(marks.x);
    for (const double voltage : {low, high}) {
      fitted.x.push_back(voltage);
      fitted.y.push_back(line.slope * voltage + line.intercept);
    }
    chart.series = {std::move(marks), std::move(fitted)};
    exhibit.charts.push_back(std::move(chart));
  }
  return {};
}

constexpr std::array kApparatusExhibits = {
    Maker{Exhibit::Kind::figure, 0, "figure-A.2", Provenance::recomputed, figure_A_2},
    Maker{Exhibit::Kind::table, 0, "table-A.1", Provenance::simulated, table_A_1},
    Maker{Exhibit::Kind::figure, 0, "figure-A.4", Provenance::simulated, figure_A_4},
    Maker{Exhibit::Kind::table, 0, "table-E.2", Provenance::simulated, table_E_2},
    Maker{Exhibit::Kind::figure, 0, "figure-E.5", Provenance::simulated, figure_E_5}};

}  // namespace

std::span<const Maker> apparatus_exhibits() {
  return kApparatusExhibits;
}

}  // namespace mbk::thesis
