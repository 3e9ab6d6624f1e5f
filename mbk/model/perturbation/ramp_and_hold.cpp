#include "mbk/model/perturbation/ramp_and_hold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/directions.h"
#include "mbk/model/perturbation/pauses.h"

namespace mbk::perturbation {
namespace {

Result<void> check_ramps(const RampAndHold::Options& o) {
  const auto positive = [](const char* what, double value, const char* unit) -> Result<void> {
    if (value > 0.0 && std::isfinite(value)) return {};
    return bad_usage(fmt::format("{} {}{} is not positive", what, value, unit));
  };
  MBK_TRY(positive("amplitude of the ramps", o.amplitude, ""));
  MBK_TRY(positive("duration of a ramp", o.ramp, " s"));
  MBK_TRY(positive("duration of the hold", o.hold, " s"));
  MBK_TRY(positive("duration of the return", o.way_back, " s"));
  if (o.directions < 1) return bad_usage(fmt::format("{} directions are too few: at least 1 is needed", o.directions));
  if (o.repetitions < 1)
    return bad_usage(fmt::format("{} repetitions are too few: at least 1 is needed", o.repetitions));
  if (o.repetitions > RampAndHold::kMaxRamps / o.directions) {
    return bad_usage(fmt::format("{} directions, {} times each, are more than {} ramps", o.directions, o.repetitions,
                                 RampAndHold::kMaxRamps));
  }
  MBK_TRY(check_pauses(o.shortest_pause, o.longest_pause));
  if (!(o.quiet >= 0.0 && std::isfinite(o.quiet)))
    return bad_usage(fmt::format("quiet time {} s is negative", o.quiet));
  return {};
}

}  // namespace

RampAndHold::RampAndHold(const Options& options)
    : options_(options),
      out_({0.0, 0.0, 0.0}, {options.amplitude, 0.0, 0.0}, options.ramp),
      back_({options.amplitude, 0.0, 0.0}, {0.0, 0.0, 0.0}, options.way_back) {}

Result<RampAndHold> RampAndHold::create(const Options& options) {
  MBK_TRY(check_ramps(options));
  RampAndHold schedule(options);
  numeric::Random random(options.seed);
  double rest = options.quiet;
  for (const int direction : shuffled_directions(options.directions, options.repetitions, random)) {
    const double onset = rest + random.uniform(options.shortest_pause, options.longest_pause);
    const double offset = onset + options.ramp + options.hold;
    schedule.ramps_.push_back({onset, offset, direction, 2.0 * std::numbers::pi * direction / options.directions,
                               direction_on_circle(direction, options.directions)});
    rest = offset + options.way_back;
  }
  return schedule;
}

Jet<Eigen::Vector2d> RampAndHold::at(double t) const {
  const auto next = std::ranges::upper_bound(ramps_, t, {}, &Ramp::onset);
  if (next == ramps_.begin()) return {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  const Ramp& ramp = *std::prev(next);
  const Jet<double> along = t < ramp.offset ? out_.at(t - ramp.onset) : back_.at(t - ramp.offset);
  return {along.value * ramp.direction_B, along.first * ramp.direction_B, along.second * ramp.direction_B};
}

Hertz RampAndHold::bandwidth() const {
  constexpr double kHalfPower = 0.6874;  // root of 15 j₂(πu)/(πu)² = 1/√2
  return Hertz(kHalfPower / std::min(options_.ramp, options_.way_back));
}

}  // namespace mbk::perturbation
