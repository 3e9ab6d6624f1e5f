#include "mbk/measure/explore/measure_reaches.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "mbk/measure/explore/servo_displacement.h"

namespace mbk::explore {
namespace reaches {

constexpr double kDisplaced = 0.1;  ///< of the largest displacement
constexpr std::size_t kMin = 8;     ///< undisturbed reaches that ReachPrediction takes
constexpr double kSameRate = 1e-6;  ///< relative: clocks are read from time stamps

struct Reach {
  RecordedReach recorded;
  Vector commanded;  ///< n [m]
};

/// The reach around a trigger, or nothing where the trial lacks a part of it.
std::optional<Reach> reach_at(const ExplorationTrial& trial, const Event& event,
                              const ServoDisplacementOptions& options) {
  const auto rows_in = [&](double seconds) { return static_cast<Index>(std::llround(seconds / trial.sample_time)); };
  const Index trigger = rows_in(event.time - trial.from_s), past = rows_in(options.prediction.past),
              future = rows_in(options.prediction.future), begin = trigger - past, end = trigger + future;
  if (begin < 0 || end > trial.samples()) return std::nullopt;
  Reach reach;
  reach.recorded.position = trial.input.middleRows(begin, end - begin);
  reach.recorded.force_hand_on_robot = -trial.output.middleRows(begin, end - begin);
  reach.recorded.trigger = past;
  const Index from = trigger + rows_in(options.from), to = trigger + rows_in(options.to);
  reach.commanded = (trial.reference.middleRows(from, to - from).rowwise() - trial.reference.row(trigger))
                        .colwise()
                        .mean()
                        .transpose();
  return reach;
}

struct Reaches {
  std::vector<RecordedReach> undisturbed;
  std::vector<DisplacedReach> displaced;
  int left_out = 0;
};

Result<Reaches> reaches_of(std::span<const ExplorationTrial> trials, const std::string& trigger,
                           const ServoDisplacementOptions& options) {
  std::vector<Reach> all;
  Reaches found;
  for (const ExplorationTrial& trial : trials) {
    if (std::abs(trial.sample_time - trials.front().sample_time) > kSameRate * trial.sample_time) {
      return bad_data("its sample rate differs from that of the first file", "", trial.source.label());
    }
    const bool with_reference = trial.reference.size() > 0;
    if (with_reference && trial.reference_quantity == ReferenceQuantity::force) {
      return bad_data("the reference is a force", "the reference of a reach is the displacement that was commanded",
                      trial.source.label());
    }
    ExplorationTrial still;
    const ExplorationTrial* source = &trial;
    if (!with_reference) {  // it never moves: every reach of the recording is undisturbed
      still = trial;
      still.reference = Matrix::Zero(trial.samples(), trial.input.cols());
      source = &still;
    }
    for (const Event& event : trial.events) {
      if (event.name != trigger) continue;
      if (auto reach = reach_at(*source, event, options)) {
        all.push_back(std::move(*reach));
      } else {
        ++found.left_out;
      }
    }
  }
  if (all.empty() && found.left_out == 0) {
    std::set<std::string> names;
    for (const ExplorationTrial& trial : trials) {
      for (const Event& event : trial.events) names.insert(event.name);
    }
    return bad_data(names.empty()
                        ? fmt::format("there is no event '{}': no events were recorded", trigger)
                        : fmt::format("there is no event '{}'; the events are {}", trigger, fmt::join(names, ", ")),
                    names.empty() ? "record an event at the start of each reach"
                                  : "name the event at which reaches are aligned with --trigger");
  }
  double largest = 0.0;
  for (const Reach& one : all) largest = std::max(largest, one.commanded.norm());
  for (Reach& one : all) {
    if (largest > 0.0 && one.commanded.norm() >= kDisplaced * largest) {
      found.displaced.push_back({std::move(one.recorded), std::move(one.commanded)});
    } else {
      found.undisturbed.push_back(std::move(one.recorded));
    }
  }
  if (found.displaced.empty()) {
    return bad_data(
        "no reach was displaced: the reference does not move after any trigger",
        "give as reference the commanded displacement relative to the predicted path: --channels xr=…,yr=…");
  }
  if (found.undisturbed.size() < kMin) {
    return bad_data(fmt::format("{} of {} reaches are undisturbed, but {} are needed to predict the others",
                                found.undisturbed.size(), all.size(), kMin),
                    "add recordings of undisturbed reaches, and give as reference the displacement only (zero if there "
                    "is none), not the path of the hand");
  }
  return found;
}

}  // namespace reaches

Result<ReachStiffness> reach_stiffness(std::span<const ExplorationTrial> trials, const ReachOptions& options,
                                       std::vector<Warning>& warnings) {
  using namespace reaches;
  ServoDisplacementOptions how;
  how.from = options.from_s.value_or(how.from);
  how.to = options.to_s.value_or(how.to);
  if (!(how.from >= 0.0 && how.to > how.from && how.to <= how.prediction.future)) {
    return bad_usage(
        fmt::format("the plateau from {:g} ms to {:g} ms after the trigger is not within the predicted {:g} ms",
                    1e3 * how.from, 1e3 * how.to, 1e3 * how.prediction.future));
  }
  auto all = MBK_TRY(reaches_of(trials, options.trigger, how));
  const double sample_time = trials.front().sample_time;
  auto own_past = MBK_TRY(servo_displacement_stiffness(all.undisturbed, all.displaced, sample_time, how));
  how.prediction.max_components = 0;
  auto mean_reach = MBK_TRY(servo_displacement_stiffness(all.undisturbed, all.displaced, sample_time, how));
  ReachStiffness found;
  found.axes = trials.front().axes;
  found.trigger = options.trigger;
  found.from_s = how.from;
  found.to_s = how.to;
  found.undisturbed = static_cast<int>(all.undisturbed.size());
  found.left_out = all.left_out;
  found.own_past = std::move(own_past.by);
  found.mean_reach = std::move(mean_reach.by);
  found.usable = own_past.verdict.usable;
  for (Warning& warning : own_past.verdict.warnings) warnings.push_back(std::move(warning));
  return found;
}

}  // namespace mbk::explore
