#include "mbk/simulate/participant/elbow_joint.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

/// Streams of the seed: one for each muscle.
constexpr std::uint32_t kMuscleStream = 300;

std::int64_t whole_samples(double time, double sample_time) {
  return std::llround(time / sample_time);
}

/// How far the muscle is stretched beyond its threshold [rad].
double beyond_threshold(const StretchedMuscle& muscle, double direction, double angle, double shift) {
  return muscle.threshold ? std::max(0.0, direction * (angle - *muscle.threshold - shift)) : 0.0;
}

Result<void> check_muscle(const StretchedMuscle& m) {
  MBK_TRY(above_zero({{"largest torque of a muscle", m.largest_torque, "N·m"}}));
  MBK_TRY(not_negative({{"background activation", m.background, ""},
                        {"spread of the reflex threshold", m.threshold_spread, "rad"},
                        {"velocity gain of the reflex", m.velocity_gain, "s"},
                        {"gain of the reflex", m.gain, "N·m/rad"},
                        {"latency of the reflex", m.latency, "s"}}));
  MBK_TRY(finite({{"threshold of the reflex", m.threshold.value_or(0.0), "rad"}}));
  for (const StretchResponse& r : m.responses) {
    MBK_TRY(above_zero({{"duration of a response", r.duration, "s"}, {"trigger speed", r.trigger_speed, "rad/s"}}));
    MBK_TRY(not_negative({{"latency of a response", r.latency, "s"},
                          {"activation of a response", r.activation, ""},
                          {"spread of a response", r.spread, ""}}));
  }
  return {};
}

}  // namespace

ElbowJoint::Delay::Delay(double time, double sample_time, double value)
    : values_(static_cast<std::size_t>(whole_samples(time, sample_time)) + 1, value) {}

double ElbowJoint::Delay::step(double value) {
  values_[next_] = value;
  next_ = (next_ + 1) % values_.size();  // now the oldest
  return values_[next_];
}

ElbowJoint::State::State(const StretchedMuscle& options, const Options& elbow, double u, double home,
                         double sample_time, numeric::Random draws)
    : muscle(options),
      direction(u),
      memory(std::exp(-sample_time / elbow.activation_time)),
      random(draws),
      reflex(options.latency, sample_time, beyond_threshold(options, u, home, 0.0)),
      bursts(options.responses.size()),
      first_lag(std::min(
          1.0, options.background + options.gain / options.largest_torque * beyond_threshold(options, u, home, 0.0))),
      second_lag(first_lag),
      contraction(elbow.electromechanical_delay, sample_time, first_lag) {}

double ElbowJoint::State::activation(const perturbation::Jet<double>& joint, std::int64_t sample, double sample_time) {
  const double speed = direction * joint.first;
  if (speed > 0.0 && !lengthening) {  // a stretch begins
    started = sample;
    if (muscle.threshold_spread > 0.0) threshold_shift = muscle.threshold_spread * random.normal();
    for (Burst& burst : bursts) burst.pending = true;
  }
  lengthening = speed > 0.0;
  const double beyond =
      beyond_threshold(muscle, direction, joint.value + muscle.velocity_gain * joint.first, threshold_shift);
  double a = muscle.background + muscle.gain / muscle.largest_torque * reflex.step(beyond);
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    Burst& burst = bursts[i];
    const StretchResponse& response = muscle.responses[i];
    if (burst.pending && lengthening && speed >= response.trigger_speed) {
      burst.from = started + whole_samples(response.latency, sample_time);
      burst.to = burst.from + std::max<std::int64_t>(1, whole_samples(response.duration, sample_time));
      burst.activation = response.activation;
      if (response.spread > 0.0) burst.activation *= std::max(0.0, 1.0 + response.spread * random.normal());
      burst.pending = false;
    }
    if (sample >= burst.from && sample < burst.to) a += burst.activation;
  }
  return std::min(1.0, a);
}

double ElbowJoint::State::torque(double activation) {
  const double excited = contraction.step(activation);
  first_lag = excited + memory * (first_lag - excited);
  second_lag = first_lag + memory * (second_lag - first_lag);
  return muscle.largest_torque * second_lag;
}

Result<ElbowJoint> ElbowJoint::create(const Options& options, double home, double sample_time) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"},
                      {"inertia of the elbow", options.inertia, "kg·m²"},
                      {"time constant of activation", options.activation_time, "s"}}));
  MBK_TRY(not_negative({{"viscosity of the elbow", options.viscosity, "N·m·s/rad"},
                        {"stiffness of the elbow", options.stiffness, "N·m/rad"},
                        {"moment of the weight", options.weight, "N·m"},
                        {"electromechanical delay", options.electromechanical_delay, "s"}}));
  MBK_TRY(finite({{"home", home, "rad"},
                  {"resting angle of the elbow", options.rest, "rad"},
                  {"angle at which the forearm is horizontal", options.horizontal, "rad"}}));
  for (const StretchedMuscle& muscle : options.muscles) MBK_TRY(check_muscle(muscle));
  return ElbowJoint(options, home, sample_time);
}

ElbowJoint::ElbowJoint(const Options& options, double home, double sample_time)
    : options_(options),
      sample_time_(sample_time),
      muscles_{State(options.muscles[flexor], options, 1.0, home, sample_time,
                     numeric::Random(options.seed, kMuscleStream + flexor)),
               State(options.muscles[extensor], options, -1.0, home, sample_time,
                     numeric::Random(options.seed, kMuscleStream + extensor))} {}

ElbowJoint::Output ElbowJoint::step(const perturbation::Jet<double>& joint) {
  Output output;
  const Options& o = options_;
  output.torque = -(o.inertia * joint.second + o.viscosity * joint.first + o.stiffness * (joint.value - o.rest)) +
                  o.weight * std::cos(joint.value - o.horizontal);
  for (const Muscle which : {flexor, extensor}) {
    State& muscle = muscles_[which];
    output.activation[which] = muscle.activation(joint, sample_, sample_time_);
    output.torque -= muscle.direction * muscle.torque(output.activation[which]);
  }
  ++sample_;
  return output;
}

impedance::Model ElbowJoint::impedance() const {
  const auto one = [](double value) { return Matrix::Constant(1, 1, value); };
  return {one(options_.inertia), one(options_.viscosity), one(options_.stiffness), Vector::Constant(1, options_.rest)};
}

}  // namespace mbk::participant
