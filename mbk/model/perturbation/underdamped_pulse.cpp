#include "mbk/model/perturbation/underdamped_pulse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/directions.h"
#include "mbk/model/perturbation/pauses.h"

namespace mbk::perturbation {
namespace {

Result<void> check(const PulseSchedule::Options& o) {
  if (!(o.amplitude > 0.0)) return bad_usage(fmt::format("pulse amplitude {} is not positive", o.amplitude));
  if (o.axes != 2 && o.axes != 3) return bad_usage(fmt::format("pulses have 2 or 3 axes, not {}", o.axes));
  if (o.directions < 1) return bad_usage(fmt::format("{} directions are too few: at least 1 is needed", o.directions));
  if (o.repetitions < 1)
    return bad_usage(fmt::format("{} repetitions are too few: at least 1 is needed", o.repetitions));
  const int directions = o.axes == 3 ? kDirectionsInSpace : o.directions;
  if (o.repetitions > PulseSchedule::kMaxPulses / directions) {
    return bad_usage(fmt::format("{} directions, {} times each, are more than {} pulses", directions, o.repetitions,
                                 PulseSchedule::kMaxPulses));
  }
  if (!(o.shortest_duration > 0.0 && o.shortest_duration <= o.longest_duration && std::isfinite(o.longest_duration))) {
    return bad_usage(fmt::format("pulse durations from {} s to {} s are not a range of positive times",
                                 o.shortest_duration, o.longest_duration));
  }
  MBK_TRY(check_pauses(o.shortest_pause, o.longest_pause));
  if (!(o.return_duration > 0.0 && o.return_duration <= o.shortest_pause)) {
    return bad_usage(fmt::format("the return takes {} s, which is not between 0 and the shortest pause {} s",
                                 o.return_duration, o.shortest_pause));
  }
  if (!(o.quiet >= 0.0 && std::isfinite(o.quiet)))
    return bad_usage(fmt::format("quiet time {} s is negative", o.quiet));
  return {};
}

}  // namespace

Result<UnderdampedPulse> UnderdampedPulse::create(double amplitude, double damping_ratio, RadPerSec natural_frequency) {
  if (!std::isfinite(amplitude)) return bad_usage(fmt::format("pulse amplitude {} is not finite", amplitude));
  const auto filter = MBK_TRY(UnderdampedFilter::create(damping_ratio, natural_frequency));
  return UnderdampedPulse(amplitude, filter);
}

Jet<double> UnderdampedPulse::at(double t) const {
  if (t < 0.0) return {0.0, 0.0, 0.0};
  return filter_.response(0.0, 0.0, amplitude_, t);
}

Result<PulseSchedule> PulseSchedule::create(const Options& options) {
  MBK_TRY(check(options));
  const auto shape =
      MBK_TRY(UnderdampedPulse::create(options.amplitude, options.damping_ratio, options.natural_frequency));

  PulseSchedule schedule(options, shape);
  const bool in_space = options.axes == 3;
  if (in_space) schedule.options_.directions = kDirectionsInSpace;
  numeric::Random random(options.seed);
  double end = options.quiet;
  for (const int direction : shuffled_directions(schedule.options_.directions, options.repetitions, random)) {
    const double onset = end + random.uniform(options.shortest_pause, options.longest_pause);
    end = onset + random.uniform(options.shortest_duration, options.longest_duration);
    if (in_space) {
      const Eigen::Vector3d along = direction_in_space(direction);
      schedule.pulses_.push_back({onset, end, direction, std::atan2(along.y(), along.x()), along});
    } else {
      schedule.pulses_.push_back({onset, end, direction, 2.0 * std::numbers::pi * direction / options.directions,
                                  direction_on_circle(direction, options.directions)});
    }
  }
  return schedule;
}

const PulseSchedule::Pulse* PulseSchedule::last_onset_before(double t) const {
  const auto next = std::ranges::upper_bound(pulses_, t, {}, &Pulse::onset);
  return next == pulses_.begin() ? nullptr : &*std::prev(next);
}

Jet<AxesVector> PulseSchedule::at(double t) const {
  const Pulse* pulse = last_onset_before(t);
  if (!pulse) {
    const AxesVector zero = AxesVector::Zero(options_.axes);
    return {zero, zero, zero};
  }
  const auto along = [&]() -> Jet<double> {
    if (t < pulse->offset) return shape_.at(t - pulse->onset);
    const MinimumJerk back(shape_.at(pulse->offset - pulse->onset), {0.0, 0.0, 0.0}, options_.return_duration);
    return back.at(t - pulse->offset);
  }();
  return {along.value * pulse->direction_B, along.first * pulse->direction_B, along.second * pulse->direction_B};
}

AxesVector PulseSchedule::reference(double t) const {
  const Pulse* pulse = last_onset_before(t);
  if (!pulse || t >= pulse->offset) return AxesVector::Zero(options_.axes);
  return options_.amplitude * pulse->direction_B;
}

}  // namespace mbk::perturbation
