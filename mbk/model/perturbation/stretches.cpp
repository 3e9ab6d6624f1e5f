#include "mbk/model/perturbation/stretches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/directions.h"
#include "mbk/model/perturbation/pauses.h"

namespace mbk::perturbation {
namespace {

/// T: time in which the speed grows to v or falls to zero.
double time_to_speed(double speed, double acceleration) {
  return 1.5 * speed / acceleration;
}

Result<void> check_stretches(const Stretches::Options& o) {
  if (!(std::abs(o.amplitude) > 0.0 && std::isfinite(o.amplitude))) {
    return bad_usage(fmt::format("amplitude {} of the stretches is zero or not finite", o.amplitude));
  }
  MBK_TRY(above_zero({{"acceleration of the stretches", o.acceleration, ""},
                      {"duration of the hold", o.hold, "s"},
                      {"duration of the return", o.way_back, "s"}}));
  MBK_TRY(not_negative({{"quiet time", o.quiet, "s"}}));
  if (o.speeds.empty()) return bad_usage("there are no speeds of stretches");
  if (o.repetitions < 1)
    return bad_usage(fmt::format("{} repetitions are too few: at least 1 is needed", o.repetitions));
  if (o.repetitions > Stretches::kMaxStretches / static_cast<double>(o.speeds.size())) {
    return bad_usage(fmt::format("{} speeds, {} times each, are more than {} stretches", o.speeds.size(), o.repetitions,
                                 Stretches::kMaxStretches));
  }
  for (const double speed : o.speeds) {
    MBK_TRY(above_zero({{"speed of a stretch", speed, ""}}));
    const double changing = speed * time_to_speed(speed, o.acceleration);  // both changes together
    if (changing < std::abs(o.amplitude)) continue;
    return bad_usage(
        fmt::format("speed {:.4g} is never constant: its change alone takes {:.4g}, the amplitude is {:.4g}", speed,
                    changing, std::abs(o.amplitude)),
        "lower the speed, or increase the acceleration or the amplitude");
  }
  MBK_TRY(check_pauses(o.shortest_pause, o.longest_pause));
  return {};
}

/// Indices of the speeds, stretch by stretch.
std::vector<int> speed_order(const Stretches::Options& o, numeric::Random& random) {
  const int speeds = static_cast<int>(o.speeds.size());
  if (o.order == Stretches::Order::random) return shuffled_directions(speeds, o.repetitions, random);
  std::vector<int> order;
  for (int i = 0; i < speeds * o.repetitions; ++i) order.push_back(i % speeds);
  return order;
}

}  // namespace

Stretches::Stretches(const Options& options)
    : options_(options), back_({options.amplitude, 0.0, 0.0}, {0.0, 0.0, 0.0}, options.way_back) {}

Result<Stretches> Stretches::create(const Options& options) {
  MBK_TRY(check_stretches(options));
  Stretches schedule(options);
  numeric::Random random(options.seed);
  double rest = options.quiet;
  for (const int index : speed_order(options, random)) {
    Stretch one;
    one.speed = options.speeds[static_cast<std::size_t>(index)];
    const double change = time_to_speed(one.speed, options.acceleration);
    one.onset = rest + random.uniform(options.shortest_pause, options.longest_pause);
    one.fast = one.onset + change;
    one.slowing = one.onset + std::abs(options.amplitude) / one.speed;
    one.still = one.slowing + change;
    one.offset = one.still + options.hold;
    rest = one.offset + options.way_back;
    schedule.stretches_.push_back(one);
  }
  return schedule;
}

Jet<double> Stretches::at(double t) const {
  const auto next = std::ranges::upper_bound(stretches_, t, {}, &Stretch::onset);
  if (next == stretches_.begin()) return {0.0, 0.0, 0.0};
  const Stretch& one = *std::prev(next);
  if (t >= one.offset) return back_.at(t - one.offset);
  if (t >= one.still) return {options_.amplitude, 0.0, 0.0};
  const double v = std::copysign(one.speed, options_.amplitude), change = one.fast - one.onset;
  const double covered = 0.5 * v * change;  // in each change of speed
  if (t < one.fast) return MinimumJerk({0.0, 0.0, 0.0}, {covered, v, 0.0}, change).at(t - one.onset);
  if (t < one.slowing) return {covered + v * (t - one.fast), v, 0.0};
  return MinimumJerk({options_.amplitude - covered, v, 0.0}, {options_.amplitude, 0.0, 0.0}, change)
      .at(t - one.slowing);
}

Hertz Stretches::bandwidth() const {
  constexpr double kReturn = 0.6874;  // of a minimum-jerk path (RampAndHold::bandwidth)
  const double speed = *std::ranges::max_element(options_.speeds);
  const double duration = std::abs(options_.amplitude) / speed, change = time_to_speed(speed, options_.acceleration);
  const auto share = [&](double f) {
    const double x = std::numbers::pi * f * duration, y = std::numbers::pi * f * change;
    const double smoothed = y < 1e-3 ? 1.0 : 3.0 * (std::sin(y) - y * std::cos(y)) / (y * y * y);
    return std::sin(x) / x * smoothed;
  };
  double low = 0.0, high = 1.0 / duration;  // the first zero of sinc
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (share(middle) > std::numbers::sqrt2 / 2.0 ? low : high) = middle;
  }
  return Hertz(std::max(low, kReturn / options_.way_back));
}

}  // namespace mbk::perturbation
