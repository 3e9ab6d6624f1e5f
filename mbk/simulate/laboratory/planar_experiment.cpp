#include "mbk/simulate/laboratory/planar_experiment.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mbk/model/robot/workspace.h"
#include "mbk/simulate/laboratory/truth_text.h"

namespace mbk::laboratory {
namespace {

using perturbation::Quantity;

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
  const robot::Geometry& geometry = experiment.robot.robot.geometry;
  auto command =
      control::TrialControl::create(experiment.control, experiment.schedule, geometry, experiment.home, sample_time);
  if (!command) return tl::unexpected(command.error());
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
