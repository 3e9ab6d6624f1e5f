#include "mbk/files/xdf/xdf_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "mbk/files/xdf/xdf_robust.h"

namespace mbk::recording {
namespace {

constexpr Index kOffsetsBeside = 8;  ///< of a step, on each side
constexpr Index kFewOffsets = 3;     ///< that show a step by their median where one of them is wrong
constexpr Index kNeighbours = 3;
constexpr double kSteepest = 5e-4;       ///< [1] a clock that is slewed runs no faster
constexpr Index kToKnowNoise = 5;        ///< offsets at least
constexpr Index kSamplesBeside = 25;     ///< of a jump, on each side
constexpr double kOfMedian = 1.2533;     ///< standard error of a median over that of a mean
constexpr double kSmallestStep = 2e-4;   ///< [s] that stamps have to confirm
constexpr double kSmallestBlind = 1e-3;  ///< [s] that offsets alone show
constexpr double kSmallestFew = 0.025;   ///< [s] the same, where they are too few to know their noise
constexpr double kLongPause = 0.25;      ///< [s] without samples
constexpr Index kReadings = 50;          ///< of each sample at most, whatever the offsets say

/// A value and its standard error.
struct Estimate {
  double value = 0.0, error = 0.0;
};

/// How far offsets jump, with the same drift on both sides.
struct Jump : Estimate {
  double slope = 0.0;  ///< [s/s], of both sides
  double bent = 0.0;   ///< [s], the jump where each side has a drift of its own
  double turn = 0.0;   ///< [s], what a change of the drift between the two offsets can make of it
  Index ahead = 0;     ///< offsets behind it
};

class StepFinder {
 public:
  explicit StepFinder(SenderClock& clock)
      : clock_(clock),
        noise_(noise_of_offsets(clock.times, clock.values)),
        interval_(usual_interval()),
        budget_(kReadings * clock.stamps.size()) {
    const Vector off = (differences(clock.stamps).array() - interval_).abs();
    jumps_.assign(off.data(), off.data() + off.size());
    std::ranges::sort(jumps_);
  }

  /// @param blind  looks for steps that offsets alone show, instead of those that stamps show too
  std::vector<ClockStep> run(bool blind) {
    for (Index gap = 0; gap + 1 < clock_.times.size(); ++gap) {
      if (auto step = blind ? blind_step(gap) : seen_step(gap)) {
        shift_ += step->size;
        steps_.push_back(*step);
      }
      clock_.times[gap + 1] += shift_;
      clock_.values[gap + 1] -= shift_;
    }
    // Behind each step by the sum of all until then.
    double sum = 0.0;
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      sum += steps_[k].size;
      const Index end = k + 1 < steps_.size() ? steps_[k + 1].first : clock_.stamps.size();
      clock_.stamps.segment(steps_[k].first, end - steps_[k].first).array() += sum;
    }
    return std::move(steps_);
  }

 private:
  /// The interval of samples, from the median of longer ones: stamps that are quantised do not make it coarse.
  [[nodiscard]] double usual_interval() const {
    const Vector& stamps = clock_.stamps;
    const Index count = std::min<Index>(2 * kSamplesBeside, stamps.size() / 4);
    if (count < 1) return 0.0;
    const Index pairs = stamps.size() - count;
    return median_of(stamps.tail(pairs) - stamps.head(pairs)) / static_cast<double>(count);
  }

  /// The stamp of a sample on the clock from before the steps that were found.
  [[nodiscard]] double stamp(Index k) const {
    double shift = shift_;
    for (std::size_t s = steps_.size(); s > 0 && steps_[s - 1].first > k; --s) shift -= steps_[s - 1].size;
    return clock_.stamps[k] + shift;
  }
  // Offsets up to the gap that is looked at are on that clock, those behind it are not yet.
  [[nodiscard]] double time(Index i, Index gap) const { return clock_.times[i] + (i > gap ? shift_ : 0.0); }
  [[nodiscard]] double value(Index i, Index gap) const { return clock_.values[i] - (i > gap ? shift_ : 0.0); }

  /// A step that the stamps of samples show too.
  std::optional<ClockStep> seen_step(Index gap) {
    for (const bool pause : {false, true}) {
      if (auto step = at_any_width(gap, [&](const Jump& jump) { return seen(gap, jump, pause); })) return step;
    }
    return std::nullopt;
  }
  /// A step that offsets alone show.
  std::optional<ClockStep> blind_step(Index gap) {
    return blind(gap, jump_at(gap, std::min(kOffsetsBeside, clock_.times.size() - gap - 1)));
  }

  /// Of eight offsets behind the gap, and of fewer: another step may follow soon.
  template <class Find>
  std::optional<ClockStep> at_any_width(Index gap, const Find& find) {
    const Index most = std::min(kOffsetsBeside, clock_.times.size() - gap - 1);
    auto step = find(jump_at(gap, most));
    if (!step && most > kFewOffsets) step = find(jump_at(gap, kFewOffsets));
    if (!step && most > 1) step = find(jump_at(gap, 1));
    return step;
  }

  /// How far the offsets behind a gap are above those before it.
  [[nodiscard]] Jump jump_at(Index gap, Index ahead) const {
    const Side before = side(std::max<Index>(0, gap + 1 - kOffsetsBeside), gap + 1, gap);
    const Side behind = side(gap + 1, gap + 1 + ahead, gap);
    std::vector<double> slopes = before.slopes;
    slopes.insert(slopes.end(), behind.slopes.begin(), behind.slopes.end());
    Jump jump;
    jump.ahead = ahead;
    jump.slope = median_slope(slopes);
    const double middle = (time(gap, gap) + time(gap + 1, gap)) / 2.0;
    // The times behind the gap are off by the step as well.
    jump.value = (level(behind, jump.slope, middle, gap) - level(before, jump.slope, middle, gap)) / (1.0 + jump.slope);
    const double slopes_differ = median_slope(behind.slopes) - median_slope(before.slopes);
    jump.bent = level(behind, median_slope(behind.slopes), middle, gap) -
                level(before, median_slope(before.slopes), middle, gap);
    jump.turn = std::abs(slopes_differ) * (time(gap + 1, gap) - time(gap, gap));
    const double distance = behind.centre - before.centre, spread = before.spread + behind.spread;
    const double noise = kOfMedian * noise_;
    const double of_levels =
        noise * noise * (1.0 / static_cast<double>(before.count()) + 1.0 / static_cast<double>(behind.count()));
    const double of_slope = distance * (spread > 0.0 ? noise / std::sqrt(spread) : kLargestDrift / 2.0);
    jump.error = std::sqrt(of_levels + of_slope * of_slope);
    return jump;
  }

  /// Offsets first … end − 1.
  struct Side {
    Index first, end;
    double centre = 0.0, spread = 0.0;  ///< of their times
    std::vector<double> slopes = {};

    [[nodiscard]] Index count() const { return end - first; }
  };
  [[nodiscard]] Side side(Index first, Index end, Index gap) const {
    Side result{first, end};
    for (Index i = first; i < end; ++i) result.centre += time(i, gap) / static_cast<double>(end - first);
    for (Index i = first; i < end; ++i) {
      result.spread += std::pow(time(i, gap) - result.centre, 2);
      // Neighbours alone: only a few of these pairs have another step between them.
      for (Index k = std::max(first, i - kNeighbours); k < i; ++k) {
        const double apart = time(i, gap) - time(k, gap);
        if (apart > 0.0) result.slopes.push_back((value(i, gap) - value(k, gap)) / apart);
      }
    }
    return result;
  }
  [[nodiscard]] double level(const Side& of, double slope, double at, Index gap) const {
    Vector rest(of.count());
    for (Index i = of.first; i < of.end; ++i) rest[i - of.first] = value(i, gap) - slope * (time(i, gap) - at);
    return median_of(rest);
  }
  static double median_slope(const std::vector<double>& slopes) {
    return slopes.empty() ? 0.0 : std::clamp(numeric::median(slopes), -kSteepest, kSteepest);
  }

  /// @param pause  stamps may jump by more: the clock was set while no samples came
  std::optional<ClockStep> seen(Index gap, const Jump& jump, bool pause) {
    const double size = std::abs(jump.value);
    if (size <= std::max(4.0 * jump.error, kSmallestStep) || interval_ <= 0.0) return std::nullopt;
    // Where stamps jump that far all the time, one of these jumps proves nothing.
    const bool rare = jumps_beyond(size / 2.0) <= clock_.times.size();
    if (!rare && !certain(gap, jump)) return std::nullopt;
    // The measurement of the recorder may be as old as the previous offset.
    const double earliest = time(std::max<Index>(0, gap - 1), gap);
    const double latest = time(gap + 1, gap) + std::max(jump.value, 0.0);
    while (cursor_ < clock_.stamps.size() && stamp(cursor_) < earliest) ++cursor_;
    const Index not_before = std::max<Index>(1, steps_.empty() ? 0 : steps_.back().first + 1);
    std::optional<Index> best, longest;
    Estimate fits;
    double longest_by = 0.0;
    for (Index k = std::max(cursor_, not_before); k < clock_.stamps.size() && stamp(k - 1) <= latest; ++k) {
      if (--budget_ < 0) return std::nullopt;
      const double by = stamp(k) - stamp(k - 1) - interval_;
      if (std::abs(by) < size / 2.0) continue;
      if (by > longest_by) {
        longest = k;
        longest_by = by;
      }
      if (by * jump.value > 0.0) continue;
      budget_ -= 2 * kSamplesBeside;
      const Estimate here = jump_of_stamps(k);
      if (best && std::abs(here.value + jump.value) >= std::abs(fits.value + jump.value)) continue;
      best = k;
      fits = here;
    }
    const auto tolerance = [&](const Estimate& stamps) {
      return 4.0 * std::hypot(jump.error, stamps.error) + kSmallestStep;
    };
    if (!pause) {
      if (!best || std::abs(fits.value) <= 5.0 * fits.error) return std::nullopt;
      if (std::abs(fits.value + jump.value) > tolerance(fits)) return std::nullopt;
      // Of offsets further on it is seen from the gap before, too.
      const bool between = stamp(*best - 1) < time(gap + 1, gap) && stamp(*best) > time(gap, gap);
      if (!between && !is_here(gap, jump)) return std::nullopt;
      // A single wrong offset is not to fit by chance.
      if (jump.ahead < std::min(kFewOffsets, clock_.times.size() - gap - 1) && tolerance(fits) > size / 4.0) {
        return std::nullopt;
      }
      const bool stamps_know_better = rare && (clock_.times.size() < kToKnowNoise || fits.error <= jump.error);
      return ClockStep{place_of(*best, fits.value), 0, stamps_know_better ? -fits.value : jump.value};
    }
    if (!longest || !is_here(gap, jump)) return std::nullopt;
    const Estimate stamps = jump_of_stamps(*longest);
    const double left = stamps.value + jump.value;
    if (left <= tolerance(stamps) || stamps.value <= 5.0 * stamps.error) return std::nullopt;
    // The last offsets may be too few for certainty: a pause makes it likely that they are right.
    const bool likely = few_beside(gap) && left > kLongPause && size > std::max(8.0 * jump.error, kSmallestFew);
    if (!likely && !certain(gap, jump)) return std::nullopt;
    return ClockStep{*longest, 0, jump.value};
  }

  /// How many stamps jump by so much, either way.
  [[nodiscard]] Index jumps_beyond(double size) const { return jumps_.end() - std::ranges::lower_bound(jumps_, size); }

  /// From one offset to the next, beyond their drift.
  [[nodiscard]] double rise(Index i, Index gap, double slope) const {
    return value(i + 1, gap) - value(i, gap) - slope * (time(i + 1, gap) - time(i, gap));
  }
  /// Whether the two offsets beside the gap show the jump too, and no change of the drift explains it.
  [[nodiscard]] bool is_here(Index gap, const Jump& jump) const {
    const double half = std::abs(jump.value) / 2.0;
    return std::abs(rise(gap, gap, jump.slope) - jump.value) <= half && std::abs(jump.bent - jump.value) <= half &&
           std::abs(jump.bent) > jump.turn;
  }

  /// Whether there are too few offsets to know their noise, or what single ones do.
  [[nodiscard]] bool few_beside(Index gap) const {
    const Index offsets = clock_.times.size();
    return offsets < kOffsetsBeside || std::min(gap + 1, offsets - gap - 1) < kFewOffsets;
  }

  /// Whether offsets alone show the jump.
  [[nodiscard]] bool certain(Index gap, const Jump& jump) const {
    const Index offsets = clock_.times.size(), ahead = offsets - gap - 1;
    const bool few = offsets < kOffsetsBeside;
    const Index needed = !few ? kFewOffsets + 1 : offsets == 2 ? 1 : 2;
    const double size = std::abs(jump.value);
    if (std::min({gap + 1, ahead, jump.ahead}) < needed || !is_here(gap, jump)) return false;
    if (size <= (few ? kSmallestFew : std::max(8.0 * jump.error, kSmallestBlind))) return false;
    // Of two offsets on a side neither may be the wrong one.
    if (few && gap > 0 && std::abs(rise(gap - 1, gap, jump.slope)) > size / 4.0) return false;
    return !(few && ahead > 1 && std::abs(rise(gap + 1, gap, jump.slope)) > size / 4.0);
  }

  std::optional<ClockStep> blind(Index gap, const Jump& jump) const {
    if (!certain(gap, jump)) return std::nullopt;
    // Between the two offsets, less the stamps that the clock can only have shown before the step, or behind it.
    const double forward = std::max(-jump.value, 0.0);
    const Index samples = clock_.stamps.size();
    Index begin = steps_.empty() ? 0 : steps_.back().first;
    while (begin < samples && stamp(begin) <= std::min(time(gap, gap) + forward, time(gap + 1, gap))) ++begin;
    Index end = begin;
    while (end < samples && stamp(end) < time(gap + 1, gap) - forward) ++end;
    return ClockStep{end, end - begin, jump.value};
  }

  /// The jump of stamps between sample k − 1 and k, beyond their usual interval, from the samples around.
  [[nodiscard]] Estimate jump_of_stamps(Index k) const {
    const Index begin = std::max<Index>(0, k - kSamplesBeside);
    const Index end = std::min(clock_.stamps.size(), k + kSamplesBeside);
    Vector before(k - begin), behind(end - k);
    for (Index i = begin; i < end; ++i) {
      (i < k ? before[i - begin] : behind[i - k]) = stamp(i) - stamp(k) - interval_ * static_cast<double>(i - k);
    }
    const auto variance = [](const Vector& values) {
      return std::pow(kOfMedian * robust_deviation(values), 2) / static_cast<double>(values.size());
    };
    return {median_of(behind) - median_of(before), std::sqrt(variance(before) + variance(behind))};
  }

  /// The sample near k at which stamps that jump by `size` do so: the least sum of absolute deviations of two levels.
  [[nodiscard]] Index place_of(Index k, double size) const {
    const Index begin = std::max<Index>(0, k - kSamplesBeside);
    const Index end = std::min(clock_.stamps.size(), k + kSamplesBeside);
    Vector levels(end - begin);
    for (Index i = begin; i < end; ++i)
      levels[i - begin] = stamp(i) - stamp(k) - interval_ * static_cast<double>(i - k);
    const double low = median_of(levels.head(k - begin));
    Index best = k;
    double sum = 0.0, least = 0.0, at_k = 0.0;
    Index found = begin;
    for (Index i = begin; i < end; ++i) {
      if (i == k) at_k = sum;
      if (i == begin || sum < least) {
        least = sum;
        found = i;
      }
      sum += std::abs(levels[i - begin] - low) - std::abs(levels[i - begin] - low - size);
    }
    if (least < at_k && found > 0) best = found;
    return best;
  }

  SenderClock& clock_;
  double noise_;               ///< [s], of single offsets
  double interval_;            ///< [s], of samples
  std::vector<double> jumps_;  ///< [s], of the stamps beyond their interval, rising
  Index budget_;               ///< samples that may yet be looked at
  double shift_ = 0.0;         ///< [s], the sum of all steps so far
  Index cursor_ = 0;           ///< the first sample that may be behind the step that is looked for
  std::vector<ClockStep> steps_;
};

}  // namespace

std::vector<ClockStep> take_out_steps(SenderClock& clock) {
  if (clock.times.size() < 2 || clock.stamps.size() < 2) return {};
  std::vector<ClockStep> steps = StepFinder(clock).run(false);
  const std::vector<ClockStep> others = StepFinder(clock).run(true);
  steps.insert(steps.end(), others.begin(), others.end());
  std::ranges::sort(steps, {}, &ClockStep::first);
  return steps;
}

double noise_of_offsets(const Vector& times, const Vector& values) {
  if (times.size() < kToKnowNoise) return 0.0;
  Vector off(times.size() - 2);
  for (Index i = 0; i < off.size(); ++i) {
    const double span = times[i + 2] - times[i];
    const double part = span > 0.0 ? (times[i + 1] - times[i]) / span : 0.5;
    off[i] = values[i + 1] - values[i] - part * (values[i + 2] - values[i]);
  }
  // Steps are in two of these and in one difference, a drift that changes in more differences.
  const Vector apart = differences(times).cwiseMax(std::numeric_limits<double>::min()), steps = differences(values);
  const double slope = median_of(steps.cwiseQuotient(apart));
  return std::min(kDeviation * median_of(off.cwiseAbs()) / std::sqrt(1.5),
                  kDeviation * median_of((steps - slope * apart).cwiseAbs()) / std::sqrt(2.0));
}

}  // namespace mbk::recording
