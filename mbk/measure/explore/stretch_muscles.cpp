#include "mbk/measure/explore/stretch_muscles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/emg.h"
#include "mbk/measure/explore/emg_responses.h"
#include "mbk/measure/explore/stretch.h"

namespace mbk::explore {
namespace stretch_muscles {

constexpr double kHalf = 0.025;                        ///< half a window [s]
constexpr double kMaxRest = 0.5, kMinRest = 0.2;       ///< [s]
constexpr double kStill = 0.01;                        ///< of the travel: how far the limb may move in a rest
constexpr double kFalseOnsets = 0.05;                  ///< of a muscle, over all stretches
constexpr double kHalfLevel = 0.05;                    ///< at which each half of a window exceeds the background
constexpr double kMinWindows = 20.0, kMinRests = 3.0;  ///< of the variation in the rests
constexpr double kNearlyAll = 0.9;                     ///< of the stretches at a speed
constexpr double kAfterConstant = 0.05;                ///< of an onset after the start of the plateau [s]
constexpr int kMinSpeeds = 3;
constexpr Index kMaxBins = 60;
constexpr double kMinBin = 0.005;  ///< [s]
constexpr int kScoringSteps = 6;
constexpr double kUpper = 0.975;

/// One muscle in one recording: running sums of the squared EMG in the band.
struct Power {
  Vector sums;
  double sample_time = 0;
  [[nodiscard]] Index sample(double time) const {
    return std::clamp<Index>(std::llround(time / sample_time), 0, sums.size() - 1);
  }
  [[nodiscard]] double mean(Index from, Index to) const {
    return (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
};

/// What of a stretch is the same for all muscles.
struct Place {
  const StretchMovement* move = nullptr;
  Index direction = 0, group = 0;
  double rest_s = 0;  ///< start of the rest before the movement
  bool rested = false;
};

double position_at(const ExplorationTrial& trial, int axis, double time) {
  const double row =
      std::clamp((time - trial.from_s) / trial.sample_time, 0.0, static_cast<double>(trial.samples()) - 1.0);
  const auto before = std::min(static_cast<Index>(row), std::max<Index>(trial.samples() - 2, 0));
  const double along = row - static_cast<double>(before);
  const Index after = std::min(before + 1, trial.samples() - 1);
  return (1.0 - along) * trial.input(before, axis) + along * trial.input(after, axis);
}

/// The rest before a movement: where the position stays.
void find_rest(const ExplorationTrial& trial, int axis, Place& place) {
  const StretchMovement& move = *place.move;
  const double still = kStill * std::abs(move.to - move.from), at = position_at(trial, axis, move.begin_s);
  double start = move.begin_s;
  while (start > move.begin_s - kMaxRest && start > trial.from_s &&
         std::abs(position_at(trial, axis, start - trial.sample_time) - at) <= still) {
    start -= trial.sample_time;
  }
  place.rest_s = std::max(start, trial.from_s);
  place.rested = move.begin_s - place.rest_s >= kMinRest - trial.sample_time;
}

std::vector<Place> places_of(const StretchEstimate& found, std::span<const ExplorationTrial> trials) {
  std::vector<Place> places;
  for (std::size_t d = 0; d < found.directions.size(); ++d) {
    const StretchDirection& one = found.directions[d];
    for (const StretchMovement& move : one.stretches) {
      Place place;
      place.move = &move;
      place.direction = static_cast<Index>(d);
      for (std::size_t g = 1; g < one.speeds.size(); ++g) {
        const auto away = [&](std::size_t k) { return std::abs(std::log(move.speed / one.speeds[k].speed)); };
        if (away(g) < away(static_cast<std::size_t>(place.group))) place.group = static_cast<Index>(g);
      }
      find_rest(trials[static_cast<std::size_t>(move.recording)], found.axis, place);
      places.push_back(place);
    }
  }
  return places;
}

/// Degrees of freedom of the mean square of a window in the rests before the stretches of one direction, from its
/// variation within and between them: that of ln(χ²/ν) is 2/ν. 0 where the rests are too few.
/// @param window  [s]; absent: whole rests
double rest_freedom(const std::vector<Place>& places, const std::vector<Power>& powers, Index direction,
                    std::optional<double> window) {
  std::vector<double> logs;
  double most = kInfinity;
  for (const Place& place : places) {
    if (!place.rested || place.direction != direction) continue;
    const Power& power = powers[static_cast<std::size_t>(place.move->recording)];
    const Index rest = power.sample(place.rest_s), begin = power.sample(place.move->begin_s);
    const auto length =
        window ? std::max<Index>(std::llround(*window / power.sample_time), 1) : std::max<Index>(begin - rest, 1);
    most = std::min(most, static_cast<double>(length));
    for (Index end = begin; end - length >= rest; end -= length) {
      const double mean = power.mean(end - length, end);
      if (mean > 0.0) logs.push_back(std::log(mean));
    }
  }
  const auto n = static_cast<double>(logs.size());
  if (n < (window ? kMinWindows : kMinRests)) return 0.0;
  const double squares = (n - 1.0) * numeric::variance(Vector::Map(logs.data(), static_cast<Index>(logs.size())));
  return squares > 0.0 ? std::min(2.0 * numeric::chi_square_quantile(kFalseOnsets, n - 1.0) / squares, most) : 0.0;
}

/// How EMG varies at rest: degrees of freedom of mean squares.
struct Variation {
  double window = 0, half = 0, background = 0;
};

/// The time at which the EMG is first seen to exceed its background.
std::optional<double> detected(const Place& place, const Power& power, const Variation& rests, double level) {
  const auto half = std::max<Index>(std::llround(kHalf / power.sample_time), 1);
  const Index rest = power.sample(place.rest_s), begin = power.sample(place.move->begin_s),
              end = power.sample(place.move->end_s);
  const double background = power.mean(rest, begin);
  const auto count = (end - begin) / half - 1;
  if (count < 1 || !(background > 0.0)) return std::nullopt;
  const double limit = numeric::f_quantile(1.0 - level / static_cast<double>(count), rests.window, rests.background);
  const double half_limit = numeric::f_quantile(1.0 - kHalfLevel, rests.half, rests.background);
  for (Index k = 0; k < count; ++k) {
    const Index at = begin + k * half;
    if (power.mean(at, at + 2 * half) > limit * background && power.mean(at, at + half) > half_limit * background &&
        power.mean(at + half, at + 2 * half) > half_limit * background) {
      return static_cast<double>(at) * power.sample_time;
    }
  }
  return std::nullopt;
}

/// Log-likelihood, times 2/n, of amplitudes background + a shape, with the best a ≥ 0.
double rise_likelihood(const Vector& power, const Vector& shape, double background) {
  const Vector squared = shape.cwiseAbs2();
  double a = std::sqrt(std::max(0.0, power.dot(squared) / squared.squaredNorm())) - background;
  a = std::max(a, 0.1 * background);
  Vector amplitude;
  for (int step = 0; step < kScoringSteps; ++step) {
    amplitude = (a * shape).array() + background;
    const auto variance = amplitude.array().square();
    const double score = (shape.array() * (power.array() - variance) / (variance * amplitude.array())).sum();
    const double information = 2.0 * (squared.array() / variance).sum();
    a = std::max(a + score / information, 0.0);
  }
  amplitude = (a * shape).array() + background;
  return -(2.0 * amplitude.array().log() + power.array() / amplitude.array().square()).sum();
}

/// Where the rise that was detected begins.
double rise_begin(const Place& place, const Power& power, double seen) {
  const Index begin = power.sample(place.move->begin_s);
  const double last = std::min(std::max(place.move->to_s, seen + 2.0 * kHalf), place.move->end_s);
  const Index end = power.sample(last);
  const auto shortest = std::max<Index>(std::llround(kMinBin / power.sample_time), 1);
  const Index bins = std::clamp<Index>((end - begin) / shortest, 1, kMaxBins);
  const double background = std::sqrt(power.mean(power.sample(place.rest_s), begin));
  const double width = static_cast<double>(end - begin) / static_cast<double>(bins);
  const auto edge = [&](Index k) { return begin + static_cast<Index>(std::llround(static_cast<double>(k) * width)); };
  Vector means(bins), centre(bins), shape(bins);
  for (Index k = 0; k < bins; ++k) {
    means[k] = power.mean(edge(k), edge(k + 1));
    centre[k] = static_cast<double>(k) + 0.5;
  }
  const double latest = (static_cast<double>(power.sample(seen + 2.0 * kHalf) - begin)) / width;
  double best = latest, largest = -kInfinity;
  for (double from = 0.0; from <= latest; from += 0.5) {
    for (double to = from + 0.5; to <= static_cast<double>(bins) + 1.0; to += to - from < 4.0 ? 0.5 : 2.0) {
      shape = ((centre.array() - from) / (to - from)).cwiseMax(0.0).cwiseMin(1.0);
      if (!(shape.maxCoeff() > 0.0)) continue;
      const double likelihood = rise_likelihood(means, shape, background);
      if (likelihood <= largest) continue;
      largest = likelihood;
      best = from;
    }
  }
  return (static_cast<double>(begin) + best * width) * power.sample_time;
}

/// Σ w y and its interval; errors by the scatter within groups, or about the line where a group has one member.
StretchValue weighted_sum(const Vector& weight, const Vector& y, const Vector& residual,
                          const std::vector<Index>& group) {
  StretchValue sum{weight.dot(y), std::nullopt};
  double variance = 0.0, fourth = 0.0;
  const Index groups = *std::ranges::max_element(group) + 1;
  bool repeated = true;
  for (Index g = 0; g < groups; ++g) {
    std::vector<double> here;
    double squares = 0.0;
    for (Index i = 0; i < y.size(); ++i) {
      if (group[static_cast<std::size_t>(i)] != g) continue;
      here.push_back(y[i]);
      squares += weight[i] * weight[i];
    }
    if (here.empty()) continue;
    repeated = repeated && here.size() > 1;
    if (!repeated) break;
    const double share = squares * numeric::variance(Vector::Map(here.data(), static_cast<Index>(here.size())));
    variance += share;
    fourth += share * share / (static_cast<double>(here.size()) - 1.0);
  }
  double freedom = fourth > 0.0 ? variance * variance / fourth : 0.0;
  if (!repeated) {
    freedom = static_cast<double>(y.size()) - 2.0;
    variance = freedom > 0.0 ? residual.squaredNorm() / freedom * weight.squaredNorm() : 0.0;
  }
  if (!(freedom > 0.0)) return sum;
  const double reach = numeric::student_quantile(kUpper, freedom) * std::sqrt(variance);
  sum.interval95 = Interval(sum.value - reach, sum.value + reach);
  return sum;
}

struct Onsets {
  std::vector<double> speed, angle;
  std::vector<Index> group;
};

/// @param start  where the stretches begin
void extrapolate(const Onsets& used, int speeds, const Interval& range, double start, StretchMuscle& muscle) {
  const auto n = static_cast<Index>(used.speed.size());
  const Vector v = Vector::Map(used.speed.data(), n), y = Vector::Map(used.angle.data(), n);
  const Vector centred = v.array() - v.mean();
  const double slope = centred.dot(y) / centred.squaredNorm();
  const Vector weight = 1.0 / static_cast<double>(n) - (v.mean() / centred.squaredNorm() * centred).array();
  const Vector residual = (y.array() - y.mean()).matrix() - slope * centred;
  muscle.threshold = weighted_sum(weight, y, residual, used.group);
  muscle.shift = slope;
  constexpr double kNearStart = 0.05;  // of the range
  const Interval within = muscle.threshold->interval95.value_or(Interval(kInfinity, -kInfinity));
  if (std::abs(muscle.threshold->value - start) < kNearStart * (range.second - range.first) ||
      (within.first <= start && start <= within.second)) {
    muscle.threshold.reset();
    muscle.shift.reset();
    muscle.threshold_note =
        "the onsets extrapolate to where the stretches begin, as those of a reaction at a constant time after the "
        "start do: it cannot be distinguished from a threshold";
    return;
  }
  const bool outside = muscle.threshold->value < range.first || muscle.threshold->value > range.second;
  muscle.threshold_note = fmt::format("from {} stretches at {} speeds{}", n, speeds,
                                      outside ? "; it is outside the stretched positions" : "");
}

/// Positions of all stretches of a direction, from where they leave rest to where they come to rest.
Interval stretched_range(const StretchDirection& found, std::span<const ExplorationTrial> trials, int axis) {
  Interval range(kInfinity, -kInfinity);
  for (const StretchMovement& move : found.stretches) {
    for (const double time : {move.begin_s, move.end_s}) {
      const double at = position_at(trials[static_cast<std::size_t>(move.recording)], axis, time);
      range = {std::min(range.first, at), std::max(range.second, at)};
    }
  }
  return range;
}

/// Running sums of one muscle in all recordings, or why there are none.
Result<std::vector<Power>> powers_of(const std::string& name, std::span<const Recording* const> recordings,
                                     std::span<const ExplorationTrial> trials, std::string& reason) {
  std::vector<Power> powers;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const auto how = emg_processing_at(Hertz(1.0 / trials[k].sample_time), {});
    if (!how) {
      reason = how.error().message;
      return powers;
    }
    const Vector& raw = recordings[k]->find(name)->values;
    for (const EmgFinding& finding : check_emg(raw, *how)) {
      if (finding.usable) continue;
      reason = finding.message;
      return powers;
    }
    const auto band = MBK_TRY(emg_band(raw, *how));
    Power power;
    power.sample_time = trials[k].sample_time;
    power.sums = running_sums(band.cwiseAbs2());
    powers.push_back(std::move(power));
  }
  return powers;
}

/// One muscle in each direction.
Result<std::vector<StretchMuscle>> muscle_of(const std::string& name, std::span<const Recording* const> recordings,
                                             std::span<const ExplorationTrial> trials, const std::vector<Place>& places,
                                             const StretchEstimate& found) {
  std::string reason;
  const auto powers = MBK_TRY(powers_of(name, recordings, trials, reason));
  std::vector<StretchMuscle> muscles(found.directions.size());
  const double rested = static_cast<double>(std::ranges::count(places, true, &Place::rested));
  for (std::size_t d = 0; d < muscles.size(); ++d) {
    StretchMuscle& muscle = muscles[d];
    const StretchDirection& direction = found.directions[d];
    muscle.name = name;
    muscle.reason = reason;
    Variation rests;
    if (reason.empty()) {
      const auto at = static_cast<Index>(d);
      rests = {rest_freedom(places, powers, at, 2.0 * kHalf), rest_freedom(places, powers, at, kHalf),
               rest_freedom(places, powers, at, std::nullopt)};
      if (!(rests.window > 0.0 && rests.half > 0.0 && rests.background > 0.0)) {
        muscle.reason = fmt::format("rests of {:.0f} ms or more before these stretches are too few for a background",
                                    kMilliseconds * kMinRest);
      }
    }
    muscle.usable = muscle.reason.empty();
    if (!muscle.usable) continue;
    Onsets used;
    int speeds = 0, all = 0, late = 0, early = 0;
    for (std::size_t g = 0; g < direction.speeds.size(); ++g) {
      StretchMuscleSpeed one;
      one.speed = direction.speeds[g].speed;
      std::vector<double> angle, speed;
      int constant = 0;
      for (const Place& place : places) {
        if (place.direction != static_cast<Index>(d) || place.group != static_cast<Index>(g) || !place.rested) continue;
        ++one.stretches;
        const auto recording = static_cast<std::size_t>(place.move->recording);
        const Power& power = powers[recording];
        const auto seen = detected(place, power, rests, kFalseOnsets / rested);
        if (!seen) continue;
        const double time = rise_begin(place, power, *seen);
        angle.push_back(position_at(trials[recording], found.axis, time));
        speed.push_back(place.move->speed);
        if (time >= place.move->from_s + kAfterConstant) ++constant;
      }
      one.onsets = static_cast<int>(angle.size());
      all += one.onsets;
      if (!angle.empty()) {
        const Vector weight = Vector::Constant(one.onsets, 1.0 / one.onsets), y = Vector::Map(angle.data(), one.onsets);
        one.onset_angle = weighted_sum(weight, y, y, std::vector<Index>(angle.size(), 0));
        if (one.onsets < 2) one.onset_angle->interval95.reset();
      }
      if (one.onsets > 0 && one.onsets < kNearlyAll * one.stretches) {
        ++late;
      } else if (one.onsets > 0 && constant < kNearlyAll * one.onsets) {
        ++early;
      } else if (one.onsets > 0) {
        ++speeds;
        used.speed.insert(used.speed.end(), speed.begin(), speed.end());
        used.angle.insert(used.angle.end(), angle.begin(), angle.end());
        used.group.insert(used.group.end(), angle.size(), static_cast<Index>(g));
      }
      muscle.speeds.push_back(one);
    }
    if (all == 0) {
      muscle.threshold_note = "EMG did not exceed the background in any stretch";
    } else if (speeds < kMinSpeeds) {
      muscle.threshold_note = fmt::format(
          "nine in ten stretches or more have an onset at {} speed{}; three speeds are needed{}", speeds + early,
          speeds + early == 1 ? "" : "s",
          early > 0 ? fmt::format("; at {} of them the onset is before the velocity is constant", early) : "");
    } else {
      const Interval range = stretched_range(direction, trials, found.axis);
      extrapolate(used, speeds, range, direction.direction > 0 ? range.first : range.second, muscle);
      if (late + early > 0) {
        muscle.threshold_note += fmt::format("; {} other speed{} hid{} late or early onsets", late + early,
                                             late + early == 1 ? "" : "s", late + early == 1 ? "es" : "e");
      }
    }
  }
  return muscles;
}

/// Torque does not show a reflex over the whole range; EMG does.
void say_what_torque_misses(StretchDirection& direction) {
  if (direction.verdict == VelocityDependence::velocity_dependent) return;
  for (const StretchMuscle& muscle : direction.muscles) {
    int stretches = 0, onsets = 0;
    for (const StretchMuscleSpeed& one : muscle.speeds) {
      stretches += one.stretches;
      onsets += one.onsets;
    }
    if (2 * onsets <= stretches) continue;
    direction.verdict_reason += fmt::format("; but {} responds in {} of {} stretches: a reflex or a voluntary response",
                                            muscle.name, onsets, stretches);
  }
}

}  // namespace stretch_muscles

Result<void> add_stretch_muscles(std::span<const Recording* const> recordings, std::span<const ExplorationTrial> trials,
                                 StretchEstimate& found) {
  using namespace stretch_muscles;
  std::vector<std::string> names;
  for (const Channel& channel : recordings.front()->channels) {
    if (is_emg(channel) &&
        std::ranges::all_of(recordings, [&](const Recording* one) { return one->find(channel.name) != nullptr; })) {
      names.push_back(channel.name);
    }
  }
  if (names.empty()) return {};
  const auto places = places_of(found, trials);
  std::vector<std::vector<StretchMuscle>> muscles(names.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(names.size()), 2, [&](int k) -> Result<void> {
    const auto at = static_cast<std::size_t>(k);
    auto one = muscle_of(names[at], recordings, trials, places, found);
    if (!one) return tl::unexpected(one.error().in(names[at]));
    muscles[at] = std::move(*one);
    return {};
  }));
  for (const auto& one : muscles) {
    for (std::size_t d = 0; d < found.directions.size(); ++d) found.directions[d].muscles.push_back(one[d]);
  }
  std::erase(found.limits, kTorqueAlone);
  for (StretchDirection& direction : found.directions) say_what_torque_misses(direction);
  return {};
}

}  // namespace mbk::explore
