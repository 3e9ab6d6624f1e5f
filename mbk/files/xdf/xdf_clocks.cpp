#include "mbk/files/xdf/xdf_clocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/files/xdf/xdf_robust.h"

namespace mbk::recording {
namespace {

constexpr double kLinearBeyond = 1e-4;  ///< [s], of the residuals of clock offsets
constexpr double kTiny = std::numeric_limits<double>::epsilon();
constexpr Index kInARow = 9;  ///< offsets whose median is off where the drift changes

Vector times_of(std::span<const ClockOffset> offsets) {
  Vector times(std::ssize(offsets));
  for (Index k = 0; k < times.size(); ++k) times[k] = offsets[static_cast<std::size_t>(k)].time;
  return times;
}

Vector values_of(std::span<const ClockOffset> offsets) {
  Vector values(std::ssize(offsets));
  for (Index k = 0; k < values.size(); ++k) values[k] = offsets[static_cast<std::size_t>(k)].value;
  return values;
}

bool last_is_corrupt(std::span<const ClockOffset> offsets, Index samples, std::optional<std::uint64_t> total) {
  constexpr double kFar = 10.0;
  if (offsets.size() < 3 || !total || static_cast<std::uint64_t>(samples) <= *total) return false;
  const std::span<const ClockOffset> others = offsets.first(offsets.size() - 1);
  const double interval = offsets.back().time - others.back().time;
  if (interval > kFar * median_of(differences(times_of(others)))) return true;
  const Vector values = values_of(others);
  const double deviation = std::max(robust_deviation(values), kLinearBeyond / kFar);
  return std::abs(offsets.back().value - median_of(values)) > kFar * deviation;
}

/// Sorts offsets that are out of order in the file by their times. Where the sender's clock was set back, the
/// value rises by as much, and they stay.
void put_in_order(std::vector<ClockOffset>& offsets) {
  constexpr std::size_t kFarthest = 100;
  for (std::size_t k = 1; k < offsets.size(); ++k) {
    for (std::size_t i = k; i > 0 && k - i < kFarthest; --i) {
      ClockOffset &before = offsets[i - 1], &here = offsets[i];
      const double back = before.time - here.time;
      if (back <= 0.0 || here.value - before.value > back / 2.0) break;
      std::swap(before.time, here.time);
      std::swap(before.value, here.value);
    }
  }
}

/// Index of the first offset behind each reset of the sender's clock, rising.
std::vector<Index> resets(const Vector& times, const Vector& values) {
  std::vector<Index> found;
  if (times.size() < 2) return found;
  const Vector intervals = differences(times);
  const Vector of_time = distances_from_median(intervals), of_value = distances_from_median(differences(values));
  const double usual_time = median_of(of_time) + kTiny, usual_value = median_of(of_value) + kTiny;
  for (Index k = 0; k < intervals.size(); ++k) {
    const bool time_jumps = of_time[k] > 5.0 * usual_time && of_time[k] > 5.0;
    const bool value_jumps = of_value[k] > 10.0 * usual_value && of_value[k] > 1.0;
    if (intervals[k] < 0.0 || (time_jumps && value_jumps)) found.push_back(k + 1);
  }
  return found;
}

/// Offsets first … last of one segment, and the times that they span.
struct OffsetRange {
  Index first, last;
  double begin, end;

  [[nodiscard]] double distance(double stamp) const { return std::max({begin - stamp, stamp - end, 0.0}); }
};

/// The first sample of the segment that begins with offset `next.first`.
/// @param few  resets: so that all samples may be looked at for each
Index first_sample(const Vector& raw, std::span<const ClockOffset> offsets, const OffsetRange& before,
                   const OffsetRange& next, Index at_least, bool few) {
  const auto place = [&](Index k) {
    return std::clamp(offsets[static_cast<std::size_t>(k)].samples_before, at_least, raw.size());
  };
  Index begin = place(before.last), end = place(next.first);
  if (few && begin == end && (end == at_least || end == raw.size())) {
    begin = at_least;
    end = raw.size();
  }
  // A clock that was set back shows some times twice: only a jump of its stamps tells where.
  const Index from = few ? at_least : begin, to = few ? raw.size() : end;
  Index back = -1;
  double nearest = 0.0;
  for (Index k = std::max<Index>(from, 1); k < to && next.begin < before.end; ++k) {
    if (raw[k] - raw[k - 1] >= (next.begin - before.end) / 2.0) continue;
    const double distance = before.distance(raw[k - 1]) + next.distance(raw[k]);
    if (back >= 0 && distance >= nearest) continue;
    nearest = distance;
    back = k;
  }
  if (back >= 0) return back;
  Index jump = end;
  double largest = 0.0;
  for (Index k = begin; k < end; ++k) {
    if (next.distance(raw[k]) < before.distance(raw[k])) return k;
    const double step = k > 0 ? std::abs(raw[k] - raw[k - 1]) : 0.0;
    if (step <= largest) continue;
    largest = step;
    jump = k;
  }
  // Where time tells nothing, the sender's clock jumped there most.
  return largest > 1.0 ? jump : end;
}

/// Number of samples within this time, at least 100, but at most all.
Index samples_of(double seconds, double nominal_hz, Index count) {
  const double samples = std::max(100.0, seconds * nominal_hz);
  return samples < static_cast<double>(count) ? std::lround(samples) : count;
}

/// The largest mean of `count` consecutive values.
double largest_mean(const Vector& values, Index count) {
  double sum = values.head(count).sum(), largest = std::abs(sum);
  for (Index k = count; k < values.size(); ++k) {
    sum += values[k] - values[k - count];
    largest = std::max(largest, std::abs(sum));
  }
  return largest / static_cast<double>(count);
}

/// The samples at which stamps jump and stay off. See `dejitter`.
std::vector<Index> lasting_jumps(const Vector& time, double nominal_hz) {
  constexpr Index kMin = 20;  ///< samples on each side
  const Index count = time.size();
  if (count < 2 * kMin + 1) return {};
  const Vector intervals = differences(time);
  const double usual = median_of(intervals), far = kManySamples * std::abs(usual);
  if ((intervals.array() - usual).abs().maxCoeff() <= far) return {};
  const Index beside = samples_of(0.25, nominal_hz, count);
  Vector sums(count + 1);  // of the distances from an even grid
  sums[0] = 0.0;
  for (Index k = 0; k < count; ++k) sums[k + 1] = sums[k] + (time[k] - time[0] - usual * static_cast<double>(k));
  Vector changes(count - 2 * kMin);
  for (Index k = kMin; k < count - kMin; ++k) {
    const Index before = std::min(beside, k), behind = std::min(beside, count - k);
    // The deviation of the median interval from the mean grows with the distance of the two groups.
    changes[k - kMin] = (sums[k + behind] - sums[k]) / static_cast<double>(behind) -
                        (sums[k] - sums[k - before]) / static_cast<double>(before);
  }
  const double middle = median_of(changes), noise = robust_deviation(changes);
  std::vector<Index> found;
  for (Index k = kMin; k < count - kMin; ++k) {
    const Index least = std::min({beside, k, count - k});  // fewer are less certain
    const double by = intervals[k - 1] - usual, change = changes[k - kMin] - middle;
    const bool stays = change * by > 0.0 && std::abs(change) >= std::abs(by) / 2.0 &&
                       std::abs(change) > 6.0 * noise * static_cast<double>(beside) / static_cast<double>(least);
    if (std::abs(by) > far && stays) found.push_back(k);
  }
  return found;
}

/// A value at one time, and the slope there.
struct LocalLine {
  double value, slope;
};

/// Of the offsets first … first + count − 1, by the medians of their two halves.
LocalLine local_line(const Vector& times, const Vector& values, Index first, Index count, double at) {
  const Index half = count / 2;
  const auto median_part = [&](const Vector& all, Index from) { return median_of(all.segment(from, half)); };
  const Index second = first + count - half;
  const double apart = median_part(times, second) - median_part(times, first);
  const double slope = apart > 0.0 ? (median_part(values, second) - median_part(values, first)) / apart : 0.0;
  const auto t = times.segment(first, count), v = values.segment(first, count);
  return {median_of((v.array() - slope * (t.array() - at)).matrix()), slope};
}

/// The greatest median of nine in a row.
double largest_in_a_row(const Vector& values) {
  double largest = 0.0;
  for (Index i = 0; i + kInARow <= values.size(); ++i) {
    largest = std::max(largest, std::abs(median_of(values.segment(i, kInARow))));
  }
  return largest;
}

/// Makes the correction a curve where the drift of the clock changes.
bool follow_changing_drift(const Vector& all_times, const Vector& all_values, ClockCorrection& fit) {
  Vector times(all_times.size()), values(all_times.size());
  Index count = 0;
  for (Index i = 0; i < all_times.size(); ++i) {
    if (count > 0 && (all_values[i] == all_values[i - 1] || all_times[i] <= times[count - 1])) continue;
    times[count] = all_times[i];
    values[count++] = all_values[i];
  }
  if (count < 2 * kInARow) return false;
  times.conservativeResize(count);
  values.conservativeResize(count);
  const RobustLine line = huber_line(times, values, kLinearBeyond);
  const Vector straight = (line.offset + line.slope * (times.array() - line.at)).matrix();
  const double allowed = std::max(kLinearBeyond, 2.0 * noise_of_offsets(times, values));
  if (largest_in_a_row(values - straight) <= allowed) return false;
  for (Index beside = count / 2;; beside /= 2) {
    beside = std::max(beside, kInARow);
    const Index apart = std::max<Index>(1, beside / 8), points = (count - 2) / apart + 2;
    fit.times.resize(points);
    fit.values.resize(points);
    for (Index p = 0; p < points; ++p) {
      const Index i = p + 1 < points ? p * apart : count - 1;
      const Index first = std::clamp<Index>(i - beside / 2, 0, count - beside);
      const LocalLine here = local_line(times, values, first, beside, times[i]);
      fit.times[p] = times[i];
      fit.values[p] = here.value;
      if (p == 0) fit.begin = here.slope;
      fit.end = here.slope;
    }
    const Vector curve = times.unaryExpr([&](double time) { return fit.at(time); });
    fit.bend = (curve - straight).cwiseAbs().maxCoeff();
    if (beside == kInARow || largest_in_a_row(values - curve) <= allowed) break;
  }
  fit.line = line;
  return true;
}

}  // namespace

RobustLine huber_line(const Vector& time, const Vector& values, double threshold) {
  RobustLine line{values.mean(), 0.0, time.mean()};
  if (time.size() < 2) return line;
  const Vector t = (time.array() - line.at).matrix();
  const double middle = line.offset;
  const Vector y = (values.array() - middle).matrix();
  Vector weights = Vector::Ones(t.size());
  double a = 0.0, b = 0.0;
  // Least squares with weights that follow the residuals: each round lowers Huber's loss.
  const Index rounds = std::clamp<Index>(20'000'000 / t.size(), 100, 2000);
  for (Index round = 0; round < rounds; ++round) {
    const double sum = weights.sum();
    const double t_mean = weights.dot(t) / sum, y_mean = weights.dot(y) / sum;
    const Vector centred = (t.array() - t_mean).matrix();
    const double spread = weights.dot(centred.cwiseAbs2());
    const double slope = spread > 0.0 ? weights.dot(centred.cwiseProduct((y.array() - y_mean).matrix())) / spread : 0.0;
    const double level = y_mean - slope * t_mean;
    const double moved = std::abs(level - a) + std::abs(slope - b) * t.cwiseAbs().maxCoeff();
    a = level;
    b = slope;
    if (round > 0 && moved < 1e-14) break;
    weights = (y - b * t - Vector::Constant(t.size(), a)).unaryExpr([&](double residual) {
      return std::abs(residual) <= threshold ? 1.0 : threshold / std::abs(residual);
    });
  }
  line.offset = middle + a;
  line.slope = b;
  return line;
}

double ClockCorrection::at(double stamp) const {
  if (times.size() == 0) return line.offset + line.slope * (stamp - line.at);
  const Index last = times.size() - 1;
  if (stamp <= times[0]) return values[0] + begin * (stamp - times[0]);
  if (stamp >= times[last]) return values[last] + end * (stamp - times[last]);
  const Index next = std::upper_bound(times.data(), times.data() + times.size(), stamp) - times.data();
  const double part = (stamp - times[next - 1]) / (times[next] - times[next - 1]);
  return values[next - 1] + part * (values[next] - values[next - 1]);
}

ClockCorrection fit_correction(const Vector& times, const Vector& values) {
  ClockCorrection fit;
  fit.line = huber_line(times, values, kLinearBeyond);
  const bool bent = follow_changing_drift(times, values, fit);
  const auto rest = [&] {
    return Vector((values - times.unaryExpr([&](double time) { return fit.at(time); })).cwiseAbs());
  };
  if (!bent && std::abs(fit.line.slope) > kLargestDrift) {
    const double rise = std::abs(fit.line.slope) * (times.maxCoeff() - times.minCoeff());
    if (times.size() < 4 || median_of(rest()) > 0.05 * rise) {
      fit.line.offset = median_of(values);
      fit.line.slope = 0.0;
      fit.doubt = rest().maxCoeff();
      return fit;
    }
  }
  fit.outliers = (rest().array() > std::max(1e-3, 6.0 * noise_of_offsets(times, values))).count();
  return fit;
}

Vector Synchronised::on_recorder(const Vector& sender) const {
  Vector result = sender;
  for (const ClockSegment& segment : segments) {
    for (Index i = segment.first; i <= segment.last; ++i) result[i] += segment.correction.at(sender[i]);
  }
  return result;
}

std::vector<Index> Synchronised::breaks() const {
  std::vector<Index> found;
  for (const ClockSegment& segment : segments) found.push_back(segment.first);
  for (const ClockStep& step : steps) {
    if (step.unsure > 0) found.insert(found.end(), {step.first - step.unsure, step.first});
  }
  std::ranges::sort(found);
  return found;
}

Synchronised synchronise(const Vector& raw, std::span<const ClockOffset> offsets, std::optional<std::uint64_t> total) {
  Synchronised result;
  result.time = result.stamps = raw;
  std::vector<ClockOffset> used;
  std::ranges::copy_if(offsets, std::back_inserter(used), [](const ClockOffset& offset) {
    return std::abs(offset.time) < kLargestTime && std::abs(offset.value) < kLargestTime;
  });
  result.not_finite = offsets.size() - used.size();
  put_in_order(used);
  if (last_is_corrupt(used, raw.size(), total)) {
    used.pop_back();
    result.last_was_corrupt = true;
  }
  if (used.empty() || raw.size() == 0) return result;

  const Vector times = times_of(used), values = values_of(used);
  std::vector<OffsetRange> ranges;
  std::vector<Index> ends = resets(times, values);
  ends.push_back(times.size());
  for (Index first = 0; const Index end : ends) {
    const auto part = times.segment(first, end - first);
    ranges.push_back({first, end - 1, part.minCoeff(), part.maxCoeff()});
    first = end;
  }
  const bool few = ranges.size() < 100;
  Index first = 0;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const OffsetRange& range = ranges[k];
    const Index end = k + 1 < ranges.size() ? first_sample(raw, used, range, ranges[k + 1], first, few) : raw.size();
    const Index count = range.last - range.first + 1;
    if (end == first) continue;
    SenderClock clock{raw.segment(first, end - first), times.segment(range.first, count),
                      values.segment(range.first, count)};
    for (ClockStep step : take_out_steps(clock)) {
      step.first += first;
      result.steps.push_back(step);
    }
    result.uncovered = std::max({result.uncovered, clock.times.minCoeff() - clock.stamps.minCoeff(),
                                 clock.stamps.maxCoeff() - clock.times.maxCoeff()});
    result.stamps.segment(first, end - first) = clock.stamps;
    result.segments.push_back({first, end - 1, fit_correction(clock.times, clock.values)});
    first = end;
  }
  result.time = result.on_recorder(result.stamps);
  return result;
}

Dejittered dejitter(const Vector& time, double nominal_hz, std::span<const Index> breaks) {
  Dejittered result;
  result.time = time;
  const double longest = std::max(1.0, 500.0 / nominal_hz);
  std::vector<Index> all(breaks.begin(), breaks.end());
  for (Index k = 1; k < time.size(); ++k) {
    if (std::abs(time[k] - time[k - 1]) > longest) all.push_back(k);
  }
  all.push_back(time.size());
  std::ranges::sort(all);
  std::vector<Index> ends;
  for (Index first = 0; const Index end : all) {
    if (end <= first) continue;
    for (const Index jump : lasting_jumps(time.segment(first, end - first), nominal_hz)) ends.push_back(first + jump);
    ends.push_back(end);
    first = end;
  }
  double duration = 0.0;
  for (Index first = 0; const Index end : ends) {
    const Index count = end - first;
    auto stamps = result.time.segment(first, count);
    const double middle = static_cast<double>(count - 1) / 2.0;
    const Vector place = Vector::LinSpaced(count, -middle, middle);
    const double mean = stamps.mean(), spread = place.squaredNorm();
    const double interval = spread > 0.0 ? place.dot((stamps.array() - mean).matrix()) / spread : 0.0;
    stamps = (mean + interval * place.array()).matrix();
    result.lasting_shift = std::max(
        result.lasting_shift, largest_mean(stamps - time.segment(first, count), samples_of(2.0, nominal_hz, count)));
    duration += interval * static_cast<double>(count - 1);
    result.segments.push_back({first, end - 1});
    first = end;
  }
  if (time.size() == 0) return result;
  result.largest_shift = (result.time - time).cwiseAbs().maxCoeff();
  const auto intervals = time.size() - std::ssize(result.segments);
  if (duration > 0.0) result.effective_hz = std::min(static_cast<double>(intervals) / duration, kLargestRate);
  return result;
}

}  // namespace mbk::recording
