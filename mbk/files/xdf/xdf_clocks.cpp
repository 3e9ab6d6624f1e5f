#include "mbk/files/xdf/xdf_clocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/numeric/statistics.h"

namespace mbk::recording {
namespace {

constexpr double kLinearBeyond = 1e-4;  ///< [s], of the residuals of clock offsets
constexpr double kDeviation = 1.4826;   ///< standard deviation of a normal, in median absolute deviations
constexpr double kTiny = std::numeric_limits<double>::epsilon();

double median_of(const Vector& values) {
  return numeric::median({values.data(), values.data() + values.size()});
}

/// |value − median| and the median of that.
struct Deviations {
  Vector each;
  double typical = 0.0;
};

Deviations deviations(const Vector& values) {
  Deviations result{(values.array() - median_of(values)).abs().matrix(), 0.0};
  result.typical = median_of(result.each);
  return result;
}

Vector differences(const Vector& values) {
  return values.tail(values.size() - 1) - values.head(values.size() - 1);
}

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
  const double deviation = std::max(kDeviation * deviations(values).typical, kLinearBeyond / kFar);
  return std::abs(offsets.back().value - median_of(values)) > kFar * deviation;
}

/// Index of the first offset behind each reset of the sender's clock, rising.
std::vector<Index> resets(const Vector& times, const Vector& values) {
  std::vector<Index> found;
  if (times.size() < 2) return found;
  const Vector intervals = differences(times);
  const Deviations of_time = deviations(intervals), of_value = deviations(differences(values));
  for (Index k = 0; k < intervals.size(); ++k) {
    const bool time_jumps = of_time.each[k] > 5.0 * (of_time.typical + kTiny) && of_time.each[k] > 5.0;
    const bool value_jumps = of_value.each[k] > 10.0 * (of_value.typical + kTiny) && of_value.each[k] > 1.0;
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
Index first_sample(const Vector& raw, std::span<const ClockOffset> offsets, const OffsetRange& before,
                   const OffsetRange& next, Index at_least) {
  const auto place = [&](Index k) {
    return std::clamp(offsets[static_cast<std::size_t>(k)].samples_before, at_least, raw.size());
  };
  const Index begin = place(before.last), end = place(next.first);
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
  constexpr int kRounds = 2000;
  for (int round = 0; round < kRounds; ++round) {
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

Synchronised synchronise(const Vector& raw, std::span<const ClockOffset> offsets, std::optional<std::uint64_t> total) {
  Synchronised result;
  result.time = raw;
  std::vector<ClockOffset> used;
  std::ranges::copy_if(offsets, std::back_inserter(used), [](const ClockOffset& offset) {
    return std::abs(offset.time) < kLargestTime && std::abs(offset.value) < kLargestTime;
  });
  result.not_finite = offsets.size() - used.size();
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
  Index first = 0;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const OffsetRange& range = ranges[k];
    const Index end = k + 1 < ranges.size() ? first_sample(raw, used, range, ranges[k + 1], first) : raw.size();
    const Index count = range.last - range.first + 1;
    const RobustLine line =
        huber_line(times.segment(range.first, count), values.segment(range.first, count), kLinearBeyond);
    for (Index i = first; i < end; ++i) result.time[i] += line.offset + line.slope * (raw[i] - line.at);
    if (end > first) result.segments.push_back({first, end - 1, line.offset, line.slope});
    first = end;
  }
  return result;
}

Dejittered dejitter(const Vector& time, double nominal_hz, std::span<const ClockSegment> clock_segments) {
  Dejittered result;
  result.time = time;
  const double longest = std::max(1.0, 500.0 / nominal_hz);
  std::size_t next = 0;
  double duration = 0.0;
  for (Index first = 0; first < time.size();) {
    while (next < clock_segments.size() && clock_segments[next].first <= first) ++next;
    const Index reset = next < clock_segments.size() ? clock_segments[next].first : time.size();
    Index end = first + 1;
    while (end < reset && std::abs(time[end] - time[end - 1]) <= longest) ++end;
    const Index count = end - first;
    auto stamps = result.time.segment(first, count);
    const double middle = static_cast<double>(count - 1) / 2.0;
    const Vector place = Vector::LinSpaced(count, -middle, middle);
    const double mean = stamps.mean(), spread = place.squaredNorm();
    const double interval = spread > 0.0 ? place.dot((stamps.array() - mean).matrix()) / spread : 0.0;
    stamps = (mean + interval * place.array()).matrix();
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
