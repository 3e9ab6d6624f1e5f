#include "mbk/validate/simulated_stretches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::validation {
namespace simulated_stretch {

constexpr double kDriftHz = 1.5;
constexpr int kQuantiles = 9;
constexpr std::uint32_t kLimb = 71, kSpread = 72, kDrift = 73, kSensor = 74, kEncoder = 75, kEmg = 76;
constexpr double kEmgLargest = 1e-3, kEmgBackground = 5e-6;  ///< [V]
constexpr double kLargestTorque = 60.0;                      ///< [N·m]

struct Sampled {
  std::vector<double> position, velocity, acceleration;
  std::vector<double> threshold, gain, level;  ///< of the limb, by sample
};

/// A rest and a movement with trapezoidal velocity; the limb is as given.
void move(Sampled& motion, double from, double to, double speed, const StretchProtocol& protocol, double threshold,
          double gain, double level) {
  const double way = std::abs(to - from), sign = to > from ? 1.0 : -1.0, a = protocol.acceleration;
  const double ramp = speed / a, duration = way / speed + ramp;
  const auto samples = static_cast<int>(std::lround((protocol.rest + duration) * protocol.rate));
  for (int i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / protocol.rate - protocol.rest;
    double x = 0.0, v = 0.0, acceleration = 0.0;
    if (t >= 0.0 && t < ramp) {
      x = 0.5 * a * t * t, v = a * t, acceleration = a;
    } else if (t >= ramp && t < duration - ramp) {
      x = 0.5 * speed * ramp + speed * (t - ramp), v = speed;
    } else if (t >= duration - ramp) {
      const double left = std::max(duration - t, 0.0);
      x = way - 0.5 * a * left * left, v = a * left, acceleration = left > 0.0 ? -a : 0.0;
    }
    motion.position.push_back(from + sign * x);
    motion.velocity.push_back(sign * v);
    motion.acceleration.push_back(sign * acceleration);
    motion.threshold.push_back(threshold);
    motion.gain.push_back(gain);
    motion.level.push_back(level);
  }
}

/// Torque of the reflex before the muscle.
std::vector<double> reflex_drive(const StretchedLimb& limb, const StretchProtocol& protocol, const Sampled& motion) {
  const auto late = static_cast<std::size_t>(std::lround(limb.delay * protocol.rate));
  std::vector<double> drive(motion.position.size(), 0.0);
  for (std::size_t k = late; k < drive.size(); ++k) {
    const std::size_t then = k - late;
    const double v = motion.velocity[then];
    if (v <= 0.0) continue;
    const double beyond = motion.position[then] - motion.threshold[then] + limb.threshold_shift * v;
    drive[k] = motion.gain[then] * std::max(beyond, 0.0);
  }
  return drive;
}

ExplorationTrial recorded(const StretchedLimb& limb, const StretchProtocol& protocol, const Sampled& motion) {
  const auto n = static_cast<Index>(motion.position.size());
  ExplorationTrial trial;
  trial.axes = 1;
  trial.motion = mbk::Motion::rotation;
  trial.sample_time = 1.0 / protocol.rate;
  trial.input.resize(n, 1);
  trial.output.resize(n, 1);
  trial.split = n;
  const double lag = std::exp(-trial.sample_time / limb.muscle);
  const std::vector<double> drive = reflex_drive(limb, protocol, motion);
  double first = 0.0, second = 0.0;
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double x = motion.position[k], v = motion.velocity[k];
    first = lag * first + (1.0 - lag) * drive[k];
    second = lag * second + (1.0 - lag) * first;
    const double along = (x - protocol.from) / (protocol.to - protocol.from);
    trial.input(i, 0) = x;
    trial.output(i, 0) = limb.inertia * motion.acceleration[k] +
                         limb.viscosity * (1.0 + limb.viscosity_rise * along) * v +
                         limb.elasticity * std::exp((x - protocol.to) / 0.4) + limb.offset + motion.level[k] + second;
  }
  return trial;
}

StretchedLimb limb_of(std::uint64_t seed) {
  numeric::Random random(seed, kLimb);
  StretchedLimb limb;
  limb.viscosity = random.uniform(0.05, 0.3);
  limb.elasticity = random.uniform(0.5, 2.0);
  limb.offset = 0.3 * random.normal();
  limb.gain = random.uniform(3.0, 10.0);
  limb.threshold = random.uniform(110.0, 125.0) * kDegree;
  limb.threshold_shift = random.uniform(0.1, 0.25);
  limb.delay = random.uniform(0.03, 0.05);
  return limb;
}

/// Movements of a limb that varies between stretches.
Sampled varied_motion(const StretchedLimb& limb, const StretchProtocol& protocol, const StretchNoise& noise,
                      std::uint64_t seed) {
  numeric::Random spread(seed, kSpread);
  Sampled motion;
  for (int repetition = 0; repetition < protocol.repetitions; ++repetition) {
    for (const double speed : protocol.speeds) {
      const double threshold = limb.threshold + noise.threshold * spread.normal();
      const double gain = limb.gain * std::exp(noise.gain * spread.normal()), level = noise.level * spread.normal();
      move(motion, protocol.from, protocol.to, speed, protocol, threshold, gain, level);
      move(motion, protocol.to, protocol.from, speed, protocol, threshold, gain, level);
    }
  }
  return motion;
}

ExplorationTrial measured(const StretchedLimb& limb, const StretchProtocol& protocol, const StretchNoise& noise,
                          const Sampled& motion, std::uint64_t seed) {
  numeric::Random drift(seed, kDrift), sensor(seed, kSensor), encoder(seed, kEncoder);
  ExplorationTrial trial = recorded(limb, protocol, motion);
  const double keep = std::exp(-2.0 * std::numbers::pi * kDriftHz * trial.sample_time);
  double slow = noise.drift * drift.normal();
  for (Index i = 0; i < trial.samples(); ++i) {
    trial.output(i, 0) += slow + noise.sensor * sensor.normal();
    trial.input(i, 0) += noise.angle * encoder.normal();
    slow = keep * slow + noise.drift * std::sqrt(1.0 - keep * keep) * drift.normal();
  }
  return trial;
}

}  // namespace simulated_stretch

StretchedLimb healthy_limb(std::uint64_t seed) {
  StretchedLimb limb = simulated_stretch::limb_of(seed);
  limb.gain = 0.0;
  return limb;
}

StretchedLimb spastic_limb(std::uint64_t seed) {
  return simulated_stretch::limb_of(seed);
}

ExplorationTrial stretched(const StretchedLimb& limb, const StretchProtocol& protocol, const StretchNoise& noise,
                           std::uint64_t seed) {
  using namespace simulated_stretch;
  return measured(limb, protocol, noise, varied_motion(limb, protocol, noise, seed), seed);
}

StretchesWithEmg stretched_with_emg(const StretchedLimb& limb, const StretchProtocol& protocol,
                                    const StretchNoise& noise, std::uint64_t seed) {
  using namespace simulated_stretch;
  const Sampled motion = varied_motion(limb, protocol, noise, seed);
  StretchesWithEmg all{measured(limb, protocol, noise, motion, seed), {}};
  const std::vector<double> drive = reflex_drive(limb, protocol, motion);
  numeric::Random random(seed, kEmg);
  const Index n = all.trial.samples();
  Vector biceps(n), triceps(n);
  all.recording.time.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double activation = drive[static_cast<std::size_t>(i)] / kLargestTorque;
    biceps[i] = (kEmgBackground + kEmgLargest * activation) * random.normal();
    triceps[i] = kEmgBackground * random.normal();
    all.recording.time[i] = static_cast<double>(i) / protocol.rate;
  }
  all.recording.channels = {Channel{"emg_biceps", "V", "", biceps}, Channel{"emg_triceps", "V", "", triceps}};
  return all;
}

ExplorationTrial stretched_on_average(const StretchedLimb& limb, StretchProtocol protocol, const StretchNoise& noise) {
  using namespace simulated_stretch;
  Sampled motion;
  const double gain = limb.gain * std::exp(0.5 * noise.gain * noise.gain);
  for (int quantile = 0; quantile < kQuantiles; ++quantile) {
    const double z = numeric::normal_quantile((quantile + 0.5) / kQuantiles);
    for (const double speed : protocol.speeds) {
      const double threshold = limb.threshold + noise.threshold * z;
      move(motion, protocol.from, protocol.to, speed, protocol, threshold, gain, 0.0);
      move(motion, protocol.to, protocol.from, speed, protocol, threshold, gain, 0.0);
    }
  }
  return recorded(limb, protocol, motion);
}

}  // namespace mbk::validation
