#pragma once

#include <cstdint>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::validation {

/// A limb whose force is known in closed form for a motion that is prescribed:
///   −F_h = M ẍ + B ẋ + K x + G r(t) + D l(t) + C x³ + e(t)
/// with r the answer of ω²/(s² + 2ζωs + ω²) to max(eᵀẋ, 0) after a delay, l the same answer to eᵀẋ itself.
struct SimulatedLimb {
  Matrix M, B, K;           ///< n×n
  Vector direction;         ///< e, n, unit vector
  Vector reflex_gain;       ///< G, n [N·s/m]
  Vector linear_gain;       ///< D, n [N·s/m]
  double delay = 0.06;      ///< [s]
  double natural = 20.0;    ///< ω [rad/s]
  double damping = 1.0;     ///< ζ
  double cubic = 0.0;       ///< C [N/m³]
  double noise = 0.3;       ///< standard deviation of e [N], first-order low-pass at 1.5 Hz
  double white = 0.03;      ///< of white noise beside it [N]
  double amplitude = 0.02;  ///< of the random binary sequence behind the motion [m]
  double bandwidth = 15.0;  ///< of its four equal poles [Hz]
};

/// One record: a random binary sequence for each axis through four equal poles, so that motion and its derivatives are
/// exact, and the force that answers it. The same for the same seed.
[[nodiscard]] ExplorationTrial simulate_limb(const SimulatedLimb& limb, double duration_s, double rate_hz,
                                             std::uint64_t seed);

}  // namespace mbk::validation
