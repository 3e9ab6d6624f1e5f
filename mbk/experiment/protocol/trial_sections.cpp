#include "mbk/experiment/protocol/trial_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace mbk::protocol {
namespace {

using config::above;
using config::at_least;
using config::between;
using config::Section;
using perturbation::MultisinePlan;
using perturbation::Plan;
using perturbation::PulsePlan;
using perturbation::Quantity;
using perturbation::RampPlan;
using perturbation::RandomBinaryPlan;
using perturbation::ReachPlan;
using perturbation::RestPlan;
using perturbation::Space;
using perturbation::StretchPlan;

/// A unit in which a perturbation may be given, and what it commands.
struct SizeUnit {
  std::string_view name;
  Quantity quantity;
  Space space;
};
constexpr SizeUnit kDegrees{"deg", Quantity::position, Space::joint},
    kMillimetres{"mm", Quantity::position, Space::hand}, kNewtons{"N", Quantity::force, Space::hand},
    kNewtonMetres{"Nm", Quantity::force, Space::joint};
constexpr std::array kSizeUnits = {kDegrees, kMillimetres, kNewtons, kNewtonMetres};

/// A size whose key's unit says what is commanded: peak_deg, peak_mm, peak_N.
struct Size {
  SizeUnit unit;
  double value;  ///< [rad, m, N or N·m]
};

/// The one of the allowed units that stands in the file. Without any it is the fallback, unless that has a unit of
/// another machine.
Size read_size(const Section& s, const std::string& word, const std::vector<SizeUnit>& allowed, const Size& fallback) {
  const auto key = [&](const SizeUnit& unit) { return fmt::format("{}_{}", word, unit.name); };
  std::string keys;
  for (const SizeUnit& unit : allowed) keys += (keys.empty() ? "" : " or ") + key(unit);
  const auto is_allowed = [&](const SizeUnit& unit) {
    return std::ranges::find(allowed, unit.name, &SizeUnit::name) != allowed.end();
  };
  std::optional<Size> size;
  for (const SizeUnit& unit : kSizeUnits) {
    if (!s.has(key(unit))) continue;
    if (!is_allowed(unit)) s.reject(key(unit), "this robot is not driven in that unit", "use " + keys);
    if (size) s.reject(key(unit), "the size is given twice, in different units", "keep one of them");
    size = {unit, s.number(key(unit), fallback.value, above(0))};
  }
  if (size) return *size;
  if (is_allowed(fallback.unit)) return fallback;
  return {allowed.front(), s.required_number(key(allowed.front()), above(0))};
}

std::optional<perturbation::OptimalPowerOptions> read_optimal_power(const Section& s) {
  enum class Power { flat, d_optimal };
  const auto power = s.choice("power", {{"flat", Power::flat}, {"d_optimal", Power::d_optimal}}, Power::flat);
  perturbation::OptimalPowerOptions options;
  options.limited = s.choice("power_limited_by", options.limited);
  options.floor = s.number("power_floor_percent", options.floor, between(0, 100));
  if (const Section nominal = s.section("nominal"); nominal.given()) {
    options.nominal = {nominal.required_number("mass_kg"), nominal.required_number("damping_Ns_per_m"),
                       nominal.required_number("stiffness_N_per_m")};
  }
  if (power == Power::flat) return std::nullopt;
  return options;
}

MultisinePlan read_multisine(const Section& s, const Size& size) {
  MultisinePlan plan;
  plan.quantity = size.unit.quantity;
  plan.space = size.unit.space;
  plan.peak = size.value;
  plan.period = s.number("period_s", plan.period, above(0));
  std::vector<double> harmonics(plan.harmonics.begin(), plan.harmonics.end());
  harmonics = s.numbers("harmonics", harmonics, between(1, 1e6));
  plan.harmonics.clear();
  for (const double harmonic : harmonics) {
    if (harmonic != std::round(harmonic)) s.reject("harmonics", fmt::format("{:g} is not a whole number", harmonic));
    plan.harmonics.push_back(static_cast<int>(harmonic));
  }
  const int odd_to = s.integer("odd_harmonics_to", 0, 0, 1'000'000);
  const int odd_group = s.integer("odd_group", 4, 0, 1000);
  if (odd_to > 0) plan.odd_grid = MultisinePlan::OddGrid{odd_to, odd_group};
  plan.phases = s.choice("phases", plan.phases);
  const auto phase_seed = s.integer<std::int64_t>("phase_seed", -1, -1, std::numeric_limits<std::int64_t>::max());
  if (phase_seed >= 0) plan.phase_seed = static_cast<std::uint64_t>(phase_seed);
  plan.axes = s.choice("axes", plan.axes);
  plan.optimal_power = read_optimal_power(s);
  plan.duration = s.number("duration_s", plan.duration, above(0));
  plan.moving_in = s.number("moving_in_s", plan.moving_in, at_least(0));
  return plan;
}

PulsePlan read_pulses(const Section& s, const Size& size) {
  PulsePlan plan;
  perturbation::PulseSchedule::Options& p = plan.pulses;
  plan.quantity = size.unit.quantity;
  plan.space = size.unit.space;
  p.amplitude = size.value;
  p.damping_ratio = s.number("damping_ratio", p.damping_ratio, config::within(0, 1));
  p.natural_frequency = RadPerSec(s.number("natural_frequency_rad_per_s", p.natural_frequency.value, above(0)));
  p.directions = s.integer("directions", p.directions, 1, 360);
  p.repetitions = s.integer("repetitions", p.repetitions, 1, 1000);
  p.shortest_duration = s.number("shortest_duration_s", p.shortest_duration, above(0));
  p.longest_duration = s.number("longest_duration_s", p.longest_duration, above(0));
  p.shortest_pause = s.number("shortest_pause_s", p.shortest_pause, above(0));
  p.longest_pause = s.number("longest_pause_s", p.longest_pause, above(0));
  p.return_duration = s.number("return_s", p.return_duration, above(0));
  p.quiet = s.number("quiet_s", p.quiet, at_least(0));
  plan.tail = s.number("tail_s", plan.tail, at_least(0));
  return plan;
}

RandomBinaryPlan read_random_binary(const Section& s, const Size& size) {
  RandomBinaryPlan plan;
  perturbation::RandomBinaryOptions& b = plan.sequence;
  plan.quantity = size.unit.quantity;
  plan.space = size.unit.space;
  b.amplitude = size.value;
  b.switching_time = s.number("switching_time_s", b.switching_time, above(0));
  b.zero_mean = s.flag("zero_mean", b.zero_mean);
  b.damping_ratio = s.number("damping_ratio", b.damping_ratio, config::within(0, 1));
  b.natural_frequency = RadPerSec(s.number("natural_frequency_rad_per_s", b.natural_frequency.value, above(0)));
  plan.angle = s.number("angle_deg", plan.angle);
  plan.duration = s.number("duration_s", plan.duration, above(0));
  return plan;
}

RampPlan read_ramps(const Section& s, const Size& size) {
  RampPlan plan;
  perturbation::RampAndHold::Options& r = plan.ramps;
  plan.space = size.unit.space;
  r.amplitude = size.value;
  r.ramp = s.number("ramp_s", r.ramp, above(0));
  r.hold = s.number("hold_s", r.hold, above(0));
  r.way_back = s.number("return_s", r.way_back, above(0));
  r.directions = s.integer("directions", r.directions, 1, 360);
  r.repetitions = s.integer("repetitions", r.repetitions, 1, 1000);
  r.shortest_pause = s.number("shortest_pause_s", r.shortest_pause, at_least(0));
  r.longest_pause = s.number("longest_pause_s", r.longest_pause, at_least(0));
  r.quiet = s.number("quiet_s", r.quiet, at_least(0));
  plan.tail = s.number("tail_s", plan.tail, at_least(0));
  return plan;
}

StretchPlan read_stretches(const Section& s) {
  StretchPlan plan;
  perturbation::Stretches::Options& r = plan.stretches;
  r.amplitude = s.number("amplitude_deg", r.amplitude);
  r.speeds = s.numbers("speeds_deg_per_s", r.speeds, above(0));
  r.repetitions = s.integer("repetitions", r.repetitions, 1, 1000);
  r.order = s.choice("order", r.order);
  r.acceleration = s.number("acceleration_deg_per_s2", r.acceleration, above(0));
  r.hold = s.number("hold_s", r.hold, above(0));
  r.way_back = s.number("return_s", r.way_back, above(0));
  r.shortest_pause = s.number("shortest_pause_s", r.shortest_pause, at_least(0));
  r.longest_pause = s.number("longest_pause_s", r.longest_pause, at_least(0));
  r.quiet = s.number("quiet_s", r.quiet, at_least(0));
  plan.tail = s.number("tail_s", plan.tail, at_least(0));
  return plan;
}

ReachPlan read_reaches(const Section& s) {
  ReachPlan plan;
  perturbation::ReachSchedule::Options& r = plan.reaches;
  r.amplitude = s.number("amplitude_mm", r.amplitude, above(0));
  r.out = s.number("ramp_s", r.out, above(0));
  r.hold = s.number("hold_s", r.hold, above(0));
  r.back = s.number("return_s", r.back, above(0));
  r.directions = s.integer("directions", r.directions, 1, 360);
  r.repetitions = s.integer("repetitions", r.repetitions, 1, 1000);
  r.undisturbed_first =
      s.integer("undisturbed_first", r.undisturbed_first, perturbation::ReachSchedule::kMinUndisturbedFirst, 1000);
  r.undisturbed_between = s.integer("undisturbed_between", r.undisturbed_between, 0, 1000);
  r.reach = s.vector2("reach_mm", r.reach);
  r.trigger = s.number("trigger_mm", r.trigger, above(0));
  r.reach_time = s.number("reach_s", r.reach_time, above(0));
  r.interval = s.number("interval_s", r.interval, above(0));
  r.quiet = s.number("quiet_s", r.quiet, at_least(0));
  plan.tail = s.number("tail_s", plan.tail, at_least(0));
  return plan;
}

/// A signal has limits in its own unit.
perturbation::Limits read_limits(const Section& s, const SizeUnit& unit) {
  perturbation::Limits limits;
  const auto limit = [&](std::string_view before, std::string_view after) {
    const auto key = [&](const SizeUnit& one) { return fmt::format("{}{}{}", before, one.name, after); };
    for (const SizeUnit& other : kSizeUnits) {
      if (other.name != unit.name && s.has(key(other))) {
        s.reject(key(other), fmt::format("the perturbation is in {}", unit.name), "use " + key(unit));
      }
    }
    return s.optional_number(key(unit), above(0));
  };
  limits.peak = limit("peak_", "");
  limits.speed = limit("speed_", "_per_s");
  if (const auto value = s.optional_number("bandwidth_hz", above(0))) limits.bandwidth = Hertz(*value);
  return limits;
}

}  // namespace

Machine read_machine(const Section& robot) {
  return robot.choice("kind", Machine::planar);
}

TrialPlan read_recording(const Section& s) {
  TrialPlan r;
  r.condition = s.text("condition", "");
  r.rate = Hertz(s.number("rate_hz", r.rate.value, between(10, 100'000)));
  r.seed = s.integer<std::uint64_t>("seed", r.seed, 0, std::numeric_limits<std::int64_t>::max());
  r.readers = s.choice("readable_by", r.readers);
  return r;
}

control::Mode read_control(const Section& s) {
  enum class Kind { position, force, line };
  const auto kind =
      s.required_choice<Kind>("kind", {{"position", Kind::position}, {"force", Kind::force}, {"line", Kind::line}});
  if (kind == Kind::force) return control::ForceMode{};
  if (kind == Kind::line) {
    control::LineMode mode;
    mode.line.angle = s.number("angle_deg", mode.line.angle);
    mode.line.stiffness = s.number("stiffness_N_per_m", mode.line.stiffness, at_least(0));
    mode.line.damping = s.number("damping_Ns_per_m", mode.line.damping, at_least(0));
    mode.line.velocity_cutoff = Hertz(s.number("velocity_cutoff_hz", mode.line.velocity_cutoff.value, above(0)));
    return mode;
  }
  control::PositionMode mode;
  mode.gains.proportional = s.vector2("proportional_Nm_per_rad", mode.gains.proportional, at_least(0));
  mode.gains.derivative = s.vector2("derivative_Nms_per_rad", mode.gains.derivative, at_least(0));
  mode.gains.velocity_cutoff = Hertz(s.number("velocity_cutoff_hz", mode.gains.velocity_cutoff.value, above(0)));
  return mode;
}

Plan read_perturbation(const Section& s, Machine machine) {
  enum class Kind { none, multisine, pulses, random_binary, ramp_and_hold, stretches, servo_displacement };
  const bool joint = machine == Machine::joint, one_axis = joint || machine == Machine::one_axis;
  const bool space = machine == Machine::space;
  const std::vector<SizeUnit> of_joint = {kDegrees}, of_axis = {kDegrees, kNewtonMetres}, in_space = {kMillimetres},
                              at_hand = {kMillimetres, kNewtons}, of_sines = {kDegrees, kMillimetres, kNewtons};
  const auto sizes = [&](const std::vector<SizeUnit>& in_plane) {
    return joint ? of_joint : one_axis ? of_axis : space ? in_space : in_plane;
  };
  const auto amplitude = [&](const SizeUnit& unit, double fallback) {
    return read_size(s, "amplitude", sizes(at_hand), {unit, fallback});
  };
  Plan plan;
  plan.axes = space ? 3 : 2;
  SizeUnit unit = kMillimetres;
  const auto kind = s.required_choice<Kind>("kind", {{"multisine", Kind::multisine},
                                                     {"pulses", Kind::pulses},
                                                     {"random_binary", Kind::random_binary},
                                                     {"ramp_and_hold", Kind::ramp_and_hold},
                                                     {"stretches", Kind::stretches},
                                                     {"servo_displacement", Kind::servo_displacement},
                                                     {"none", Kind::none}});
  if (space && kind != Kind::multisine && kind != Kind::pulses) {
    s.reject("kind", "this perturbation is planar", "use multisine or pulses in space");
    return plan;
  }
  if (joint && kind == Kind::none) s.reject("kind", "the machine has to move the joint", "use stretches, for example");
  switch (kind) {
    case Kind::none:
      plan.kind = RestPlan{s.number("duration_s", RestPlan{}.duration, above(0))};
      break;
    case Kind::multisine: {
      const Size size = read_size(s, "peak", sizes(of_sines), {kDegrees, MultisinePlan{}.peak});
      plan.kind = read_multisine(s, size);
      unit = size.unit;
      break;
    }
    case Kind::pulses: {
      const Size size = amplitude(kMillimetres, PulsePlan{}.pulses.amplitude);
      plan.kind = read_pulses(s, size);
      unit = size.unit;
      break;
    }
    case Kind::random_binary: {
      const Size size = amplitude(kNewtons, RandomBinaryPlan{}.sequence.amplitude);
      plan.kind = read_random_binary(s, size);
      unit = size.unit;
      break;
    }
    case Kind::ramp_and_hold: {
      const SizeUnit displaced = one_axis ? kDegrees : kMillimetres;
      const Size size = read_size(s, "amplitude", {displaced}, {kMillimetres, RampPlan{}.ramps.amplitude});
      plan.kind = read_ramps(s, size);
      unit = size.unit;
      break;
    }
    case Kind::stretches:
      if (!one_axis) s.reject("kind", "stretches move one joint", "use a robot of kind joint or one_axis");
      plan.kind = read_stretches(s);
      unit = kDegrees;
      break;
    case Kind::servo_displacement:
      if (one_axis) s.reject("kind", "reaching needs a plane", "use a planar robot");
      plan.kind = read_reaches(s);
      break;
  }
  plan.limits = read_limits(s.section("limits"), unit);
  return plan;
}

}  // namespace mbk::protocol
