#include "mbk/preprocess/windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mbk::preprocess {
namespace {

bool differs(const Matrix& reference, Index a, Index b) {
  return (reference.row(a) != reference.row(b));
}

/// Maximal runs [begin, end) within [first, last) in which the reference differs from its value at `rest`.
std::vector<Stretch> displacements(const Matrix& reference, Index rest, Index first, Index last) {
  std::vector<Stretch> runs;
  for (Index i = first; i < last; ++i) {
    if (!differs(reference, i, rest)) continue;
    if (runs.empty() || runs.back().end != i) runs.push_back({i, i, Purpose::identification});
    runs.back().end = i + 1;
  }
  return runs;
}

/// Limits in samples, checked against the recording.
struct SampleLimits {
  Index from, to;
  std::optional<Index> split;
};

tl::unexpected<Error> split_outside(double split_s, Index from, Index to, Hertz rate) {
  return bad_data(fmt::format("--split {:g} s is not between {:g} s and {:g} s", split_s,
                              static_cast<double>(from) / rate.value, static_cast<double>(to) / rate.value),
                  "it divides the data to identify from the data held back");
}

Result<SampleLimits> in_samples(const WindowLimits& limits, Index from, Index to, Index samples, Hertz rate) {
  const auto in_seconds = [&](Index sample) { return static_cast<double>(sample) / rate.value; };
  const double from_s = limits.from_s.value_or(in_seconds(from)), to_s = limits.to_s.value_or(in_seconds(to));
  const double duration = in_seconds(samples), tolerance = 1.5 / rate.value;
  // Written so that NaN is outside; what is inside has a sample number.
  const bool inside = from_s >= 0.0 && from_s < duration && to_s > from_s && to_s <= duration + tolerance;
  const auto sample = [&](double seconds) { return static_cast<Index>(std::llround(seconds * rate.value)); };
  SampleLimits result{inside ? sample(from_s) : 0, inside ? std::min(sample(to_s), samples) : 0, {}};
  if (result.from >= result.to) {
    return bad_data(fmt::format("the window from {:g} s to {:g} s does not lie in this recording of {:g} s", from_s,
                                to_s, duration),
                    "choose --from and --to inside it");
  }
  if (limits.split_s) {
    const double split_s = *limits.split_s;
    if (!(split_s > 0.0 && split_s <= duration + tolerance)) {
      return split_outside(split_s, result.from, result.to, rate);
    }
    result.split = sample(split_s);
    if (*result.split <= result.from || *result.split > result.to) {
      return split_outside(split_s, result.from, result.to, rate);
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

double seconds(Index sample, Hertz rate) {
  return static_cast<double>(sample) / rate.value;
}

/// Where a lasting perturbation begins and ends.
std::pair<Index, Index> lasting_range(const Matrix& reference, Index from, Index to) {
  Index last = to - 1;
  while (last > from && !differs(reference, last, last - 1)) --last;
  Index first = from;
  while (first < last && !differs(reference, first, first + 1)) ++first;
  // The second half tells what the perturbation looks like; the way to it (moving in) is left out.
  const Index half = (first + last + 1) / 2;
  const auto body = reference.middleRows(half, last + 1 - half);
  const Vector low = body.colwise().minCoeff(), high = body.colwise().maxCoeff();
  const Vector margin = 0.25 * (high - low);
  for (Index i = half; i-- > first;) {
    const auto row = reference.row(i).transpose().array();
    if ((row < (low - margin).array()).any() || (row > (high + margin).array()).any()) {
      first = i + 1;
      break;
    }
  }
  return {first, last + 1};
}

}  // namespace

ProtocolFinding detect_protocol(const Matrix& reference) {
  if (reference.rows() < 2) return {Protocol::free, "no reference was recorded"};
  Index changes = 0;
  for (Index i = 1; i < reference.rows(); ++i) changes += differs(reference, i, i - 1) ? 1 : 0;
  if (changes == 0) return {Protocol::free, "the reference never changes"};
  const double share = static_cast<double>(changes) / static_cast<double>(reference.rows() - 1);
  if (share < 0.02) {
    return {Protocol::underdamped, fmt::format("the reference is constant but for {} steps", changes)};
  }
  return {Protocol::sinusoidal, "the reference varies continuously"};
}

Result<WindowPlan> reference_windows(Protocol protocol, const Matrix& reference, Index samples, Hertz sample_rate,
                                     const WindowLimits& limits, Index half_window) {
  constexpr Index kSinusoidalBegin = 11999, kSinusoidalEnd = 62000, kUnderdampedBegin = 15999;
  constexpr Index kIdentificationSamples = 40000;
  constexpr std::size_t kIdentificationPulses = 8;

  const bool pulses = protocol == Protocol::underdamped;
  const bool sines = protocol == Protocol::sinusoidal;
  const Index begin = sines ? kSinusoidalBegin : (pulses ? kUnderdampedBegin : 0);
  if (!limits.from_s && samples <= begin) {
    return bad_data(fmt::format("the published {} window begins at {:g} s, and this recording lasts {:g} s",
                                text(protocol), seconds(begin, sample_rate), seconds(samples, sample_rate)),
                    "use --mode default, or name a window with --from and --to");
  }
  auto range = in_samples(limits, begin, sines ? std::min(kSinusoidalEnd, samples) : samples, samples, sample_rate);
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
        "filtered from {:g} s on, then the {} displacements of the reference cut out; the first "
        "{} identify (published procedure)",
        seconds(range->from, sample_rate), cut.keep.size(), kIdentificationPulses);
    plan.cuts = {std::move(cut)};
    return plan;
  }
  const Index split =
      range->split.value_or(sines && !limits.from_s ? first + kIdentificationSamples : first + (last - first) * 4 / 5);
  plan.cuts = {divided(range->from, range->to, split)};
  if (split < last) plan.split_s = seconds(split, sample_rate);
  plan.rule = fmt::format("{:g} s to {:g} s{}", seconds(range->from, sample_rate), seconds(range->to, sample_rate),
                          sines && !limits.from_s ? " (published window)" : "");
  return plan;
}

Result<WindowPlan> improved_windows(Protocol protocol, const Matrix& reference, Index samples, Hertz sample_rate,
                                    const WindowLimits& limits) {
  auto range = in_samples(limits, 0, samples, samples, sample_rate);
  if (!range) return tl::unexpected(range.error());
  WindowPlan plan;
  if (protocol == Protocol::underdamped) {
    // What the reference returns to between pulses is its value for the longest time; the first sample of the window
    // may lie inside a pulse.
    const Index rest = [&] {
      Index best = range->from, longest = 0;
      for (Index begin = range->from; begin < range->to;) {
        Index end = begin + 1;
        while (end < range->to && !differs(reference, end, begin)) ++end;
        if (end - begin > longest) {
          longest = end - begin;
          best = begin;
        }
        begin = end;
      }
      return best;
    }();
    const std::vector<Stretch> runs = displacements(reference, rest, range->from, range->to);
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
    const auto [first, last] = lasting_range(reference, begin, end);
    if (!limits.from_s) begin = first;
    if (!limits.to_s) end = last;
    plan.rule = fmt::format("{:g} s to {:g} s, where the reference keeps to its lasting range",
                            seconds(begin, sample_rate), seconds(end, sample_rate));
  } else {
    plan.rule = fmt::format("{:g} s to {:g} s", seconds(begin, sample_rate), seconds(end, sample_rate));
  }
  const Index split = range->split.value_or(begin + (end - begin) * 4 / 5);
  if (limits.split_s && (split <= begin || split > end)) {
    return split_outside(*limits.split_s, begin, end, sample_rate);
  }
  plan.cuts = {divided(begin, end, split)};
  plan.split_s = seconds(split, sample_rate);
  return plan;
}

}  // namespace mbk::preprocess
