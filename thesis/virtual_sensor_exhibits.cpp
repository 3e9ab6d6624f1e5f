// Impedance without a force sensor: tables 5.4 to 5.6, figures 5.3 and 5.4.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

#include "mbk/base/numeric/parallel.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/simulated_trials.h"
#include "thesis/apparatus.h"
#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace {

using validation::Force;
using validation::ForceTrial;
using Trials = std::vector<ForceTrial>;

/// Method 1 as the source modelled its robot, method 1 with Coulomb friction in the model, and method 2.
constexpr Force kMethod1 = Force::no_coulomb, kMethod1Coulomb = Force::virtual_sensor, kMethod2 = Force::sensor;

/// The published procedure of chapter 5.
validation::ForceMeasurement published() {
  validation::ForceMeasurement how{.forces = {kMethod1, kMethod1Coulomb, kMethod2}};
  how.options.preprocess.mode = Mode::reference;
  how.options.preprocess.procedure = Procedure::chapter5;
  how.options.identify.hac_lag_s = 0.0;  // standard errors of single trials are not shown
  return how;
}

Result<Trials> perform_all(Workbench& bench, const std::vector<laboratory::Scenario>& scenarios,
                           const validation::ForceMeasurement& how) {
  const auto robots = MBK_TRY(bench.once(identified_robots));
  Trials trials(scenarios.size());
  MBK_TRY(
      numeric::parallel_for(static_cast<int>(scenarios.size()), bench.options().threads, [&](int i) -> Result<void> {
        const auto at = static_cast<std::size_t>(i);
        trials[at] = MBK_TRY(validation::perform(scenarios[at], *robots, how));
        return {};
      }));
  return trials;
}

/// The twenty-five rigs of springs, and five linear fields with the middle mass.
struct RigTrials {
  Trials springs, linear;
};

Result<RigTrials> make_rig_trials(Workbench& bench) {
  auto springs = MBK_TRY(validation::ready(kSpringRigs));
  auto linear = MBK_TRY(validation::ready(kLinearRigs));
  std::erase_if(
      linear, [](const laboratory::Scenario& scenario) { return validation::rig_names(scenario.name).second != "M3"; });
  const auto count = static_cast<std::ptrdiff_t>(springs.size());
  springs.insert(springs.end(), linear.begin(), linear.end());
  for (laboratory::Scenario& scenario : springs) scenario.seed = rig_seed(bench, scenario);
  auto all = MBK_TRY(perform_all(bench, springs, published()));
  return RigTrials{{all.begin(), all.begin() + count}, {all.begin() + count, all.end()}};
}

/// A number of tables 5.3 and 5.4.
struct Element {
  const char *name, *unit;
  int decimals;
  double (*of)(const impedance::Model&);
};
constexpr std::array kStiffnesses = {
    Element{"k_xx", "N/m", 2, [](const impedance::Model& model) { return model.K(0, 0); }},
    Element{"k_yy", "N/m", 2, [](const impedance::Model& model) { return model.K(1, 1); }},
    Element{"k_s", "N/m", 2, [](const impedance::Model& model) { return model.K(0, 1); }}};
constexpr Element kMass{"m", "kg", 3, [](const impedance::Model& model) { return model.M(0, 0); }};

std::vector<double> values_of(const Trials& trials, std::string_view rig,
                              const std::function<double(const ForceTrial&)>& value) {
  std::vector<double> values;
  for (const ForceTrial& trial : trials) {
    if (trial.stiffness == rig || trial.mass == rig) values.push_back(value(trial));
  }
  return values;
}

double mean_of(const Trials& trials, std::string_view rig, const std::function<double(const ForceTrial&)>& value) {
  const std::vector<double> values = values_of(trials, rig, value);
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size())).mean();
}

/// Theoretical − identified, the sign in which table 5.4 is printed.
ReproducedCell error_cell(const Trials& trials, std::string_view rig, Force force, const Element& element) {
  return cell(
      values_of(trials, rig,
                [&](const ForceTrial& trial) { return element.of(trial.truth) - element.of(trial.of(force).model); }),
      Spread::standard_deviation);
}

/// A force and what it is called in a table.
using ForceMethod = std::pair<const char*, Force>;

/// One table of errors: the rigs of a letter by the elements of some methods.
ReproducedTable error_table(const char* id, const Trials& trials, char letter, const std::vector<Element>& elements,
                            const std::vector<ForceMethod>& methods) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = letter == 'K' ? "stiffness" : "mass";
  const std::size_t behind =
      values_of(trials, fmt::format("{}1", letter), [](const ForceTrial&) { return 0.0; }).size();
  if (behind > 1) table.spread_is = fmt::format("standard deviation over {} trials", behind);
  for (const auto& [name, force] : methods) {
    for (const Element& element : elements) {
      table.columns.push_back({fmt::format("{} {}", name, element.name), element.unit, element.decimals});
    }
  }
  for (int k = 1; k <= 5; ++k) {
    ReproducedRow row{fmt::format("{}{}", letter, k), {}};
    for (const auto& [name, force] : methods) {
      for (const Element& element : elements) row.cells.push_back(error_cell(trials, row.name, force, element));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// " --seed 1025" of a trial of a ready scenario, where it is not the scenario's own; "" stands for the only trial.
Result<std::string> trial_seed(const Workbench& bench, const char* file, std::string_view trial) {
  const auto scenarios = MBK_TRY(validation::ready(file));
  return seed_option(bench, *std::ranges::find(scenarios, trial, &laboratory::Scenario::name));
}

/// What makes robot.json.
Result<std::string> robot_command(const Workbench& bench) {
  const auto seed = MBK_TRY(trial_seed(bench, "free_motion", ""));
  return fmt::format(
      "mbk simulate free_motion{} --out free.h5 && mbk robot identify free.h5 --terms viscous {} --json --out "
      "robot.json",
      seed, kPublishedRobotOptions);
}

Result<void> add_rig_commands(const Workbench& bench, Draft& exhibit) {
  auto robot = MBK_TRY(robot_command(bench));
  const auto seed = MBK_TRY(trial_seed(bench, kSpringRigs, "K5_M5"));
  const std::string measure = "mbk measure rig_K5_M5.h5 --mode reference --procedure chapter5 --structure mass-spring";
  exhibit.commands = {std::move(robot), fmt::format("mbk simulate {} --trial K5_M5{} --out rig.h5", kSpringRigs, seed),
                      measure + " --force-source virtual --robot robot.json      # method 1",
                      measure + "      # method 2",
                      "mbk validate virtual-sensor --runs 1      # linear fields, by mbk's own procedure"};
  return {};
}

std::string count_of(int count, int of) {
  return fmt::format("{} of {}", count, of);
}

/// What the text of §5.3.1 says of both methods.
ReproducedTable claims_5_4(const Trials& trials) {
  ReproducedTable table = claims_table("5.4 claims");
  int stiffer = 0, lighter = 0, over = 0, under = 0;
  std::array<double, 4> relative{};
  const auto both = [&](const std::string& rig, const Element& element, double& method_1, double& method_2) {
    method_1 = mean_of(trials, rig, [&](const ForceTrial& trial) { return element.of(trial.of(kMethod1).model); });
    method_2 = mean_of(trials, rig, [&](const ForceTrial& trial) { return element.of(trial.of(kMethod2).model); });
  };
  double furthest = 0.0, method_1 = 0.0, method_2 = 0.0;
  for (int k = 1; k <= 5; ++k) {
    for (std::size_t e = 0; e < 2; ++e) {
      both(fmt::format("K{}", k), kStiffnesses[e], method_1, method_2);
      stiffer += method_1 > method_2 ? 1 : 0;
      relative[e] += 100.0 / 5.0 * std::abs(method_1 / method_2 - 1.0);
      const double truth = mean_of(trials, fmt::format("K{}", k),
                                   [&](const ForceTrial& trial) { return kStiffnesses[e].of(trial.truth); });
      over += method_1 > truth ? 1 : 0;
    }
    both(fmt::format("M{}", k), kMass, method_1, method_2);
    lighter += method_1 < method_2 ? 1 : 0;
    relative[3] += 100.0 / 5.0 * std::abs(method_1 / method_2 - 1.0);
    under +=
        method_1 < mean_of(
                       trials, fmt::format("M{}", k), [](const ForceTrial& trial) { return kMass.of(trial.truth); })
            ? 1
            : 0;
  }
  for (const ForceTrial& trial : trials) {
    for (const Force force : {kMethod1, kMethod2}) {
      furthest = std::max(furthest, (trial.of(force).model.x0 - trial.truth.x0).norm());
    }
  }
  add_claim(table, "k_xx and k_yy by method 1 above those by method 2", count_of(stiffer, 10));
  add_claim(table, "k_xx and k_yy by method 1 above the truth", count_of(over, 10));
  add_claim(table, "m by method 1 below that by method 2", count_of(lighter, 5));
  add_claim(table, "m by method 1 below the truth", count_of(under, 5));
  add_claim(table, "relative discrepancy of the methods: k_xx, k_yy, m",
            fmt::format("{:.1f} %, {:.1f} %, {:.2f} %", relative[0], relative[1], relative[3]));
  add_claim(table, "identified x₀ from the theoretical", fmt::format("at most {:.2f} mm", 1e3 * furthest));
  return table;
}

Result<void> table_5_4(Workbench& bench, Draft& exhibit) {
  const auto trials = MBK_TRY(bench.once(make_rig_trials));
  const auto& [springs, linear] = *trials;
  MBK_TRY(add_rig_commands(bench, exhibit));
  exhibit.related = {"table-5.1", "table-5.3", "table-5.5", "figure-5.4", "erratum-12"};
  const std::vector<Element> stiffness(kStiffnesses.begin(), kStiffnesses.end());
  const std::vector<ForceMethod> published_methods = {{"method 1", kMethod1}, {"method 2", kMethod2}};
  const std::vector<ForceMethod> coulomb = {{"method 1", kMethod1Coulomb}};
  const std::vector<ForceMethod> all = {
      {"method 1", kMethod1}, {"method 1 with Coulomb", kMethod1Coulomb}, {"method 2", kMethod2}};
  exhibit.tables = {
      error_table("5.4 stiffness", springs, 'K', stiffness, published_methods),
      error_table("5.4 mass", springs, 'M', {kMass}, published_methods),
      error_table("5.4 stiffness with Coulomb", springs, 'K', stiffness, coulomb),
      error_table("5.4 mass with Coulomb", springs, 'M', {kMass}, coulomb),
      error_table("5.4 linear", linear, 'K', {kStiffnesses[0], kStiffnesses[1], kStiffnesses[2], kMass}, all),
      claims_5_4(springs)};
  return {};
}

// --- table 5.5

ReproducedTable vaf_table(const char* id, const Trials& trials, Force force) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "stiffness";
  for (int m = 1; m <= 5; ++m) {
    for (const char* axis : {"x", "y"}) table.columns.push_back({fmt::format("M{} {}", m, axis), "%", 1});
  }
  for (int k = 1; k <= 5; ++k) {
    ReproducedRow row{fmt::format("K{}", k), {}};
    for (int m = 1; m <= 5; ++m) {
      const std::string mass = fmt::format("M{}", m);
      const auto trial = std::ranges::find_if(
          trials, [&](const ForceTrial& one) { return one.stiffness == row.name && one.mass == mass; });
      for (Index axis = 0; axis < 2; ++axis) {
        row.cells.push_back(trial == trials.end() ? words("") : cell(trial->of(force).vaf[axis]));
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

double min_vaf(const Trials& trials, Force force) {
  double least = 100.0;
  for (const ForceTrial& trial : trials) least = std::min(least, trial.of(force).vaf.minCoeff());
  return least;
}

ReproducedTable claims_5_5(const Trials& trials) {
  ReproducedTable table = claims_table("5.5 claims");
  add_claim(table, "least VAF by method 2", fmt::format("{:.2f} %", min_vaf(trials, kMethod2)));
  add_claim(table, "least VAF by method 1", fmt::format("{:.2f} %", min_vaf(trials, kMethod1)));
  const auto largest_rmse = [&](Force force) {
    double largest = 0.0;
    for (const ForceTrial& trial : trials) largest = std::max(largest, trial.of(force).rmse.maxCoeff());
    return largest;
  };
  add_claim(table, "largest RMSE of the force by method 1",
            fmt::format("{:.2f} N ({:.2f} N with Coulomb)", largest_rmse(kMethod1), largest_rmse(kMethod1Coulomb)));
  int stiffer = 0, of = 0;
  for (const ForceTrial& trial : trials) {
    if (trial.stiffness == "K5") continue;
    const Index along = trial.truth.K(0, 0) > trial.truth.K(1, 1) ? 0 : 1;
    const Vector& vaf = trial.of(kMethod1).vaf;
    stiffer += vaf[along] > vaf[1 - along] ? 1 : 0;
    ++of;
  }
  add_claim(table, "VAF larger along the stiffer direction, K1 to K4", count_of(stiffer, of));
  return table;
}

Result<void> table_5_5(Workbench& bench, Draft& exhibit) {
  const auto trials = MBK_TRY(bench.once(make_rig_trials));
  const Trials& springs = trials->springs;
  MBK_TRY(add_rig_commands(bench, exhibit));
  exhibit.related = {"table-5.1", "table-5.4"};
  exhibit.tables = {vaf_table("5.5", springs, kMethod1), vaf_table("5.5 with Coulomb", springs, kMethod1Coulomb),
                    vaf_table("5.5 method 2", springs, kMethod2), claims_5_5(springs)};
  for (ReproducedTable& table : exhibit.tables) {
    if (table.id != "5.5") {
      for (ReproducedColumn& column : table.columns) column.decimals = 2;
    }
  }
  return {};
}

// --- figure 5.3

/// Six seconds of a signal, decimated.
ChartSeries segment_of(const char* name, const PreparedTrial& trial, const Matrix& signal, Index axis, double scale,
                       double offset = 0.0) {
  constexpr double kFrom = 30.0, kLength = 6.0;  // [s]
  constexpr double kPoints = 600.0;
  ChartSeries series;
  series.name = name;
  series.drawn = ChartSeries::Drawn::line;
  const auto every = std::max<Index>(1, static_cast<Index>(std::ceil(kLength / (kPoints * trial.sample_time))));
  for (Index i = 0; i < trial.time.size(); i += every) {
    if (trial.time[i] < kFrom || trial.time[i] >= kFrom + kLength) continue;
    series.x.push_back(trial.time[i]);
    series.y.push_back(scale * (signal(i, axis) - offset));
  }
  return series;
}

Result<void> figure_5_3(Workbench& bench, Draft& exhibit) {
  const auto robots = MBK_TRY(bench.once(identified_robots));
  auto scenarios = MBK_TRY(validation::ready(kSpringRigs));
  laboratory::Scenario& scenario = *std::ranges::find(scenarios, "K5_M5", &laboratory::Scenario::name);
  scenario.seed = rig_seed(bench, scenario);
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  const preprocess::Options options = published().options.preprocess;
  const auto sensor = MBK_TRY(validation::prepare_with(performance.recording, kMethod2, *robots, options));
  const auto computed = MBK_TRY(validation::prepare_with(performance.recording, kMethod1, *robots, options));
  MBK_TRY(add_rig_commands(bench, exhibit));
  exhibit.related = {"table-5.4", "table-5.5"};
  const impedance::Model& truth = performance.truth;
  Chart place{.x = {"time", "s"}, .y = {"from the equilibrium", "mm"}};
  place.series = {segment_of("x", sensor, sensor.position, 0, 1e3, truth.x0[0]),
                  segment_of("y", sensor, sensor.position, 1, 1e3, truth.x0[1])};
  Chart velocity{.x = {"time", "s"}, .y = {"velocity", "mm/s"}};
  velocity.series = {segment_of("x", sensor, sensor.velocity, 0, 1e3),
                     segment_of("y", sensor, sensor.velocity, 1, 1e3)};
  Chart acceleration{.x = {"time", "s"}, .y = {"acceleration", "m/s²"}};
  acceleration.series = {segment_of("x", sensor, sensor.acceleration, 0, 1.0),
                         segment_of("y", sensor, sensor.acceleration, 1, 1.0)};
  exhibit.charts = {std::move(place), std::move(velocity), std::move(acceleration)};
  for (Index axis = 0; axis < 2; ++axis) {
    Chart force{.x = {"time", "s"}, .y = {"force", "N"}};
    force.series = {segment_of("sensor", sensor, sensor.force_hand_on_robot, axis, 1.0),
                    segment_of("virtual sensor", computed, computed.force_hand_on_robot, axis, 1.0)};
    exhibit.charts.push_back(std::move(force));
  }
  return {};
}

// --- figure 5.4

Result<void> figure_5_4(Workbench& bench, Draft& exhibit) {
  const auto trials = MBK_TRY(bench.once(make_rig_trials));
  const Trials& springs = trials->springs;
  MBK_TRY(add_rig_commands(bench, exhibit));
  exhibit.related = {"table-5.3", "table-5.4", "figure-3.8"};
  Chart stiffness = validation::identified_against_true("", "N/m");
  Chart mass = validation::identified_against_true("", "kg");
  stiffness.x.label = "theoretical stiffness";
  stiffness.y.label = "identified stiffness";
  mass.x.label = "theoretical mass";
  mass.y.label = "identified mass";
  for (const auto& [name, force] : {ForceMethod{"method 1, virtual sensor", kMethod1},
                                    ForceMethod{"method 1 with Coulomb friction", kMethod1Coulomb},
                                    ForceMethod{"method 2, force sensor", kMethod2}}) {
    ChartSeries stiffnesses{.name = name}, masses{.name = name};
    const auto add = [&](ChartSeries& series, const std::string& rig, const Element& element) {
      series.x.push_back(mean_of(springs, rig, [&](const ForceTrial& trial) { return element.of(trial.truth); }));
      series.y.push_back(
          mean_of(springs, rig, [&](const ForceTrial& trial) { return element.of(trial.of(force).model); }));
    };
    for (int k = 1; k <= 5; ++k) {
      for (const Element& element : kStiffnesses) add(stiffnesses, fmt::format("K{}", k), element);
      add(masses, fmt::format("M{}", k), kMass);
    }
    stiffness.series.push_back(std::move(stiffnesses));
    mass.series.push_back(std::move(masses));
  }
  exhibit.charts = {std::move(stiffness), std::move(mass)};
  return {};
}

// --- table 5.6

constexpr const char* kArmScenario = "relaxed_virtual_sensor";
constexpr int kArmTrials = 5;      // (Dyck 2013, §5.1.2.2)
constexpr double kHandle = 0.135;  // Λ (eq. 5.4) [kg]

struct ArmTrials {
  Trials first;   ///< of P1
  Trials others;  ///< one of each of P2 to P5
};

Result<laboratory::Scenario> arm_scenario(int participant, std::uint64_t seed) {
  auto scenarios = MBK_TRY(validation::ready(kArmScenario));
  auto scenario = validation::with_limb(scenarios.front(), participant);
  if (scenario) scenario->seed = seed;
  return scenario;
}

Result<ArmTrials> make_arm_trials(Workbench& bench) {
  std::vector<laboratory::Scenario> scenarios;
  const auto add = [&](int participant, int trial) -> Result<void> {
    auto scenario = MBK_TRY(arm_scenario(participant, bench.seed(participant, trial)));
    scenarios.push_back(std::move(scenario));
    return {};
  };
  for (int trial = 1; trial <= kArmTrials; ++trial) {
    MBK_TRY(add(1, trial));
  }
  for (int participant = 2; participant <= 5; ++participant) {
    MBK_TRY(add(participant, 1));
  }
  validation::ForceMeasurement how = published();
  how.options.identify.structure = Structure::full;
  how.options.identify.handle_mass = kHandle;
  auto all = MBK_TRY(perform_all(bench, scenarios, how));
  return ArmTrials{{all.begin(), all.begin() + kArmTrials}, {all.begin() + kArmTrials, all.end()}};
}

/// Columns of a table of arms: M, B, K and the VAF.
ReproducedTable arm_table(const char* id) {
  ReproducedTable table;
  table.id = id;
  table.provenance = Provenance::simulated;
  table.what_rows_are = "method";
  for (const auto& [letter, unit, decimals] :
       {std::tuple{'m', "kg", 3}, std::tuple{'b', "N·s/m", 2}, std::tuple{'k', "N/m", 1}}) {
    for (const char* element : {"xx", "xy", "yx", "yy"}) {
      table.columns.push_back({fmt::format("{}_{}", letter, element), unit, decimals});
    }
  }
  table.columns.push_back({"VAF x", "%", 2});
  table.columns.push_back({"VAF y", "%", 2});
  return table;
}

constexpr Index kMatrixElements = 12;  // of M, B and K

/// Means and standard deviations over trials; no VAF of the truth.
ReproducedRow arm_row(std::string name, const Trials& trials, std::optional<Force> force) {
  ReproducedRow row{std::move(name), {}};
  const auto add = [&](const std::function<double(const ForceTrial&)>& value) {
    std::vector<double> values;
    for (const ForceTrial& trial : trials) values.push_back(value(trial));
    row.cells.push_back(cell(values, Spread::standard_deviation));
  };
  for (Index k = 0; k < kMatrixElements; ++k) {
    add([&](const ForceTrial& trial) { return impedance::stacked(force ? trial.of(*force).model : trial.truth)[k]; });
  }
  for (Index axis = 0; axis < 2; ++axis) {
    if (force) {
      add([&](const ForceTrial& trial) { return trial.of(*force).vaf[axis]; });
    } else {
      row.cells.push_back(words("–"));
    }
  }
  return row;
}

constexpr std::array kArmMethods = {ForceMethod{"method 1", kMethod1},
                                    ForceMethod{"method 1 with Coulomb", kMethod1Coulomb},
                                    ForceMethod{"method 2", kMethod2}};

/// Trace of the mean of a matrix of M, B, K over trials.
double trace_of(const Trials& trials, Force force, Matrix impedance::Model::*matrix) {
  double sum = 0.0;
  for (const ForceTrial& trial : trials) sum += (trial.of(force).model.*matrix).trace();
  return sum / static_cast<double>(trials.size());
}

ReproducedTable claims_5_6(const ArmTrials& arms) {
  ReproducedTable table = claims_table("5.6 claims");
  const auto excess = [&](Force force, Matrix impedance::Model::*matrix) {
    return fmt::format("{:+.2f} %",
                       100.0 * (trace_of(arms.first, force, matrix) / trace_of(arms.first, kMethod2, matrix) - 1.0));
  };
  const auto both = [&](Matrix impedance::Model::*matrix) {
    return fmt::format("{} ({} with Coulomb)", excess(kMethod1, matrix), excess(kMethod1Coulomb, matrix));
  };
  add_claim(table, "least VAF by method 1", fmt::format("{:.1f} %", min_vaf(arms.first, kMethod1)));
  add_claim(table, "least VAF by method 2", fmt::format("{:.1f} %", min_vaf(arms.first, kMethod2)));
  add_claim(table, "trace of M by method 1, over that by method 2", both(&impedance::Model::M));
  add_claim(table, "trace of B by method 1, over that by method 2", both(&impedance::Model::B));
  add_claim(table, "trace of K by method 1, over that by method 2", both(&impedance::Model::K));
  return table;
}

Result<void> table_5_6(Workbench& bench, Draft& exhibit) {
  const auto arms = MBK_TRY(bench.once(make_arm_trials));
  auto robot = MBK_TRY(robot_command(bench));
  exhibit.commands = {
      std::move(robot),
      fmt::format("mbk simulate {} --seed {} --out arm.h5      # the first trial of P1", kArmScenario,
                  bench.seed(1, 1)),
      fmt::format("mbk measure arm.h5 --mode reference --procedure chapter5 --handle-mass {} --force-source virtual "
                  "--robot robot.json      # method 1",
                  kHandle),
      fmt::format("mbk measure arm.h5 --mode reference --procedure chapter5 --handle-mass {}      # method 2",
                  kHandle)};
  exhibit.related = {"table-3.2", "table-5.4", "table-A.1"};
  ReproducedTable own = arm_table("5.6");
  own.spread_is = fmt::format("standard deviation over {} trials", kArmTrials);
  ReproducedTable others = arm_table("5.6 others");
  others.what_rows_are = "participant, method";
  for (const auto& [name, force] : kArmMethods) own.rows.push_back(arm_row(name, arms->first, force));
  own.rows.push_back(arm_row("simulated arm", arms->first, {}));
  for (std::size_t i = 0; i < arms->others.size(); ++i) {
    const std::string who = person(static_cast<int>(i) + 2);
    for (const auto& [name, force] : kArmMethods) {
      others.rows.push_back(arm_row(fmt::format("{}, {}", who, name), {arms->others[i]}, force));
    }
    others.rows.push_back(arm_row(who + ", simulated arm", {arms->others[i]}, {}));
  }
  exhibit.tables = {std::move(own), std::move(others), claims_5_6(*arms)};
  return {};
}

constexpr std::array kVirtualSensorExhibits = {
    Maker{Exhibit::Kind::figure, 5, "figure-5.3", Provenance::simulated, figure_5_3},
    Maker{Exhibit::Kind::figure, 5, "figure-5.4", Provenance::simulated, figure_5_4},
    Maker{Exhibit::Kind::table, 5, "table-5.4", Provenance::simulated, table_5_4},
    Maker{Exhibit::Kind::table, 5, "table-5.5", Provenance::simulated, table_5_5},
    Maker{Exhibit::Kind::table, 5, "table-5.6", Provenance::simulated, table_5_6}};

}  // namespace

std::span<const Maker> virtual_sensor_exhibits() {
  return kVirtualSensorExhibits;
}

}  // namespace mbk::thesis
