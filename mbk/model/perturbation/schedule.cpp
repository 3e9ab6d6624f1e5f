#include "mbk/model/perturbation/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "mbk/model/perturbation/largest_value.h"

namespace mbk::perturbation {
namespace {

Result<void> check_duration(double duration) {
  if (!(duration > 0.0)) return bad_usage(fmt::format("duration {} s is not positive", duration));
  if (!(duration <= Schedule::kLongest)) {
    return bad_usage(fmt::format("duration {:g} s is above {} s", duration, Schedule::kLongest),
                     "split it into several trials");
  }
  return {};
}

Jet<AxesVector> along(const Jet<double>& r, const Eigen::Vector2d& direction_B) {
  return {r.value * direction_B, r.first * direction_B, r.second * direction_B};
}

Jet<AxesVector> of_plane(const Jet<Eigen::Vector2d>& r) {
  return {r.value, r.first, r.second};
}

/// Unit vector at an angle; rounding errors are set to zero, so that π/2 leaves the x axis at rest.
Eigen::Vector2d unit_vector(double angle) {
  const auto component = [](double value) { return std::abs(value) < 1e-15 ? 0.0 : value; };
  return {component(std::cos(angle)), component(std::sin(angle))};
}

/// Lowest and highest frequency of the lines that have an amplitude.
void widen(std::pair<Hertz, Hertz>& band, const Multisine& signal) {
  for (const Multisine::Line& line : signal.lines()) {
    if (line.amplitude == 0.0) continue;
    const Hertz frequency(line.harmonic / signal.period());
    if (band.second.value == 0.0) band.first = frequency;
    band.first = std::min(band.first, frequency);
    band.second = std::max(band.second, frequency);
  }
}

/// To three significant digits.   ratio > 0
double rounded_down(double ratio) {
  const double digit = std::pow(10.0, std::floor(std::log10(ratio)) - 2.0);
  return digit * std::floor(ratio / digit);
}

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

std::string_view unit(Quantity quantity, Space space) {
  if (quantity == Quantity::position) return space == Space::hand ? "m" : "rad";
  return space == Space::hand ? "N" : "N·m";
}

Result<Schedule> Schedule::multisine(std::vector<Multisine> axes, Quantity quantity, Space space, double duration,
                                     double moving_in) {
  if (axes.empty() || axes.size() > 3) return bad_usage(fmt::format("a schedule cannot have {} axes", axes.size()));
  MBK_TRY(check_duration(duration));
  if (!(moving_in > 0.0 && moving_in <= duration)) {
    return bad_usage(fmt::format("moving-in time {} s is not between 0 and the duration {} s", moving_in, duration),
                     "shorten the moving-in time, or lengthen the perturbation");
  }
  const MinimumJerk growth({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, moving_in);
  return with_countable_cycles(Schedule(Sines{std::move(axes), growth, moving_in}, quantity, space, duration));
}

Result<Schedule> Schedule::pulses(const PulseSchedule::Options& options, Quantity quantity, double tail, Space space) {
  auto schedule = PulseSchedule::create(options);
  if (!schedule) return tl::unexpected(schedule.error());
  if (!(tail >= options.return_duration)) {
    return bad_usage(fmt::format("tail {} s is shorter than the return {} s", tail, options.return_duration));
  }
  const double duration = schedule->pulses().back().offset + tail;
  MBK_TRY(check_duration(duration));
  return with_countable_cycles(Schedule(*std::move(schedule), quantity, space, duration));
}

Result<Schedule> Schedule::random_binary(const RandomBinaryOptions& options, double angle, Quantity quantity,
                                         double duration, Space space) {
  MBK_TRY(check_duration(duration));
  if (!std::isfinite(angle)) return bad_usage(fmt::format("angle {} rad is not finite", angle));
  auto sequence = RandomBinary::create(options, duration);
  if (!sequence) return tl::unexpected(sequence.error());
  return with_countable_cycles(Schedule(Binary{*std::move(sequence), unit_vector(angle)}, quantity, space, duration));
}

Result<Schedule> Schedule::ramps(const RampAndHold::Options& options, double tail, Space space) {
  auto schedule = RampAndHold::create(options);
  if (!schedule) return tl::unexpected(schedule.error());
  if (!(tail >= 0.0)) return bad_usage(fmt::format("tail {} s is negative", tail));
  const double duration = schedule->end() + tail;
  MBK_TRY(check_duration(duration));
  return with_countable_cycles(Schedule(*std::move(schedule), Quantity::position, space, duration));
}

Result<Schedule> Schedule::stretches(const Stretches::Options& options, double tail, Space space) {
  auto schedule = Stretches::create(options);
  if (!schedule) return tl::unexpected(schedule.error());
  if (!(tail >= 0.0)) return bad_usage(fmt::format("tail {} s is negative", tail));
  const double duration = schedule->end() + tail;
  MBK_TRY(check_duration(duration));
  return with_countable_cycles(Schedule(*std::move(schedule), Quantity::position, space, duration));
}

Result<Schedule> Schedule::reaches(const ReachSchedule::Options& options, double tail) {
  auto schedule = ReachSchedule::create(options);
  if (!schedule) return tl::unexpected(schedule.error());
  if (!(tail >= 0.0)) return bad_usage(fmt::format("tail {} s is negative", tail));
  const double duration = schedule->end() + tail;
  MBK_TRY(check_duration(duration));
  return with_countable_cycles(Schedule(*std::move(schedule), Quantity::position, Space::hand, duration));
}

Result<Schedule> Schedule::rest(double duration) {
  MBK_TRY(check_duration(duration));
  return Schedule(Rest{}, Quantity::position, Space::hand, duration);
}

int Schedule::axes() const {
  if (const auto* sines = std::get_if<Sines>(&shape_)) return static_cast<int>(sines->axes.size());
  if (const auto* pulses = std::get_if<PulseSchedule>(&shape_)) return pulses->options().axes;
  return 2;
}

Jet<AxesVector> Schedule::at(double t) const {
  const AxesVector zero = AxesVector::Zero(axes());
  if (t < 0.0) return {zero, zero, zero};
  return std::visit(
      Overloaded{[&](const Rest&) -> Jet<AxesVector> {
                   return {zero, zero, zero};
                 },
                 [&](const Sines& sines) -> Jet<AxesVector> {
                   const Jet<double> g = sines.growth.at(t);
                   Jet<AxesVector> r{zero, zero, zero};
                   for (Eigen::Index i = 0; i < zero.size(); ++i) {
                     const Jet<double> s = sines.axes[static_cast<std::size_t>(i)].at(t);
                     r.value[i] = g.value * s.value;
                     r.first[i] = g.first * s.value + g.value * s.first;
                     r.second[i] = g.second * s.value + 2.0 * g.first * s.first + g.value * s.second;
                   }
                   return r;
                 },
                 [&](const PulseSchedule& pulses) { return pulses.at(t); },
                 [&](const RampAndHold& ramps) { return of_plane(ramps.at(t)); },
                 [&](const Stretches& stretches) { return along(stretches.at(t), Eigen::Vector2d::UnitX()); },
                 [&](const ReachSchedule& reaches) { return of_plane(reaches.at(t)); },
                 [&](const Binary& binary) { return along(binary.sequence.at(t), binary.direction_B); }},
      shape_);
}

AxesVector Schedule::reference(double t) const {
  if (const auto* pulses = std::get_if<PulseSchedule>(&shape_)) return pulses->reference(t);
  return at(t).value;
}

std::vector<ScheduleEvent> Schedule::events() const {
  std::vector<ScheduleEvent> events;
  if (const auto* schedule = std::get_if<PulseSchedule>(&shape_)) {
    for (const PulseSchedule::Pulse& pulse : schedule->pulses()) {
      events.push_back({pulse.onset, "onset", pulse.angle});
      events.push_back({pulse.offset, "offset", pulse.angle});
    }
  } else if (const auto* schedule_of_ramps = std::get_if<RampAndHold>(&shape_)) {
    for (const RampAndHold::Ramp& ramp : schedule_of_ramps->ramps()) {
      events.push_back({ramp.onset, "onset", ramp.angle});
      events.push_back({ramp.offset, "offset", ramp.angle});
    }
  } else if (const Stretches* at_speeds = stretches()) {
    const double angle = at_speeds->options().amplitude > 0.0 ? 0.0 : std::numbers::pi;
    for (const Stretches::Stretch& stretch : at_speeds->stretches()) {
      events.push_back({stretch.onset, "onset", angle});
      events.push_back({stretch.offset, "offset", angle});
    }
  }
  return events;
}

std::pair<Hertz, Hertz> Schedule::band() const {
  std::pair<Hertz, Hertz> band;
  std::visit(Overloaded{[](const Rest&) {},
                        [&](const Sines& sines) {
                          for (const Multisine& axis : sines.axes) widen(band, axis);
                        },
                        [&](const PulseSchedule& pulses) { band.second = pulses.bandwidth(); },
                        [&](const RampAndHold& ramps) { band.second = ramps.bandwidth(); },
                        [&](const Stretches& stretches) { band.second = stretches.bandwidth(); },
                        [&](const ReachSchedule& reaches) { band.second = reaches.bandwidth(); },
                        [&](const Binary& binary) { band.second = binary.sequence.bandwidth(); }},
             shape_);
  return band;
}

/// A pulse or binary sequence excites the oscillation of G, whatever its switching leaves of the band.
Hertz Schedule::fastest() const {
  const auto* binary = std::get_if<Binary>(&shape_);
  return binary ? binary->sequence.filter().bandwidth() : band().second;
}

Result<Schedule> Schedule::with_countable_cycles(Schedule schedule) {
  const double cycles = schedule.fastest().value * schedule.duration();
  if (cycles <= kMaxCycles) return schedule;
  return bad_usage(fmt::format("{:.4g} Hz over {:g} s are more than {:g} cycles", schedule.fastest().value,
                               schedule.duration(), kMaxCycles),
                   "lower the highest frequency, or split it into several trials");
}

/// Times between which the signal is smooth, from 0 to the duration.
std::vector<double> Schedule::breaks() const {
  std::vector<double> times = {0.0};
  if (const auto* sines = std::get_if<Sines>(&shape_)) {
    times.push_back(sines->moving_in);
  } else if (const auto* schedule = std::get_if<PulseSchedule>(&shape_)) {
    for (const PulseSchedule::Pulse& pulse : schedule->pulses()) {
      for (const double time : {pulse.onset, pulse.offset, pulse.offset + schedule->options().return_duration}) {
        times.push_back(time);
      }
    }
  } else if (const auto* ramps = std::get_if<RampAndHold>(&shape_)) {
    const RampAndHold::Options& o = ramps->options();
    for (const RampAndHold::Ramp& ramp : ramps->ramps()) {
      for (const double time : {ramp.onset, ramp.onset + o.ramp, ramp.offset, ramp.offset + o.way_back}) {
        times.push_back(time);
      }
    }
  } else if (const Stretches* at_speeds = stretches()) {
    for (const Stretches::Stretch& s : at_speeds->stretches()) {
      for (const double time :
           {s.onset, s.fast, s.slowing, s.still, s.offset, s.offset + at_speeds->options().way_back}) {
        times.push_back(time);
      }
    }
  } else if (const ReachSchedule* displaced = reaches()) {
    const ReachSchedule::Options& o = displaced->options();
    for (std::size_t k = 0; k < displaced->reaches().size(); ++k) {
      const double trigger = displaced->trigger_time(k);
      for (const double later : {0.0, o.out, o.out + o.hold, displaced->displaced_for()}) {
        times.push_back(trigger + later);
      }
    }
  } else if (const auto* binary = std::get_if<Binary>(&shape_)) {
    for (std::size_t i = 1; i < binary->sequence.size(); ++i) {
      times.push_back(static_cast<double>(i) * binary->sequence.options().switching_time);
    }
  }
  times.push_back(duration_);
  return times;
}

/// 64 samples to the period of the highest frequency and 8 at least between two breaks, each of which is sampled on
/// both sides.
std::vector<double> Schedule::grid() const {
  const std::vector<double> times = breaks();
  const double highest = fastest().value;
  std::vector<double> grid = {0.0};
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double length = times[i + 1] - times[i];
    if (!(length > 0.0)) continue;
    const int pieces = static_cast<int>(std::max(8.0, std::ceil(64.0 * highest * length)));
    for (int k = 1; k < pieces; ++k) grid.push_back(times[i] + length * k / pieces);
    grid.push_back(std::nextafter(times[i + 1], 0.0));
    grid.push_back(times[i + 1]);
  }
  return grid;
}

Facts Schedule::facts() const {
  const std::vector<double> times = grid();
  std::vector<Jet<AxesVector>> samples;
  samples.reserve(times.size());
  for (const double t : times) samples.push_back(at(t));
  const auto largest = [&](const auto& measure) {
    std::vector<double> values;
    values.reserve(samples.size());
    for (const auto& sample : samples) values.push_back(measure(sample));
    return largest_value(times, values, [&](double t) { return measure(at(t)); });
  };
  using Sample = Jet<AxesVector>;
  const LargestValue peak = largest([](const Sample& r) { return r.value.norm(); });
  const LargestValue speed = largest([](const Sample& r) { return r.first.norm(); });
  const LargestValue acceleration = largest([](const Sample& r) { return r.second.norm(); });

  Facts facts;
  facts.peak = peak.value;
  facts.peak_time = peak.time;
  facts.peak_speed = speed.value;
  facts.peak_speed_time = speed.time;
  facts.peak_acceleration = acceleration.value;
  facts.peak_acceleration_time = acceleration.time;
  const AxesVector zero = AxesVector::Zero(axes());
  facts.axis_peak = zero;
  for (int axis = 0; axis < axes(); ++axis) {
    facts.axis_peak[axis] = largest([&](const Sample& r) { return std::abs(r.value[axis]); }).value;
  }
  AxesVector energy = zero;  // ∫ r² dt by Simpson's rule on each piece
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const AxesVector middle = at(0.5 * (times[i] + times[i + 1])).value;
    energy += (times[i + 1] - times[i]) / 6.0 *
              (samples[i].value.cwiseAbs2() + 4.0 * middle.cwiseAbs2() + samples[i + 1].value.cwiseAbs2());
  }
  facts.axis_rms = (energy / duration_).cwiseSqrt();
  facts.rms = std::sqrt(energy.sum() / duration_);
  facts.crest_factor = zero;
  for (int axis = 0; axis < axes(); ++axis) {
    if (facts.axis_rms[axis] > 0.0) facts.crest_factor[axis] = facts.axis_peak[axis] / facts.axis_rms[axis];
  }
  std::tie(facts.lowest_frequency, facts.highest_frequency) = band();
  return facts;
}

Result<void> Schedule::check(const Limits& limits) const {
  const Facts found = facts();
  const std::string_view u = unit(quantity_, space_);
  const char* name = quantity_ == Quantity::position ? "displacement" : space_ == Space::hand ? "force" : "torque";
  struct Demand {
    std::string name;
    double value, time;
    std::optional<double> limit;
    std::string unit;
  };
  const Demand demands[] = {{fmt::format("peak {}", name), found.peak, found.peak_time, limits.peak, std::string(u)},
                            {fmt::format("rate of the {}", name), found.peak_speed, found.peak_speed_time, limits.speed,
                             fmt::format("{}/s", u)},
                            {fmt::format("second derivative of the {}", name), found.peak_acceleration,
                             found.peak_acceleration_time, limits.acceleration, fmt::format("{}/s²", u)}};
  for (const Demand& demand : demands) {
    if (!demand.limit) continue;
    if (!(*demand.limit > 0.0)) {
      return bad_usage(fmt::format("limit {} {} of the {} is not positive", *demand.limit, demand.unit, demand.name));
    }
    if (demand.value <= *demand.limit) continue;
    return bad_usage(
        fmt::format("{} {:.6g} {} at {:.3f} s is above the limit {:.6g} {}", demand.name, demand.value, demand.unit,
                    demand.time, *demand.limit, demand.unit),
        fmt::format("multiply the amplitude by {:.3g} or less", rounded_down(*demand.limit / demand.value)));
  }
  if (limits.bandwidth) {
    if (!(limits.bandwidth->value > 0.0)) {
      return bad_usage(fmt::format("limit {} Hz of the bandwidth is not positive", limits.bandwidth->value));
    }
    if (found.highest_frequency > *limits.bandwidth) {
      const bool lines = std::holds_alternative<Sines>(shape_);
      return bad_usage(fmt::format("highest frequency {:.4g} Hz of the {} is above the limit {:.4g} Hz",
                                   found.highest_frequency.value, name, limits.bandwidth->value),
                       lines ? "remove the harmonics above it"
                       : std::holds_alternative<RampAndHold>(shape_) || reaches() != nullptr ? "make the ramps slower"
                       : stretches() != nullptr ? "make the stretches slower"
                                                : "lower the natural frequency of the filter");
    }
  }
  if (limits.reachable && quantity_ == Quantity::position) {
    for (const double t : grid()) {
      if (const auto inside = limits.reachable(at(t).value); !inside) {
        return tl::unexpected(inside.error().in(fmt::format("displacement at {:.3f} s", t)));
      }
    }
  }
  return {};
}

}  // namespace mbk::perturbation
