#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::explore {

/// A limb with M, B and K that is displaced on minimum-jerk ramps, with its force in closed form:
///   −F_h = M ẍ + B ẋ + K x + C |x|² x + offset + e
struct RampsOfLimb {
  Matrix M = Matrix{{1.3, -0.9}, {-0.9, 1.9}};
  Matrix B = Matrix{{5.8, -2.1}, {-2.1, 10.6}};
  Matrix K = Matrix{{42.0, -20.0}, {-36.0, 125.0}};
  double cubic = 0.0;        ///< C [N/m³]
  double amplitude = 0.006;  ///< [m]
  double ramp = 0.12;        ///< of the reference [s]
  double hand_ramp = 0.12;   ///< of the hand, which follows [s]
  double follows = 1.0;      ///< share of the displacement that the hand makes
  double hold = 0.5, pause = 1.0;
  int directions = 8, repetitions = 3;
  double first_angle = 0.0;  ///< [rad]
  double noise = 0.0;        ///< of e, standard deviation, 1.5 Hz [N]
  double white = 0.0;        ///< of white noise beside it [N]
  std::uint64_t seed = 1;
};

/// Minimum-jerk path from 0 to 1 and two derivatives by s = t/D, at rest before and after.
inline std::vector<double> minimum_jerk_path(double t, double duration) {
  const double s = t / duration;
  if (s <= 0.0) return {0.0, 0.0, 0.0};
  if (s >= 1.0) return {1.0, 0.0, 0.0};
  return {s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration,
          60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration * duration)};
}

inline ExplorationTrial ramps_of(const RampsOfLimb& limb) {
  constexpr double kT = 0.001;
  const double cycle = limb.pause + limb.ramp + limb.hold + limb.ramp;
  const int ramps = limb.directions * limb.repetitions;
  const auto samples = static_cast<Index>(std::llround((cycle * ramps + limb.pause) / kT));
  numeric::Random random(limb.seed);
  const double pole = std::exp(-2.0 * std::numbers::pi * 1.5 * kT);
  Vector e = Vector::Zero(2);
  for (double& value : e) value = limb.noise * random.normal();
  ExplorationTrial trial;
  trial.sample_time = kT;
  trial.input = trial.output = trial.reference = Matrix::Zero(samples, 2);
  trial.reference_quantity = ReferenceQuantity::position;
  for (const char* const axis : {"x", "y"}) {
    trial.input_labels.push_back({std::string("hand_") + axis, "m"});
    trial.output_labels.push_back({std::string("−force_") + axis, "N"});
  }
  const Vector home{{0.3, -0.05}}, offset{{0.7, -0.4}};
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * kT;
    const int k = std::min(static_cast<int>(t / cycle), ramps - 1);
    const double after = t - cycle * k - limb.pause, back = after - limb.ramp - limb.hold;
    const double angle = limb.first_angle + 2.0 * std::numbers::pi * (k % limb.directions) / limb.directions;
    const Vector direction{{std::cos(angle), std::sin(angle)}};
    const auto along = [&](double duration, int derivative) {
      const auto at = static_cast<std::size_t>(derivative);
      return limb.amplitude * (minimum_jerk_path(after, duration)[at] - minimum_jerk_path(back, duration)[at]);
    };
    const Vector x = limb.follows * along(limb.hand_ramp, 0) * direction,
                 v = limb.follows * along(limb.hand_ramp, 1) * direction,
                 a = limb.follows * along(limb.hand_ramp, 2) * direction;
    for (double& value : e) value = pole * value + std::sqrt(1.0 - pole * pole) * limb.noise * random.normal();
    trial.reference.row(i) = (home + along(limb.ramp, 0) * direction).transpose();
    trial.input.row(i) = (home + x).transpose();
    trial.output.row(i) =
        (limb.M * a + limb.B * v + limb.K * x + limb.cubic * x.squaredNorm() * x + offset + e).transpose();
    for (Index axis = 0; axis < 2; ++axis) trial.output(i, axis) += limb.white * random.normal();
  }
  return trial;
}

}  // namespace mbk::explore
