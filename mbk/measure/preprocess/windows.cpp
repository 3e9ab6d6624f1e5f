#include "mbk/measure/preprocess/windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace mbk::preprocess {
namespace {

bool differs(const Columns& reference, Index a, Index b) {
  for (Index k = 0; k < reference.cols(); ++k) {
    if (reference(a, k) != reference(b, k)) return true;
  }
  return false;
}

constexpr Index kTogether = 512;  ///< rows

/// How many of the rows [begin, end), which are no more than kTogether, differ from the one before.
Index changed_rows(const Columns& reference, Index begin, Index end) {
  std::array<std::int64_t, kTogether> changed{};
  for (Index k = 0; k < reference.cols(); ++k) {
    const double* const values = reference.col(k).data() + begin;
    for (Index i = 0; i < end - begin; ++i) changed[static_cast<std::size_t>(i)] |= values[i] != values[i - 1] ? 1 : 0;
  }
  return std::accumulate(changed.begin(), changed.end(), Index{0});
}

/// Maximal runs [begin, end) within [first, last) in which the reference differs from its value at `rest`.
std::vector<Segment> displacements(const Columns& reference, Index rest, Index first, Index last) {
  std::vector<Segment> runs;
  for (Index i = first; i < last; ++i) {
    if (!differs(reference, i, rest)) continue;
    if (runs.empty() || runs.back().end != i) runs.push_back({i, i, Purpose::identification});
    runs.back().end = i + 1;
  }
  return runs;
}

/// Where the reference rests: the samples in which it keeps one value for the longest time. Between pulses it returns
/// to that, whereas the first sample of a window may lie inside a pulse.
Segment longest_rest(const Columns& reference, Index from, Index to) {
  Segment longest{from, from, Purpose::identification};
  for (Index begin = from; begin < to;) {
    Index end = begin + 1;
    while (end < to && !differs(reference, end, begin)) ++end;
    if (end - begin > longest.size()) longest = {begin, end, Purpose::identification};
    begin = end;
  }
  return longest;
}

/// Limits in samples, checked against the recording.
struct SampleLimits {
  Index from, to;
  std::optional<Index> split;
};

tl::unexpected<Error> split_outside(double split_s, Index from, Index to, const Clock& clock) {
  return bad_data(
      fmt::format("--split {:g} s is not between {:g} s and {:g} s", split_s, clock.seconds(from), clock.seconds(to)),
      "choose a time that divides the data into fitted and held-out data");
}

Result<SampleLimits> in_samples(const WindowLimits& limits, Index from, Index to, const Clock& clock) {
  const double from_s = limits.from_s.value_or(clock.seconds(from)), to_s = limits.to_s.value_or(clock.seconds(to));
  const double duration = clock.duration(), tolerance = 1.5 / clock.rate().value;
  // Written so that NaN is outside.
  const bool inside = from_s >= 0.0 && from_s < duration && to_s > from_s && to_s <= duration + tolerance;
  SampleLimits result{from, to, {}};
  if (inside && limits.from_s) result.from = clock.sample(from_s);
  if (inside && limits.to_s) result.to = std::min(clock.sample(to_s), clock.samples());
  if (from_s >= duration && limits.from_s) {
    return bad_data(fmt::format("--from {:g} s is not before the end of the recording, {:g} s", from_s, duration),
                    "choose an earlier --from");
  }
  if (from_s >= to_s && limits.from_s && limits.to_s) {
    return bad_data(fmt::format("the window from {:g} s to {:g} s is empty", from_s, to_s),
                    "choose --from before --to");
  }
  if (!inside || result.from >= result.to) {
    return bad_data(
        fmt::format("the window from {:g} s to {:g} s is not within this recording of {:g} s", from_s, to_s, duration),
        "choose --from and --to within it");
  }
  if (limits.split_s) {
    const bool between = *limits.split_s > 0.0 && *limits.split_s <= duration + tolerance;
    result.split = between ? clock.sample(*limits.split_s) : result.from;
    if (*result.split <= result.from || *result.split > result.to) {
      return split_outside(*limits.split_s, result.from, result.to, clock);
    }
  }
  return result;
}

/// One cut, identified up to `split` and validated from there.
Cut divided(Index begin, Index end, Index split) {
  Cut cut{begin, end, {}};
  cut.keep.push_back({begin, std::min(split, end), Purpose::identification});
  if (split < end) cut.keep.push_back({split, end, Purpose::validation});
  return cut;
}

/// Where a sustained perturbation begins and ends.
std::pair<Index, Index> steady_range(const Columns& reference, Index from, Index to) {
  Index last = to - 1;
  while (last > from && !differs(reference, last, last - 1)) --last;
  Index first = from;
  while (first < last && !differs(reference, first, first + 1)) ++first;
  // The second half tells what the perturbation looks like; the way to it (moving in) is left out.
  const Index half = (first + last + 1) / 2;
  Vector low(reference.cols()), high(reference.cols());
  for (Index k = 0; k < reference.cols(); ++k) {
    const auto body = reference.col(k).segment(half, last + 1 - half);
    low[k] = body.minCoeff();
    high[k] = body.maxCoeff();
  }
  const Vector margin = 0.25 * (high - low);
  const auto outside = [&](Index i) {
    for (Index k = 0; k < reference.cols(); ++k) {
      if (reference(i, k) < low[k] - margin[k] || reference(i, k) > high[k] + margin[k]) return true;
    }
    return false;
  };
  for (Index i = half; i-- > first;) {
    if (outside(i)) {
      first = i + 1;
      break;
    }
  }
  return {first, last + 1};
}

}  // namespace

ProtocolFinding detect_protocol(const Columns& reference) {
  if (reference.rows() < 2) return {Protocol::free, "no reference was recorded"};
  Index changes = 0;
  for (Index begin = 1; begin < reference.rows(); begin += kTogether) {
    changes += changed_rows(reference, begin, std::min(begin + kTogether, reference.rows()));
  }
  if (changes == 0) return {Protocol::free, "the reference is constant"};
  const double share = static_cast<double>(changes) / static_cast<double>(reference.rows() - 1);
  if (share < 0.02) {
    return {Protocol::underdamped, fmt::format("the reference is piecewise constant, with {} steps", changes)};
  }
  return {Protocol::sinusoidal, "the reference varies continuously"};
}

Result<WindowPlan> reference_windows(Protocol protocol, const Columns& reference, const Clock& clock,
                                     const WindowLimits& limits, Index half_window) {
  constexpr Index kSinusoidalBegin = 11999, kSinusoidalEnd = 62000, kUnderdampedBegin = 15999;
  constexpr Index kIdentificationSamples = 40000;
  constexpr std::size_t kIdentificationPulses = 8;
  constexpr double kPublishedRate = 1000.0;  // Hz

  const Index samples = clock.samples();
  if (std::abs(clock.rate().value - kPublishedRate) > 1e-3 * kPublishedRate) {
    return bad_data(fmt::format("the published procedure needs {:g} Hz, but this recording has {:g} Hz", kPublishedRate,
                                clock.rate().value),
                    "use --mode default");
  }
  const bool pulses = protocol == Protocol::underdamped;
  const bool sines = protocol == Protocol::sinusoidal;
  const Index begin = sines ? kSinusoidalBegin : (pulses ? kUnderdampedBegin : 0);
  if (!limits.from_s && samples <= begin) {
    return bad_data(fmt::format("the published {} window starts at {:g} s, but this recording lasts only {:g} s",
                                word_of(protocol), clock.seconds(begin), clock.seconds(samples)),
                    "use --mode default, or name a window with --from and --to");
  }
  auto range = in_samples(limits, begin, sines ? std::min(kSinusoidalEnd, samples) : samples, clock);
  if (!range) return tl::unexpected(range.error());
  WindowPlan plan;
  plan.trim = 1;
  const Index first = range->from + half_window + plan.trim;
  const Index last = range->to - half_window - plan.trim;
  if (pulses) {
    Cut cut{range->from, range->to, displacements(reference, range->from, first, last)};
    // A run that is under way at the first centre is no onset.
    const bool under_way = !cut.keep.empty() && cut.keep.front().begin == first;
    for (std::size_t k = 0; k < cut.keep.size(); ++k) {
      const bool later =
          range->split ? cut.keep[k].begin >= *range->split : k >= kIdentificationPulses + (under_way ? 1 : 0);
      cut.keep[k].purpose = later ? Purpose::validation : Purpose::identification;
    }
    plan.rule = fmt::format(
        "filtered from {:g} s on, then the {} displacements of the reference are cut out{}", clock.seconds(range->from),
        cut.keep.size(),
        range->split ? "" : fmt::format("; the first {} are used for identification", kIdentificationPulses));
    plan.cuts = {std::move(cut)};
    return plan;
  }
  const Index split =
      range->split.value_or(sines && !limits.from_s ? first + kIdentificationSamples : first + (last - first) * 4 / 5);
  plan.cuts = {divided(range->from, range->to, split)};
  if (split < last) plan.split_s = clock.seconds(split);
  const bool published_end = sines && !limits.from_s && range->to == kSinusoidalEnd;
  plan.rule = fmt::format("{:g} s to {:g} s{}", clock.seconds(range->from), clock.seconds(range->to),
                          published_end ? " (published window)" : "");
  return plan;
}

Result<WindowPlan> default_windows(Protocol protocol, const Columns& reference, const Clock& clock,
                                   const WindowLimits& limits) {
  auto range = in_samples(limits, 0, clock.samples(), clock);
  if (!range) return tl::unexpected(range.error());
  WindowPlan plan;
  if (protocol == Protocol::underdamped) {
    constexpr Index kShortest = 8;  // samples; noise alone does not stay the same for so long
    const Segment rest = longest_rest(reference, range->from, range->to);
    if (rest.size() < kShortest) {
      return bad_data(
          fmt::format("the reference never rests: it is never constant for {} samples", kShortest),
          "omit --protocol if it varies continuously, and name the commanded reference, not a measured one");
    }
    const std::vector<Segment> runs = displacements(reference, rest.begin, range->from, range->to);
    if (runs.empty()) {
      return bad_data("the reference is not displaced anywhere in the window", "choose --from and --to, or --protocol");
    }
    const std::size_t first_half = (runs.size() + 1) / 2;
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const bool later = range->split ? runs[k].begin >= *range->split : k >= first_half;
      Cut cut{runs[k].begin, runs[k].end, {runs[k]}};
      cut.keep.front().purpose = later ? Purpose::validation : Purpose::identification;
      plan.cuts.push_back(std::move(cut));
    }
    plan.rule = fmt::format("{} displacements of the reference, each cut out before filtering", runs.size());
    return plan;
  }
  Index begin = range->from, end = range->to;
  if (protocol == Protocol::sinusoidal) {
    const auto [first, last] = steady_range(reference, begin, end);
    if (!limits.from_s) begin = first;
    if (!limits.to_s) end = last;
    plan.rule = fmt::format("{:g} s to {:g} s, while the reference is in steady state", clock.seconds(begin),
                            clock.seconds(end));
  } else {
    plan.rule = fmt::format("{:g} s to {:g} s", clock.seconds(begin), clock.seconds(end));
  }
  const Index split = range->split.value_or(begin + (end - begin) * 4 / 5);
  if (limits.split_s && (split <= begin || split > end)) {
    return split_outside(*limits.split_s, begin, end, clock);
  }
  plan.cuts = {divided(begin, end, split)};
  plan.split_s = clock.seconds(split);
  return plan;
}

void append_segments(const Cut& cut, Index first_sample, Index every, Index first_row, Index rows,
                     std::vector<Segment>& segments) {
  const auto row_at = [&](Index sample) {
    return std::clamp<Index>((sample - first_sample + every - 1) / every, 0, rows);
  };
  for (const Segment& keep : cut.keep) {
    const Index begin = row_at(keep.begin), end = row_at(keep.end);
    if (begin >= end) continue;
    segments.push_back({first_row + begin, first_row + end, keep.purpose, first_sample + begin * every});
  }
}

}  // namespace mbk::preprocess
