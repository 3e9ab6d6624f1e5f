#include "mbk/laboratory/experiment.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "mbk/laboratory/truth_text.h"
#include "mbk/robot/workspace.h"

namespace mbk::laboratory {
namespace {

using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

/// One control law with the schedule behind it: from measured angles to torques, and what is recorded as reference.
class Command {
 public:
  static Result<Command> create(const Experiment& experiment, const Vector2d& home_angles) {
    const bool position = std::holds_alternative<PositionMode>(experiment.control);
    if (position != (experiment.schedule.quantity() == Quantity::position)) {
      return bad_usage(position ? "position control cannot follow a force perturbation"
                                : "force control cannot follow a position perturbation",
                       "let control and perturbation speak of the same quantity");
    }
    if (!position && experiment.schedule.space() == Space::joint) {
      return bad_usage("a perturbation of the joints' torques cannot be exerted at the hand", "give it as a force");
    }
    Command command(experiment, home_angles);
    const double sample_time = 1.0 / experiment.rate.value;
    if (const auto* mode = std::get_if<PositionMode>(&experiment.control)) {
      auto law = control::JointPositionControl::create(mode->gains, sample_time);
      if (!law) return tl::unexpected(law.error());
      command.law_ = *law;
    } else if (const auto* line_mode = std::get_if<LineMode>(&experiment.control)) {
      control::LineConstraint::Options line = line_mode->line;
      line.through = experiment.home;
      auto law = control::LineConstraint::create(line, command.geometry_, sample_time);
      if (!law) return tl::unexpected(law.error());
      command.law_ = *law;
    }
    return command;
  }

  /// τ [N·m] for the time t.
  Vector2d torque(double t, const Vector2d& measured) {
    const perturbation::Jet<Vector2d> now = schedule_->at(t);
    if (auto* follow = std::get_if<control::JointPositionControl>(&law_)) {
      if (schedule_->space() == Space::joint) return follow->step(measured, home_angles_ + now.value, now.first);
      const auto angles = robot::joint_angles(geometry_, home_ + now.value);
      if (angles) angles_ = *angles;  // the schedule was checked to stay within reach
      return follow->step(measured, angles_, robot::jacobian(geometry_, angles_).inverse() * now.first);
    }
    if (auto* line = std::get_if<control::LineConstraint>(&law_)) return line->step(measured, now.value);
    return std::get<control::ForceControl>(law_).step(measured, now.value);
  }

  /// What stands in the recording: the hand's place behind a position, or the force [m or N].
  [[nodiscard]] Vector2d reference(double t) const {
    const Vector2d value = schedule_->reference(t);
    if (schedule_->quantity() == Quantity::force) return value;
    if (schedule_->space() == Space::hand) return home_ + value;
    return robot::hand_position(geometry_, home_angles_ + value);
  }

  /// Place of the hand that the schedule asks for, where it asks for one.
  [[nodiscard]] Vector2d place(const Vector2d& value) const {
    return schedule_->space() == Space::hand ? Vector2d(home_ + value)
                                             : robot::hand_position(geometry_, home_angles_ + value);
  }

 private:
  Command(const Experiment& experiment, const Vector2d& home_angles)
      : schedule_(&experiment.schedule),
        geometry_(experiment.robot.robot.geometry),
        home_(experiment.home),
        home_angles_(home_angles),
        angles_(home_angles),
        law_(control::ForceControl(geometry_)) {}

  const Schedule* schedule_;
  robot::Geometry geometry_;
  Vector2d home_, home_angles_, angles_;
  std::variant<control::ForceControl, control::JointPositionControl, control::LineConstraint> law_;
};

Result<Vector2d> checked_home(const Experiment& experiment) {
  const robot::Geometry& geometry = experiment.robot.robot.geometry;
  auto angles = robot::check_hand(geometry, experiment.home);
  if (!angles) return tl::unexpected(angles.error().in("home"));
  return angles;
}

/// The truth is asked for at every so many ticks.
constexpr Index kTruthTicks = 100;

/// Average of what an arm is while it tenses and relaxes.
class MeanImpedance {
 public:
  void add(const impedance::Model& model) {
    const Vector row = impedance::stacked(model);
    sum_ = count_ == 0 ? row : Vector(sum_ + row);
    ++count_;
  }
  [[nodiscard]] impedance::Model mean() const { return impedance::unstacked(sum_ / count_, 2); }

 private:
  Vector sum_;
  double count_ = 0;
};

/// Channels in the order of the recording, filled sample by sample.
class Channels {
 public:
  Channels(Index samples, Quantity quantity) {
    const char* reference_unit = quantity == Quantity::force ? "N" : "m";
    add(samples, {"hand_x", "hand_y"}, "m", "base");
    add(samples, {"joint_1", "joint_2"}, "rad", "joint");
    add(samples, {"force_x", "force_y"}, "N", "base");
    add(samples, {"reference_x", "reference_y"}, reference_unit, "base");
    add(samples, {"torque_1", "torque_2"}, "N.m", "joint");
    add(samples, {"acceleration_x", "acceleration_y"}, "m/s2", "base");
  }

  void set(Index i, const SensorSuite::Reading& reading, const Vector2d& reference) {
    const std::array<Vector2d, 6> pairs = {reading.hand, reading.joint,  reading.force,
                                           reference,    reading.torque, reading.acceleration};
    for (std::size_t k = 0; k < channels.size(); ++k) channels[k].values[i] = pairs[k / 2][static_cast<Index>(k % 2)];
  }

  std::vector<Channel> channels;

 private:
  void add(Index samples, std::array<const char*, 2> names, const char* unit, const char* frame) {
    for (const char* name : names) channels.push_back({name, unit, frame, Vector(samples)});
  }
};

}  // namespace

Result<Performance> perform(const Experiment& experiment, participant::Load& load) {
  if (!(experiment.rate.value > 0.0 && std::isfinite(experiment.rate.value))) {
    return bad_usage(fmt::format("sample rate {:g} Hz is not above 0", experiment.rate.value));
  }
  const double sample_time = 1.0 / experiment.rate.value;
  const auto home_angles = checked_home(experiment);
  if (!home_angles) return tl::unexpected(home_angles.error());
  auto command = Command::create(experiment, *home_angles);
  if (!command) return tl::unexpected(command.error());
  const robot::Geometry& geometry = experiment.robot.robot.geometry;
  if (experiment.schedule.quantity() == Quantity::position) {
    perturbation::Limits limits;
    limits.reachable = [&](const Vector2d& value) -> Result<void> {
      const auto angles = robot::check_hand(geometry, command->place(value));
      if (!angles) return tl::unexpected(angles.error());
      return {};
    };
    if (auto ok = experiment.schedule.check(limits); !ok) return tl::unexpected(ok.error().in("perturbation"));
  }
  auto loop = ClosedLoop::create(experiment.robot, experiment.home, load, sample_time);
  if (!loop) return tl::unexpected(loop.error());
  auto sensors = SensorSuite::create(experiment.sensors, geometry, sample_time, experiment.seed);
  if (!sensors) return tl::unexpected(sensors.error());

  const auto samples = static_cast<Index>(std::llround(experiment.schedule.duration() * experiment.rate.value));
  if (samples < 1) return bad_usage("the trial has no samples", "give it a duration");
  Performance result;
  Recording& recording = result.recording;
  recording.time.resize(samples);
  Channels channels(samples, experiment.schedule.quantity());
  MeanImpedance truth;
  for (Index i = 0; i < samples; ++i) {
    const double t = loop->time(), interval = sensors->next_interval();
    const TrueState& state = loop->hold(command->torque(t, sensors->encoders(loop->motor_angle())), interval);
    if (!state.position.allFinite() || !state.force_hand_on_robot.allFinite()) {
      return bad_data(fmt::format("the motion is not finite any more at {:.3f} s", t),
                      "lower the gains, or raise robot.steps_per_tick", "simulation");
    }
    if (auto ok = robot::check_joints(geometry.limits, state.theta); !ok) {
      return bad_data(fmt::format("the hand leaves the workspace at {:.3f} s: {}", t, ok.error().message),
                      "perturb it less, or choose another home", "simulation");
    }
    const SensorSuite::Reading reading = sensors->read(state);
    recording.time[i] = reading.time;
    channels.set(i, reading, command->reference(t));
    result.energy_exchanged += std::abs(state.force_hand_on_robot.dot(state.velocity)) * interval;
    if (i % kTruthTicks == 0) truth.add(load.impedance(experiment.home));
    if (experiment.watch) experiment.watch(state);
    result.energy_absorbed = state.energy.absorbed - 0.5 * experiment.robot.handle_mass * state.velocity.squaredNorm();
    loop->advance();
    if (experiment.progress && i % 1000 == 0) {
      experiment.progress(static_cast<double>(i) / static_cast<double>(samples));
    }
  }
  recording.channels = std::move(channels.channels);
  for (const auto& event : experiment.schedule.events())
    recording.events.push_back({event.time, event.name, event.value});

  result.truth = truth.mean();
  recording.metadata = truth_metadata(result.truth, experiment.rate, result.energy_absorbed);
  recording.metadata["handle_mass_kg"] = exact_text(experiment.robot.handle_mass);
  recording.metadata["truth_force_delay_s"] = exact_text(sensors->force_delay());
  if (sensors->clipped_samples() > 0) {
    recording.metadata["force_samples_clipped"] = std::to_string(sensors->clipped_samples());
  }
  return result;
}

}  // namespace mbk::laboratory
