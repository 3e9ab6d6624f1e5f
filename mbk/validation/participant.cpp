#include "mbk/validation/participant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "mbk/numeric/statistics.h"
#include "mbk/validation/simulated_trials.h"

namespace mbk::validation {
namespace {

using laboratory::PlanarTrial;
using laboratory::Scenario;

/// A ready scenario, and what is expected of it.
struct Condition {
  const char* name;                  ///< as it stands in the table
  const char* scenario;              ///< ready file
  double energy_sign;                ///< +1: the energy absorbed rises; −1: it falls
  std::pair<double, double> vaf;     ///< [%] that every run and axis must keep
  bool controller = true;
};

constexpr double kNone = std::numeric_limits<double>::infinity();

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> all = {
      {"relaxed, sinusoidal", "relaxed_sinusoidal", 1.0, {92.0, 100.0}},
      {"relaxed, underdamped", "relaxed_underdamped", 1.0, {92.0, 100.0}},
      {"rigid, 2 N pulses", "rigid_underdamped_2N", -1.0, {-kNone, 50.0}},
      {"rigid, 8 N pulses", "rigid_underdamped_8N", 1.0, {-kNone, 100.0}},
      {"rigid, 6 N sinusoidal", "rigid_sinusoidal_6N", 1.0, {60.0, 85.0}},
      {"rigid, 2 N pulses, controller off", "rigid_underdamped_2N", 1.0, {-kNone, 100.0}, false},
  };
  return all;
}

/// Amplitudes of the crossover [N].
constexpr std::array kAmplitudes = {1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0};

measurement::Options published_procedure() {
  measurement::Options options;
  options.preprocess.mode = Mode::reference;
  return options;
}

/// The scenario with the limb of a participant.
Result<Scenario> with_limb(Scenario scenario, int number) {
  const auto limb = participant::participant_limb(number);
  if (!limb) return tl::unexpected(limb.error());
  auto& arm = std::get<participant::ArmOptions>(std::get<PlanarTrial>(scenario.trial).load);
  std::get<participant::TwoLinkArm::Options>(arm.limb).joints = limb->joints;
  return scenario;
}

void switch_controller_off(Scenario& scenario) {
  std::get<participant::ArmOptions>(std::get<PlanarTrial>(scenario.trial).load).controller.position_gain = 0.0;
}

/// Every arm and seed of one scenario, appended to `plans`.
Result<void> add_plans(const Scenario& scenario, const ParticipantOptions& options, bool measured,
                       std::vector<TrialPlan>& plans) {
  for (const int arm : options.arms) {
    auto with_arm = with_limb(scenario, arm);
    if (!with_arm) return tl::unexpected(with_arm.error());
    for (int run = 0; run < options.runs; ++run) {
      with_arm->seed = options.seed + static_cast<std::uint64_t>(run);
      plans.push_back({*with_arm, measured ? std::optional(published_procedure()) : std::nullopt});
    }
  }
  return {};
}

Result<std::vector<TrialPlan>> all_plans(const ParticipantOptions& options) {
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
    std::get<laboratory::PulsePlan>(crossover->front().perturbation.kind).pulses.amplitude = amplitude;
    if (auto ok = add_plans(crossover->front(), options, false, plans); !ok) return tl::unexpected(ok.error());
  }
  return plans;
}

using Trials = std::span<const SimulatedTrial>;

ValidationRow energy_row(const Condition& condition, int arm, Trials trials) {
  const auto expected = [&](const SimulatedTrial& trial) { return trial.energy_absorbed * condition.energy_sign > 0.0; };
  const int hits = static_cast<int>(std::ranges::count_if(trials, expected));
  const int runs = static_cast<int>(trials.size());
  double lowest = kNone, highest = -kNone;
  for (const SimulatedTrial& trial : trials) {
    lowest = std::min(lowest, trial.energy_absorbed);
    highest = std::max(highest, trial.energy_absorbed);
  }
  const auto [low, high] = numeric::binomial_interval(hits, runs, 0.99);
  ValidationRow row;
  row.what = fmt::format("{}, P{}: E {} ({:+.2f} to {:+.2f} J)", condition.name, arm,
                         condition.energy_sign > 0.0 ? "rises" : "falls", lowest, highest);
  row.value = 100.0 * hits / runs;
  row.interval99 = {100.0 * low, 100.0 * high};
  row.wanted = {100.0, 100.0};
  return row;
}

}  // namespace
}  // namespace mbk::validation
