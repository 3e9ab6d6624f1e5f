#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "mbk/base/numeric/statistics.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using laboratory::PlanarTrial;
using laboratory::Scenario;

/// A ready scenario, and what is expected of it.
struct ConditionOfArm {
  const char* name;          ///< as it stands in the table
  const char* scenario;      ///< ready file
  double energy_sign;        ///< +1: the energy absorbed rises; −1: it falls
  std::optional<Range> vaf;  ///< [%] that the mean of both axes keeps nearly always
  bool controller = true;
};

const std::vector<ConditionOfArm>& conditions() {
  static const std::vector<ConditionOfArm> kAll = {
      {"relaxed, sinusoidal", "relaxed_sinusoidal", 1.0, Range{92.0, 100.0}},
      {"relaxed, underdamped", "relaxed_underdamped", 1.0, Range{92.0, 100.0}},
      {"rigid, 2 N pulses", "rigid_underdamped_2N", -1.0, at_most(50.0)},
      {"rigid, 8 N pulses", "rigid_underdamped_8N", 1.0, {}},
      {"rigid, 6 N sinusoidal", "rigid_sinusoidal_6N", 1.0, Range{60.0, 85.0}},
      {"rigid, 2 N pulses, controller off", "rigid_underdamped_2N", 1.0, {}, false},
  };
  return kAll;
}

constexpr const char* kTuned =
    "The gains of the participant's controller are tuned to the findings of Dyck (2013, chapter 4), not fitted to "
    "anyone.";

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
    auto with_arm = MBK_TRY(with_limb(scenario, arm));
    for (int run = 0; run < options.runs; ++run) {
      with_arm.seed = options.seed + static_cast<std::uint64_t>(run);
      plans.push_back({with_arm, measured ? std::optional(published_procedure()) : std::nullopt});
    }
  }
  return {};
}

Result<std::vector<TrialPlan>> all_plans(const StudyOptions& options) {
  std::vector<TrialPlan> plans;
  for (const ConditionOfArm& condition : conditions()) {
    auto scenarios = MBK_TRY(ready(condition.scenario));
    if (!condition.controller) switch_controller_off(scenarios.front());
    MBK_TRY(add_plans(scenarios.front(), options, true, plans));
  }
  auto crossover = MBK_TRY(ready("rigid_underdamped_2N"));
  for (const double amplitude : kAmplitudes) {
    std::get<perturbation::PulsePlan>(crossover.front().perturbation.kind).pulses.amplitude = amplitude;
    MBK_TRY(add_plans(crossover.front(), options, false, plans));
  }
  return plans;
}

using Trials = std::span<const SimulatedTrial>;

/// "at most 50 %", "60 to 85 %".
std::string words_of(const Range& range) {
  if (!std::isfinite(range.first)) return fmt::format("at most {:g} %", range.second);
  return fmt::format("{:g} to {:g} %", range.first, range.second);
}

using Values = std::function<double(const SimulatedTrial&)>;

Vector collected(Trials trials, const Values& value) {
  Vector values(static_cast<Index>(trials.size()));
  for (Index i = 0; i < values.size(); ++i) values[i] = value(trials[static_cast<std::size_t>(i)]);
  return values;
}

double energy_of(const SimulatedTrial& trial) {
  return trial.energy_absorbed;
}

double vaf_of(const SimulatedTrial& trial) {
  return trial.identification.fit.vaf.mean();
}

/// Of each arm: in how many trials the energy has the expected sign and the VAF its band; and the means.
void add_condition(const ConditionOfArm& condition, Trials trials, ValidationTable& table) {
  for (std::size_t arm = 0; arm < kArms.size(); ++arm) {
    const std::size_t runs = trials.size() / kArms.size();
    const Trials mine = trials.subspan(arm * runs, runs);
    const std::string name = fmt::format("{}, P{}: ", condition.name, kArms[arm]);
    const auto share = [&](const std::string& what, const std::function<bool(const SimulatedTrial&)>& is) {
      table.rows.push_back(share_row(name + what, mine, is, kNearlyAlways));
    };
    share(condition.energy_sign > 0.0 ? "E rises" : "E falls",
          [&](const SimulatedTrial& trial) { return energy_of(trial) * condition.energy_sign > 0.0; });
    if (condition.vaf) {
      share("VAF " + words_of(*condition.vaf), [&](const SimulatedTrial& trial) {
        return condition.vaf->first <= vaf_of(trial) && vaf_of(trial) <= condition.vaf->second;
      });
    }
    table.rows.push_back(mean_row(name + "mean E", collected(mine, energy_of), {}, "J"));
    table.rows.push_back(mean_row(name + "mean VAF", collected(mine, vaf_of), {}, "%"));
  }
}

/// Where straight lines through (x, y) cross zero upwards, the last time; −∞ where y stays above zero, ∞ where it ends
/// below.
double crossing(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (y.back() < 0.0) return kNever;
  for (std::size_t k = x.size() - 1; k > 0; --k) {
    if (y[k - 1] < 0.0) return x[k - 1] + (x[k] - x[k - 1]) * y[k - 1] / (y[k - 1] - y[k]);
  }
  return -kNever;
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
    std::vector<std::vector<double>> of_run(runs);  // energy by amplitude
    for (std::size_t a = 0; a < kAmplitudes.size(); ++a) {
      const Vector energy = collected(trials.subspan((a * kArms.size() + arm) * runs, runs), energy_of);
      const double deviation = std::sqrt(numeric::variance(energy));
      line.x.push_back(kAmplitudes[a]);
      line.y.push_back(energy.mean());
      line.intervals.emplace_back(energy.mean() - deviation, energy.mean() + deviation);
      for (std::size_t run = 0; run < runs; ++run) of_run[run].push_back(energy[static_cast<Index>(run)]);
    }
    Vector amplitude(static_cast<Index>(runs));
    for (std::size_t run = 0; run < runs; ++run) amplitude[static_cast<Index>(run)] = crossing(line.x, of_run[run]);
    table.rows.push_back(median_row(fmt::format("amplitude at which the energy crosses zero, P{}", kArms[arm]),
                                    amplitude, Range{2.0, 8.0}, "N"));
    chart.series.push_back(std::move(line));
  }
  chart.notes = {"Bars show one standard deviation over the seeds.", kTuned};
  table.charts.push_back(std::move(chart));
}

}  // namespace

Result<ValidationTable> participant_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  const auto plans = MBK_TRY(all_plans(options));
  const auto trials = MBK_TRY(run_trials(plans, options));

  ValidationTable table{
      "participant",
      "does the simulated participant behave as people did: passive when relaxed, active under small pulses, "
      "passive under large or sustained forces?",
      "%", options.runs, options.seed};
  Trials left = trials;
  for (const ConditionOfArm& condition : conditions()) {
    const std::size_t trials_of_it = kArms.size() * static_cast<std::size_t>(options.runs);
    add_condition(condition, left.first(trials_of_it), table);
    left = left.subspan(trials_of_it);
  }
  add_crossover(options, left, table);
  table.notes = {
      kTuned,
      "E is the energy that the limb absorbed in one trial, without the handle; VAF is that of the published procedure "
      "on held-out data, mean of both axes.",
      "2 N and 8 N differ in amplitude_N alone; the crossing is that of "
      "each run, by straight lines between the amplitudes."};
  return table;
}

}  // namespace mbk::validation
