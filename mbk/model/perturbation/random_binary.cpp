#include "mbk/model/perturbation/random_binary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::perturbation {
namespace {

Result<void> check(const RandomBinaryOptions& o, double duration) {
  if (!(o.amplitude > 0.0 && std::isfinite(o.amplitude))) {
    return bad_usage(fmt::format("binary amplitude {} is not positive", o.amplitude));
  }
  if (!(duration > 0.0 && std::isfinite(duration))) {
    return bad_usage(fmt::format("duration {} s is not positive", duration));
  }
  if (!(o.switching_time > 0.0 && o.switching_time <= duration)) {
    return bad_usage(
        fmt::format("switching time {} s is not between 0 and the duration {} s", o.switching_time, duration));
  }
  if (duration / o.switching_time > RandomBinary::kMaxIntervals) {
    return bad_usage(fmt::format("switching time {} s divides the duration {} s into more than {} intervals",
                                 o.switching_time, duration, RandomBinary::kMaxIntervals),
                     "choose a longer switching time");
  }
  return {};
}

/// sin(πx)/(πx)
double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

}  // namespace

Result<RandomBinary> RandomBinary::create(const RandomBinaryOptions& options, double duration) {
  MBK_TRY(check(options, duration));
  const auto filter = MBK_TRY(UnderdampedFilter::create(options.damping_ratio, options.natural_frequency));

  constexpr double kRounding = 1e-9;  // of the ratio of two times
  const double ratio = duration / options.switching_time;
  const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(ratio - kRounding)));
  numeric::Random random(options.seed);
  std::vector<double> signs;
  if (options.zero_mean) {
    if (count % 2 != 0 || std::abs(ratio - static_cast<double>(count)) > kRounding) {
      return bad_usage(
          fmt::format("duration {} s is not an even multiple of the switching time {} s, so the mean would not be 0",
                      duration, options.switching_time),
          fmt::format("choose a duration of {} s", 2.0 * options.switching_time * std::ceil(0.5 * ratio - kRounding)));
    }
    for (std::size_t i = 0; i < count; ++i) signs.push_back(i % 2 == 0 ? 1.0 : -1.0);
    for (std::size_t i = count - 1; i > 0; --i) std::swap(signs[i], signs[random.below(i + 1)]);
  } else {
    for (std::size_t i = 0; i < count; ++i) signs.push_back(random.below(2) == 0 ? 1.0 : -1.0);
  }

  RandomBinary sequence(options, filter);
  Jet<double> state{0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const double input = options.amplitude * signs[i];
    sequence.intervals_.push_back({input, state.value, state.first});
    state = filter.response(state.value, state.first, input, sequence.start_of(i + 1) - sequence.start_of(i));
  }
  return sequence;
}

std::size_t RandomBinary::interval_at(double t) const {
  const double turns = std::min(t / options_.switching_time, static_cast<double>(intervals_.size() - 1));
  auto i = static_cast<std::size_t>(turns);
  if (start_of(i) > t) --i;  // the quotient may be rounded over a switch, either way
  if (i + 1 < intervals_.size() && start_of(i + 1) <= t) ++i;
  return i;
}

Jet<double> RandomBinary::at(double t) const {
  if (t < 0.0) return {0.0, 0.0, 0.0};
  const std::size_t i = interval_at(t);
  const Interval& interval = intervals_[i];
  return filter_.response(interval.value, interval.rate, interval.input, t - start_of(i));
}

double RandomBinary::reference(double t) const {
  return t < 0.0 ? 0.0 : intervals_[interval_at(t)].input;
}

Hertz RandomBinary::bandwidth() const {
  const auto density = [&](double f) {
    return std::pow(sinc(f * options_.switching_time), 2) * filter_.power_gain(Hertz(f));
  };
  // Above the bandwidth of G the density stays below one half. A step of 1/1000 of it, or of the sinc's lobes.
  const double top = filter_.bandwidth().value;
  const double step = 1e-3 * std::min(top, 1.0 / options_.switching_time);
  double high = top;
  while (high > 0.0 && density(high) < 0.5) high -= step;
  double low = std::max(high, 0.0);
  high = std::min(low + step, top);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (density(middle) < 0.5 ? high : low) = middle;
  }
  return Hertz(low);
}

}  // namespace mbk::perturbation
