#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::validation {

/// An elbow that is stretched by a motor at constant velocities. The resisting torque is inertia, viscosity, an
/// elasticity that rises exponentially with the angle, an offset, and in a spastic limb a stretch reflex
///   G (θ − (λ − μ θ')) where positive and θ' > 0, late by `delay`, through two lags of `muscle` seconds.
struct StretchedLimb {
  double inertia = 0.06;                ///< [kg·m²]
  double viscosity = 0.15;              ///< [N·m·s/rad]
  double viscosity_rise = 0.0;          ///< share by which it is larger at the end of the stretch than at its start
  double elasticity = 1.0;              ///< elastic torque at the end of the range [N·m]
  double offset = 0.0;                  ///< [N·m]
  double gain = 0.0;                    ///< G [N·m/rad]
  double threshold = 115.0 * kDegree;   ///< λ [rad]
  double threshold_shift = 0.2;         ///< μ [s]
  double delay = 0.04, muscle = 0.015;  ///< [s]
};

struct StretchProtocol {
  std::vector<double> speeds = {20.0 * kDegree, 60.0 * kDegree, 100.0 * kDegree, 140.0 * kDegree, 180.0 * kDegree};
  int repetitions = 5;
  double from = 60.0 * kDegree, to = 150.0 * kDegree;  ///< [rad]
  double acceleration = 20.0;                          ///< [rad/s²]
  double rate = 500.0;                                 ///< [Hz]
  double rest = 0.2;                                   ///< before each movement [s]
};

/// Spread of the limb and noise of the machine.
struct StretchNoise {
  double threshold = 1.5 * kDegree;  ///< of λ between stretches
  double gain = 0.1;                 ///< of ln G between stretches
  double level = 0.05;               ///< of the torque between stretches [N·m]
  double drift = 0.1;                ///< low-passed at 1.5 Hz: a relaxed human and ripple of the motor [N·m]
  double sensor = 0.05;              ///< white [N·m]
  double angle = 0.01 * kDegree;     ///< white, of the encoder [rad]
};

/// A relaxed limb without a reflex, and one with a reflex whose threshold is within the range.
[[nodiscard]] StretchedLimb healthy_limb(std::uint64_t seed);
[[nodiscard]] StretchedLimb spastic_limb(std::uint64_t seed);

/// One recording: for each repetition and speed a rest, the stretch, a rest and the return at the same speed.
[[nodiscard]] ExplorationTrial stretched(const StretchedLimb& limb, const StretchProtocol& protocol,
                                         const StretchNoise& noise, std::uint64_t seed);

/// Its motion and EMG, raw, of modulated noise: emg_biceps, whose amplitude is a background of 5 µV and 1 mV by the
/// activation, which is the drive of the reflex over 60 N·m, late by `delay`; and emg_triceps, relaxed, the background.
struct StretchesWithEmg {
  ExplorationTrial trial;
  Recording recording;
};
[[nodiscard]] StretchesWithEmg stretched_with_emg(const StretchedLimb& limb, const StretchProtocol& protocol,
                                                  const StretchNoise& noise, std::uint64_t seed);

/// The same as stretched() without noise, with thresholds at equally likely quantiles of their spread instead of
/// repetitions, and with the mean gain: what repetitions without number would show on average.
[[nodiscard]] ExplorationTrial stretched_on_average(const StretchedLimb& limb, StretchProtocol protocol,
                                                    const StretchNoise& noise);

}  // namespace mbk::validation
