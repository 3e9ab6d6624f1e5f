#include "mbk/simulate/laboratory/simulated_experiment.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "mbk/base/core/requester.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/simulate/laboratory/truth_text.h"

namespace mbk::laboratory {
namespace {

using perturbation::Quantity;

/// The true values are sampled every N ticks.
constexpr Index kTruthTicks = 100;

/// And every N ticks on the plateau of a displacement.
constexpr Index kPlateauTicks = 10;

/// Average of what an arm is while it tenses and relaxes.
class MeanImpedance {
 public:
  void add(const impedance::Model& model) {
    const Vector row = impedance::stacked(model);
    sum_ = count_ == 0 ? row : Vector(sum_ + row);
    axes_ = model.axes();
    ++count_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] impedance::Model mean() const { return impedance::unstacked(sum_ / count_, axes_); }

 private:
  Vector sum_;
  Index axes_ = 0;
  double count_ = 0;
};

/// The load's impedance where the hand is as it moves: M and B as at rest there, and K the slope of the force that the
/// hand exerts against its place, at its velocity and acceleration,
///   K = ∂/∂x [Λ(x) ẍ + h(x, ẋ)]
/// by central differences. Of a linear limb that is its K; of one with joints it holds how inertia and damping at the
/// hand change with place, as any measurement on a hand that moves does.
impedance::Model impedance_in_motion(const participant::Load<2>& load, const TrueState<2>& state) {
  constexpr double kStep = 1e-4;  // m
  const auto force = [&](const Vector2d& place) -> Vector2d {
    const auto dynamics = load.dynamics({place, state.velocity, state.theta[1], state.theta_rate[1]});
    return dynamics.inertia * state.acceleration + dynamics.bias;
  };
  impedance::Model model = load.impedance(state.position);
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2d step = kStep * Vector2d::Unit(axis);
    model.K.col(axis) = (force(state.position + step) - force(state.position - step)) / (2.0 * kStep);
  }
  return model;
}

/// Collects the true values during the trial.
template <int Axes>
class Truth {
 public:
  explicit Truth(const AxisVector<Axes>& home) : home_(home) {}

  void add(Index tick, const participant::Load<Axes>& load, const TrueState<Axes>& /*state*/,
           const OneAxisControl& /*command*/) {
    if (tick % kTruthTicks == 0) at_home_.add(load.impedance(home_));
  }

  /// Where hands that reach are displaced, that of the plateaus counts.
  void add(Index tick, const participant::Load<Axes>& load, const TrueState<Axes>& state,
           const control::TrialControl& command) {
    if (tick % kTruthTicks == 0) at_home_.add(load.impedance(home_));
    if constexpr (Axes == 2) {
      const control::ReachServo* const reaches = command.reaches();
      if (reaches != nullptr && reaches->holding() && tick % kPlateauTicks == 0) {
        displaced_.add(impedance_in_motion(load, state));
      }
    }
  }

  [[nodiscard]] impedance::Model mean() const { return displaced_.empty() ? at_home_.mean() : displaced_.mean(); }

 private:
  AxisVector<Axes> home_;
  MeanImpedance at_home_, displaced_;
};

/// One sample of the recording.
template <int Axes>
struct Sample : SensorSuite<Axes>::Reading {
  AxisVector<Axes> reference;
};

/// The channels of one quantity, one for each axis.
template <int Axes>
struct ChannelGroup {
  std::array<const char*, Axes> names;
  const char* unit;
  const char* frame;
  AxisVector<Axes> Sample<Axes>::*values;
};

/// In the order of the recording.
std::vector<ChannelGroup<1>> groups(const Experiment<1>& experiment) {
  using S = Sample<1>;
  const char* reference_unit = experiment.schedule.quantity() == Quantity::force ? "N.m" : "rad";
  return {{{"position"}, "rad", "joint", &S::joint},
          {{"reaction"}, "N.m", "joint", &S::force},
          {{"reference"}, reference_unit, "joint", &S::reference},
          {{"acceleration"}, "rad/s2", "joint", &S::acceleration}};
}

std::vector<ChannelGroup<2>> groups(const Experiment<2>& experiment) {
  using S = Sample<2>;
  const char* reference_unit = experiment.schedule.quantity() == Quantity::force ? "N" : "m";
  return {{{"hand_x", "hand_y"}, "m", "base", &S::hand},
          {{"joint_1", "joint_2"}, "rad", "joint", &S::joint},
          {{"force_x", "force_y"}, "N", "base", &S::force},
          {{"reference_x", "reference_y"}, reference_unit, "base", &S::reference},
          {{"torque_1", "torque_2"}, "N.m", "joint", &S::torque},
          {{"acceleration_x", "acceleration_y"}, "m/s2", "base", &S::acceleration}};
}

/// The channels of the recording, filled sample by sample.
template <int Axes>
class Channels {
 public:
  Channels(std::vector<ChannelGroup<Axes>> groups, Index samples) : groups_(std::move(groups)) {
    for (const ChannelGroup<Axes>& group : groups_) {
      for (const char* name : group.names) channels.push_back({name, group.unit, group.frame, Vector(samples)});
    }
  }

  void set(Index i, const Sample<Axes>& sample) {
    std::size_t next = 0;
    for (const ChannelGroup<Axes>& group : groups_) {
      for (const double value : sample.*group.values) channels[next++].values[i] = value;
    }
  }

  std::vector<Channel> channels;

 private:
  std::vector<ChannelGroup<Axes>> groups_;
};

/// Whether the joints are where they can be. A robot of one axis has no limits.
Result<void> check_joints(const robot::OneAxisGeometry& /*none*/, const AxisVector<1>& /*theta*/) {
  return {};
}

Result<void> check_joints(const robot::Geometry& geometry, const AxisVector<2>& theta) {
  return robot::check_joints(geometry.limits, theta);
}

/// Metadata of the apparatus; none with one axis.
void add_apparatus(const Experiment<1>& /*experiment*/, const SensorSuite<1>& /*sensors*/, Recording& /*recording*/) {}

void add_apparatus(const Experiment<2>& experiment, const SensorSuite<2>& sensors, Recording& recording) {
  recording.metadata["handle_mass_kg"] = exact_text(experiment.robot.handle_mass);
  recording.metadata["truth_force_delay_s"] = exact_text(sensors.force_delay());
  if (sensors.clipped_samples() > 0) {
    recording.metadata["force_samples_clipped"] = std::to_string(sensors.clipped_samples());
  }
}

}  // namespace

template <int Axes>
Result<Performance> perform(const Experiment<Axes>& experiment, participant::Load<Axes>& load) {
  using Control = std::conditional_t<Axes == 1, OneAxisControl, control::TrialControl>;
  if (!(experiment.rate.value > 0.0 && std::isfinite(experiment.rate.value))) {
    return bad_usage(fmt::format("sample rate {:g} Hz is not positive", experiment.rate.value));
  }
  const double sample_time = 1.0 / experiment.rate.value;
  const GeometryOf<Axes>& geometry = experiment.robot.robot.geometry;
  auto command =
      MBK_TRY(Control::create(experiment.control, experiment.schedule, geometry, experiment.home, sample_time));
  auto loop = MBK_TRY(ClosedLoop<Axes>::create(experiment.robot, experiment.home, load, sample_time));
  auto sensors = MBK_TRY(SensorSuite<Axes>::create(experiment.sensors, geometry, sample_time, experiment.seed));

  const auto samples = static_cast<Index>(std::llround(experiment.schedule.duration() * experiment.rate.value));
  if (samples < 1) return bad_usage("the trial has no samples", "give it a duration");
  Performance result;
  Recording& recording = result.recording;
  recording.time.resize(samples);
  Channels<Axes> channels(groups(experiment), samples);
  Truth<Axes> truth(experiment.home);
  for (Index i = 0; i < samples; ++i) {
    const double t = loop.time(), interval = sensors.next_interval();
    const TrueState<Axes>& state = loop.hold(command.torque(t, sensors.encoders(loop.motor_angle())), interval);
    if (!state.position.allFinite() || !state.force_hand_on_robot.allFinite()) {
      return bad_data(fmt::format("the motion is no longer finite at {:.3f} s", t),
                      "lower the gains, or raise robot.steps_per_tick", "simulation");
    }
    if (auto ok = check_joints(geometry, state.theta); !ok) {
      return bad_data(fmt::format("the hand leaves the workspace at {:.3f} s: {}", t, ok.error().message),
                      "reduce the perturbation, or choose another home", "simulation");
    }
    const Sample<Axes> sample = {sensors.read(state), command.reference(t)};
    recording.time[i] = sample.time;
    channels.set(i, sample);
    result.energy_exchanged += std::abs(state.force_hand_on_robot.dot(state.velocity)) * interval;
    truth.add(i, load, state, command);
    if constexpr (Axes == 2) {
      if (command.reaches() != nullptr && command.reaches()->triggered()) {
        recording.events.push_back({sample.time, "trigger", 0.0});
      }
    }
    if (experiment.watch) experiment.watch(state);
    result.energy_absorbed = state.energy.absorbed - 0.5 * experiment.robot.handle_mass * state.velocity.squaredNorm();
    loop.advance();
    if (i % 1000 == 0) {
      stop_if_cancelled();
      if (experiment.progress) experiment.progress(static_cast<double>(i) / static_cast<double>(samples));
    }
  }
  recording.channels = std::move(channels.channels);
  for (const auto& event : experiment.schedule.events())
    recording.events.push_back({event.time, event.name, event.value});

  result.truth = truth.mean();
  recording.metadata = truth_metadata(result.truth, experiment.rate, result.energy_absorbed);
  add_apparatus(experiment, sensors, recording);
  return result;
}

template Result<Performance> perform(const Experiment<1>& experiment, participant::Load<1>& load);
template Result<Performance> perform(const Experiment<2>& experiment, participant::Load<2>& load);

}  // namespace mbk::laboratory
