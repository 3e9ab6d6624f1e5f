#include "mbk/measure/explore/measure_plateaus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/measure/explore/judge_stiffness.h"
#include "mbk/measure/explore/motion_share.h"
#include "mbk/measure/explore/stiffness_regression.h"

namespace mbk::explore {
namespace plateaus {

constexpr double kBaseline = 0.3;         // [s] before the onset
constexpr double kLatest = 0.3;           // [s] after the onset: before voluntary reaction
constexpr double kShortestWindow = 0.06;  // [s]
constexpr double kStep = 0.01;            // [s] between begins that are tried
constexpr double kShortestRamp = 0.01;    // [s]; a faster one is a step
constexpr double kStillEnough = 0.01;
constexpr double kSameRate = 1e-6;  // relative: clocks are read from time stamps

struct TrialRamp {
  const ExplorationTrial* trial;
  int recording;
  ReferenceRamp ramp;
};

struct SampleWindow {
  Index from, to;  // after the onset
};

Index samples_in(double seconds, double sample_time) {
  return static_cast<Index>(std::llround(seconds / sample_time));
}

Vector mean_of(const Matrix& values, Index begin, Index end) {
  return values.middleRows(begin, end - begin).colwise().mean().transpose();
}

DisplacedHand displaced(const TrialRamp& one, const SampleWindow& window) {
  const Index onset = one.ramp.onset, baseline = samples_in(kBaseline, one.trial->sample_time);
  const auto change = [&](const Matrix& values) -> Vector {
    return mean_of(values, onset + window.from, onset + window.to) - mean_of(values, onset - baseline, onset);
  };
  return {one.trial->from_s + static_cast<double>(onset) * one.trial->sample_time, one.recording, one.ramp.commanded,
          change(one.trial->input), change(one.trial->output)};
}

double motion_share(const std::vector<TrialRamp>& ramps, const SampleWindow& window) {
  MotionShare share;
  for (const TrialRamp& one : ramps) {
    share.add(one.trial->input.middleRows(one.ramp.onset + window.from, window.to - window.from),
              one.trial->sample_time, one.ramp.commanded);
  }
  return share.value();
}

/// Ramps whose hold and whose rest before are long enough.
std::vector<TrialRamp> long_enough(const std::vector<TrialRamp>& ramps, double to_s) {
  std::vector<TrialRamp> kept;
  for (const TrialRamp& one : ramps) {
    const double T = one.trial->sample_time;
    const ReferenceRamp& ramp = one.ramp;
    if (ramp.onset - ramp.rest_begin < samples_in(kBaseline, T)) continue;
    if (ramp.hold_end - ramp.onset < samples_in(to_s, T)) continue;
    kept.push_back(one);
  }
  return kept;
}

/// Seconds from the onset to where most holds end; the shortest tenth may be cut off.
double usual_hold_end(const std::vector<TrialRamp>& ramps) {
  std::vector<double> ends;
  for (const TrialRamp& one : ramps) {
    ends.push_back(static_cast<double>(one.ramp.hold_end - one.ramp.onset) * one.trial->sample_time);
  }
  std::ranges::sort(ends);
  return ends[ends.size() / 10];
}

double longest_ramp(const std::vector<TrialRamp>& ramps) {
  double longest = 0.0;
  for (const TrialRamp& one : ramps) {
    longest = std::max(longest, static_cast<double>(one.ramp.held - one.ramp.onset) * one.trial->sample_time);
  }
  return longest;
}

SampleWindow in_samples(double from_s, double to_s, double sample_time) {
  return {samples_in(from_s, sample_time), samples_in(to_s, sample_time)};
}

}  // namespace plateaus

std::vector<ReferenceRamp> displacing_ramps(const ExplorationTrial& trial, bool steps_too) {
  if (trial.reference.size() == 0 || trial.reference_quantity == ReferenceQuantity::force) return {};
  return find_ramps(trial.reference, trial.sample_time, steps_too ? 0.0 : plateaus::kShortestRamp);
}

bool is_ramp_and_hold(const ExplorationTrial& trial, const PlateauOptions& options) {
  return displacing_ramps(trial, options.asked()).size() >= 4;
}

Result<PlateauStiffness> plateau_stiffness(std::span<const ExplorationTrial> trials, const PlateauOptions& options) {
  using namespace plateaus;
  std::vector<TrialRamp> ramps;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (trials[k].axes != trials.front().axes ||
        std::abs(trials[k].sample_time / trials.front().sample_time - 1.0) > kSameRate) {
      return bad_data("the recordings have different axes or sample rates",
                      "explore them separately, or use --resample");
    }
    for (const ReferenceRamp& ramp : displacing_ramps(trials[k], options.asked())) {
      ramps.push_back({&trials[k], static_cast<int>(k), ramp});
    }
  }
  if (ramps.empty()) return bad_data("the reference has no ramp followed by a hold, or does not move along every axis");
  PlateauStiffness found;
  found.axes = trials.front().axes;
  found.baseline_s = kBaseline;
  const double T = trials.front().sample_time;
  const auto all = static_cast<int>(ramps.size());
  found.to_s = options.to_s.value_or(std::min(kLatest, usual_hold_end(ramps)));
  if (options.from_s) found.from_s = *options.from_s;
  if (options.asked() && !(found.from_s >= 0.0 && found.to_s - found.from_s >= 4.0 * T)) {
    return bad_usage(fmt::format("the plateau from {:g} ms to {:g} ms after the onset is not a valid window",
                                 1e3 * found.from_s, 1e3 * found.to_s),
                     "start it after the onset, with at least four samples");
  }
  ramps = long_enough(ramps, found.to_s);
  found.left_out = all - static_cast<int>(ramps.size());
  if (ramps.empty()) {
    return bad_data(fmt::format("no ramp has {:g} ms of rest before it and lasts until {:g} ms after its onset",
                                1e3 * kBaseline, 1e3 * found.to_s),
                    "hold longer, pause longer, or choose an earlier --plateau-to");
  }
  if (!options.from_s) {
    const double ramp = longest_ramp(ramps), last = found.to_s - kShortestWindow;
    if (ramp > last + 0.5 * T) {
      return bad_data(
          fmt::format("the ramps take {:.0f} ms, so too little of the plateau is left until {:.0f} ms after the onset",
                      1e3 * ramp, 1e3 * found.to_s),
          "ramp faster, or choose a later --plateau-to if the participant does not react before it");
    }
    found.from_s = kStep * std::ceil(ramp / kStep - 1e-6);
    while (found.from_s + kStep <= last + 1e-9 &&
           motion_share(ramps, in_samples(found.from_s, found.to_s, T)) > kStillEnough) {
      found.from_s += kStep;
    }
    found.from_s = std::min(found.from_s, last);
  }
  found.window_rule = fmt::format("{}, {}", options.from_s ? "from the requested time" : "from when the hand rests",
                                  options.to_s           ? "to the requested time"
                                  : found.to_s < kLatest ? "to the end of the hold"
                                                         : "to the earliest voluntary reaction");
  const SampleWindow window = in_samples(found.from_s, found.to_s, T);
  for (const TrialRamp& one : ramps) found.plateaus.push_back(displaced(one, window));
  auto fit = MBK_TRY(regress_stiffness(found.plateaus));
  found.fit = std::move(fit);
  found.motion_share = motion_share(ramps, window);
  return found;
}

std::vector<Warning> judge_plateaus(PlateauStiffness& found) {
  StiffnessVerdict verdict = judge_stiffness(found.fit, found.motion_share);
  found.usable = verdict.usable;
  return std::move(verdict.warnings);
}

}  // namespace mbk::explore
