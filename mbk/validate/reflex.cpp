#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/explore/impulse_response.h"
#include "mbk/measure/explore/parallel_cascade.h"
#include "mbk/measure/preprocess/exploration_trial_of.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_limbs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace reflex_detail {

constexpr double kDuration = 40.0, kRate = 500.0;

/// An ankle: kg·m², N·m·s/rad and N·m/rad.
SimulatedLimb joint() {
  SimulatedLimb limb;
  limb.M = Matrix::Constant(1, 1, 0.015);
  limb.B = Matrix::Constant(1, 1, 0.8);
  limb.K = Matrix::Constant(1, 1, 70.0);
  limb.direction = Vector::Ones(1);
  return limb;
}

/// A relaxed arm (Dyck 2013, participant P1).
SimulatedLimb arm() {
  SimulatedLimb limb;
  limb.M = Matrix{{1.326, -0.935}, {-0.935, 1.883}};
  limb.B = Matrix{{5.76, -2.14}, {-2.14, 10.56}};
  limb.K = Matrix{{42.4, -28.6}, {-28.6, 125.3}};
  limb.direction = Vector{{std::sqrt(0.5), std::sqrt(0.5)}};
  limb.bandwidth = 4.0;
  limb.amplitude = 0.01;
  return limb;
}

struct LimbCondition {
  const char* name;
  SimulatedLimb limb;
  bool reflex;                ///< it has one
  bool of_two_links = false;  ///< a ready scenario of a two-link arm in its place, whose geometry is not linear
};

Result<ExplorationTrial> two_link_trial(std::uint64_t seed) {
  auto scenarios = MBK_TRY(ready("relaxed_sinusoidal"));
  laboratory::Scenario& scenario = scenarios.front();
  scenario.seed = seed;
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  const Recording& recording = performance.recording;
  return preprocess::exploration_trial_of(recording, recording::inspect(recording), {});
}

std::vector<LimbCondition> limb_conditions() {
  std::vector<LimbCondition> all = {
      {"M-B-K", joint(), false},     {"M-B-K, two axes", arm(), false}, {"slow linear response", joint(), false},
      {"hardening", joint(), false}, {"reflex", joint(), true},         {"reflex, two axes", arm(), true}};
  all[2].limb.linear_gain = Vector::Constant(1, 3.0);
  all[3].limb.cubic = 3e4;  // a tenth of K at the edge of the motion
  all[4].limb.reflex_gain = Vector::Constant(1, 4.0);
  all[5].limb.reflex_gain = Vector{{20.0, 20.0}};
  all.push_back({"two links", arm(), false, true});
  return all;
}

/// What one run found, and whether its intervals hold the truth.
struct Run {
  std::vector<bool> held;  ///< of M, B and K from the impulse response, entry by entry
  bool enough = true;      ///< M, B and K, as said
  DelayedResponse found = DelayedResponse::none;
  bool direction = false;             ///< the right one
  std::vector<bool> gain, intrinsic;  ///< entry by entry
  std::optional<bool> second_gain, second_delay;
};

void add_held(const Matrix& value, const Matrix& half, const Matrix& truth, std::vector<bool>& held) {
  for (Index i = 0; i < value.rows(); ++i) {
    for (Index j = 0; j < value.cols(); ++j) held.push_back(std::abs(value(i, j) - truth(i, j)) <= half(i, j));
  }
}

void add_held(const ResponseModel& model, const SimulatedLimb& limb, std::vector<bool>& held) {
  if (!model.identifiable) return;
  add_held(model.M, model.M_half_width, limb.M, held);
  add_held(model.B, model.B_half_width, limb.B, held);
  add_held(model.K, model.K_half_width, limb.K, held);
}

Result<Run> run_of(const LimbCondition& condition, std::uint64_t seed) {
  const SimulatedLimb& limb = condition.limb;
  const auto trial =
      MBK_TRY(condition.of_two_links ? two_link_trial(seed) : simulate_limb(limb, kDuration, kRate, seed));
  const auto signals = MBK_TRY(explore::limb_signals({&trial, 1}));
  const auto response = MBK_TRY(explore::impulse_response(signals));
  const auto cascade = MBK_TRY(explore::parallel_cascade(signals));
  Run run;
  run.enough = response.model.enough;
  add_held(response.model, limb, run.held);
  run.found = cascade.found;
  if (run.found != DelayedResponse::reflex || !condition.reflex) return run;
  run.direction = (cascade.direction - limb.direction).norm() < 1e-6;
  add_held(cascade.intrinsic_model, limb, run.intrinsic);
  if (!run.direction) return run;
  const auto holds = [](const Margin& one, double truth) { return std::abs(one.value - truth) <= one.half_width; };
  for (Index j = 0; j < limb.reflex_gain.size(); ++j) {
    run.gain.push_back(holds(cascade.gain[static_cast<std::size_t>(j)], limb.reflex_gain[j]));
  }
  if (cascade.second_order) {
    run.second_gain = holds(cascade.second_order->gain[0], limb.reflex_gain[0]);
    run.second_delay = holds(cascade.second_order->delay, limb.delay);
  }
  return run;
}

/// Share of all entries of all runs. Entries of a run are not independent, so that its runs count as trials.
ValidationRow coverage_row(std::string what, const std::vector<Run>& runs,
                           const std::function<const std::vector<bool>&(const Run&)>& of,
                           std::optional<Range> expected) {
  double share = 0.0;
  int trials = 0;
  for (const Run& run : runs) {
    const std::vector<bool>& held = of(run);
    if (held.empty()) continue;
    share += static_cast<double>(std::ranges::count(held, true)) / static_cast<double>(held.size());
    ++trials;
  }
  return share_row(std::move(what), static_cast<int>(std::lround(share)), trials, expected);
}

Result<ValidationTable> study(const StudyOptions& options) {
  const std::vector<LimbCondition> all = limb_conditions();
  using RunOfAll = std::vector<Run>;
  const auto runs = MBK_TRY(seeded_runs(options, [&](std::uint64_t seed) -> Result<RunOfAll> {
    RunOfAll of_all;
    for (const LimbCondition& condition : all) {
      auto run = run_of(condition, seed);
      if (!run) return tl::unexpected(run.error().in(condition.name));
      of_all.push_back(std::move(*run));
    }
    return of_all;
  }));

  ValidationTable table{"reflex",
                        "are impulse responses and reflexes correct, and is no reflex found in a limb without one?",
                        "% of the trials", options.runs, options.seed};
  for (std::size_t k = 0; k < all.size(); ++k) {
    const LimbCondition& condition = all[k];
    std::vector<Run> own;
    for (const RunOfAll& run : runs) own.push_back(run[k]);
    const auto named = [&](const char* what) { return fmt::format("{}: {}", condition.name, what); };
    const auto share = [&](const char* what, std::optional<Range> expected, const std::function<bool(const Run&)>& is) {
      table.rows.push_back(share_row(named(what), own, is, expected));
    };
    const auto credited = [](const Run& run) { return run.found == DelayedResponse::reflex; };
    if (k <= 1) {
      table.rows.push_back(coverage_row(
          named("M, B, K of the impulse response held"), own, [](const Run& run) -> auto& { return run.held; },
          kNominal));
      share("M-B-K said not to be enough", kHardlyEver, [](const Run& run) { return !run.enough; });
    } else if (!condition.of_two_links) {
      share("M-B-K said not to be enough", kNearlyAlways, [](const Run& run) { return !run.enough; });
    }
    share("credited with a reflex", condition.reflex ? kNearlyAlways : kHardlyEver, credited);
    if (!condition.reflex) continue;
    share("direction of stretch found", kNearlyAlways, [](const Run& run) { return run.direction; });
    table.rows.push_back(coverage_row(
        named("gain held"), own, [](const Run& run) -> auto& { return run.gain; }, kNominal));
    table.rows.push_back(coverage_row(
        named("intrinsic M, B, K held"), own, [](const Run& run) -> auto& { return run.intrinsic; }, kNominal));
    const auto fitted = [&](const char* what, std::optional<bool> Run::*of) {
      int hits = 0, trials = 0;
      for (const Run& run : own) {
        if (!(run.*of)) continue;
        ++trials;
        hits += *(run.*of) ? 1 : 0;
      }
      table.rows.push_back(share_row(named(what), hits, trials, kNominal));
    };
    fitted("gain of the second-order response held", &Run::second_gain);
    fitted("delay of the second-order response held", &Run::second_delay);
  }
  table.notes = {
      "Joint: 0.015 kg·m², 0.8 N·m·s/rad, 70 N·m/rad under a random binary motion of ±0.02 rad, force noise of 0.3 "
      "N·m; "
      "arm: participant P1 of Dyck (2013) under ±1 cm along both axes, 0.3 N. 40 s at 500 Hz.",
      "Reflex: G ω²/(s + ω)² with ω = 20 rad/s after 60 ms, of velocity in one direction; the slow linear response is "
      "the same of velocity in both. Hardening: a tenth of the stiffness at the edge of the motion. Two links: the "
      "ready "
      "scenario relaxed_sinusoidal, whose geometry answers motion to and fro alike."};
  return table;
}

}  // namespace reflex_detail

Result<ValidationTable> reflex_study(const StudyOptions& options) {
  return reflex_detail::study(options);
}

}  // namespace mbk::validation
