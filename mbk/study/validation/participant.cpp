#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "mbk/base/numeric/statistics.h"
#include "mbk/study/validation/simulated_trials.h"
#include "mbk/study/validation/study.h"

namespace mbk::validation {
namespace {

using laboratory::PlanarTrial;
using laboratory::Scenario;

/// A ready scenario, and what is expected of it.
struct Condition {
  const char* name;                              ///< as it stands in the table
  const char* scenario;                          ///< ready file
  double energy_sign;                            ///< +1: the energy absorbed rises; −1: it falls
  std::optional<std::pair<double, double>> vaf;  ///< [%] that the mean of both axes keeps in every run
  bool controller = true;
};

constexpr double kNone = std::numeric_limits<double>::infinity();

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> kAll = {
      {"relaxed, sinusoidal", "relaxed_sinusoidal", 1.0, std::pair{92.0, 100.0}},
      {"relaxed, underdamped", "relaxed_underdamped", 1.0, std::pair{92.0, 100.0}},
      {"rigid, 2 N pulses", "rigid_underdamped_2N", -1.0, std::pair{-kNone, 50.0}},
      {"rigid, 8 N pulses", "rigid_underdamped_8N", 1.0, {}},
      {"rigid, 6 N sinusoidal", "rigid_sinusoidal_6N", 1.0, std::pair{60.0, 85.0}},
      {"rigid, 2 N pulses, controller off", "rigid_underdamped_2N", 1.0, {}, false},
  };
  return kAll;
}

constexpr const char* kTuned =
    "The gains of the participant's controller are tuned to the findings of Dyck (2013, chapter 4), not fitted to "
    "anyone.";

/// Participants of the thesis whose limbs are used.
constexpr std::array kArms = {1, 4, 5};

/// Amplitudes of the crossover [N].
constexpr std::array kAmplitudes = {1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0};

measurement::Options published_procedure() {
  measurement::Options options;
  options.preprocess.mode = Mode::reference;
  return options;
}

void switch_controller_off(Scenario& scenario) {
  std::get<participant::ArmOptions>(std::get<PlanarTrial>(scenario.trial).load).controller.position_gain = 0.0;
}

/// Every arm and seed of one scenario, appended to `plans`.
Result<void> add_plans(const Scenario& scenario, const StudyOptions& options, bool measured,
                       std::vector<TrialPlan>& plans) {
  for (const int arm : kArms) {
    auto with_arm = with_limb(scenario, arm);
    if (!with_arm) return tl::unexpected(with_arm.error());
    for (int run = 0; run < options.runs; ++run) {
      with_arm->seed = options.seed + static_cast<std::uint64_t>(run);
      plans.push_back({*with_arm, measured ? std::optional(published_procedure()) : std::nullopt});
    }
  }
  return {};
}

Result<std::vector<TrialPlan>> all_plans(const StudyOptions& options) {
  std::vector<TrialPlan> plans;
  for (const Condition& condition : conditions()) {
    auto scenarios = ready(condition.scenario);
    if (!scenarios) return tl::unexpected(scenarios.error());
    if (!condition.controller) switch_controller_off(scenarios->front());
    if (auto ok = add_plans(scenarios->front(), options, true, plans); !ok) return tl::unexpected(ok.error());
  }
  auto crossover = ready("rigid_underdamped_2N");
  if (!crossover) return tl::unexpected(crossover.error());
  for (const double amplitude : kAmplitudes) {
    std::get<perturbation::PulsePlan>(crossover->front().perturbation.kind).pulses.amplitude = amplitude;
    if (auto ok = add_plans(crossover->front(), options, false, plans); !ok) return tl::unexpected(ok.error());
  }
  return plans;
}

using Trials = std::span<const SimulatedTrial>;

std::pair<double, double> range(Trials trials, const std::function<double(const SimulatedTrial&)>& value) {
  std::pair<double, double> range = {kNone, -kNone};
  for (const SimulatedTrial& trial : trials) {
    range = {std::min(range.first, value(trial)), std::max(range.second, value(trial))};
  }
  return range;
}

ValidationRow energy_row(const Condition& condition, int arm, Trials trials) {
  const auto as_expected = [&](const SimulatedTrial& trial) {
    return trial.energy_absorbed * condition.energy_sign > 0.0;
  };
  const int hits = static_cast<int>(std::ranges::count_if(trials, as_expected));
  const auto runs = static_cast<int>(trials.size());
  const auto energy = range(trials, [](const SimulatedTrial& trial) { return trial.energy_absorbed; });
  const auto [low, high] = numeric::binomial_interval(hits, runs, 0.99);
  ValidationRow row;
  row.what = fmt::format("{}, P{}: E {}, {:+.2f} to {:+.2f} J", condition.name, arm,
                         condition.energy_sign > 0.0 ? "rises" : "falls", energy.first, energy.second);
  row.value = 100.0 * hits / runs;
  row.interval99 = {100.0 * low, 100.0 * high};
  row.expected = {100.0, 100.0};
  row.unit = "% of runs";
  return row;
}

/// The mean over both axes in each run: its lowest and its highest value have to be in the band.
std::vector<ValidationRow> vaf_rows(const Condition& condition, int arm, Trials trials) {
  const auto vaf = range(trials, [](const SimulatedTrial& trial) { return trial.identification.fit.vaf.mean(); });
  std::vector<ValidationRow> rows;
  const auto add = [&](const char* which, double value) {
    ValidationRow row;
    row.what = fmt::format("{}, P{}: {} VAF", condition.name, arm, which);
    row.value = value;
    row.interval99 = {value, value};
    row.expected = condition.vaf;
    row.unit = "%";
    rows.push_back(row);
  };
  add("lowest", vaf.first);
  add("highest", vaf.second);
  return rows;
}

struct Spread {
  double mean = 0.0, deviation = 0.0;
};

Spread spread_of_energy(Trials trials) {
  Vector energies(static_cast<Index>(trials.size()));
  for (Index i = 0; i < energies.size(); ++i) energies[i] = trials[static_cast<std::size_t>(i)].energy_absorbed;
  return {energies.mean(), trials.size() > 1 ? std::sqrt(numeric::variance(energies)) : 0.0};
}

/// Energy against amplitude, one line for each arm, and where each crosses zero.
void add_crossover(const StudyOptions& options, Trials trials, ValidationTable& table) {
  Chart chart;
  chart.title = "The same arm against pulses of different amplitude";
  chart.x = {"amplitude of the force pulses", "N"};
  chart.y = {"energy that the arm absorbed", "J"};
  chart.horizontal = {{0.0, "passive above"}};
  const auto runs = static_cast<std::size_t>(options.runs);
  for (std::size_t arm = 0; arm < kArms.size(); ++arm) {
    ChartSeries line;
    line.name = fmt::format("P{}", kArms[arm]);
    line.drawn = ChartSeries::Drawn::line;
    for (std::size_t a = 0; a < kAmplitudes.size(); ++a) {
      const Spread energy = spread_of_energy(trials.subspan((a * kArms.size() + arm) * runs, runs));
      line.x.push_back(kAmplitudes[a]);
      line.y.push_back(energy.mean);
      line.intervals.emplace_back(energy.mean - energy.deviation, energy.mean + energy.deviation);
    }
    ValidationRow row;
    row.what = fmt::format("amplitude at which the mean energy crosses zero, P{}", kArms[arm]);
    row.value = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t a = 1; a < kAmplitudes.size(); ++a) {
      if (!(line.y[a - 1] < 0.0 && line.y[a] >= 0.0)) continue;
      row.value = line.x[a - 1] + (line.x[a] - line.x[a - 1]) * line.y[a - 1] / (line.y[a - 1] - line.y[a]);
    }
    row.interval99 = {row.value, row.value};
    row.expected = {2.0, 8.0};
    row.unit = "N";
    table.rows.push_back(row);
    chart.series.push_back(std::move(line));
  }
  chart.notes = {"Bars show one standard deviation over the seeds.", kTuned};
  table.charts.push_back(std::move(chart));
}

}  // namespace

Result<ValidationTable> participant_study(const StudyOptions& options) {
  if (options.runs < 1) return bad_usage(fmt::format("{} runs show nothing", options.runs), "pass --runs 10");
  const auto plans = all_plans(options);
  if (!plans) return tl::unexpected(plans.error());
  const auto trials = run_trials(*plans, options);
  if (!trials) return tl::unexpected(trials.error());

  ValidationTable table;
  table.study = "participant";
  table.question =
      "does the simulated participant behave as people did: passive when relaxed, active against small pulses, "
      "passive against large or sustained forces?";
  table.unit = "%";
  table.runs = options.runs;
  table.seed = options.seed;
  const auto runs = static_cast<std::size_t>(options.runs);
  Trials left = *trials;
  for (const Condition& condition : conditions()) {
    for (const int arm : kArms) {
      const Trials mine = left.first(runs);
      left = left.subspan(runs);
      table.rows.push_back(energy_row(condition, arm, mine));
      for (ValidationRow& row : vaf_rows(condition, arm, mine)) table.rows.push_back(std::move(row));
    }
  }
  add_crossover(options, left, table);
  table.notes = {
      kTuned,
      "E is the energy that the limb absorbed in one trial, without the handle; VAF is that of the published procedure "
      "on held-out data, mean of both axes.",
      "2 N and 8 N differ in amplitude_N alone."};
  return table;
}

}  // namespace mbk::validation
