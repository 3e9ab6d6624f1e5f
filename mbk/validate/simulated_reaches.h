#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/servo_displacement.h"

namespace mbk::validation {

/// A hand that reaches for one target again and again, each time a little differently: the undisturbed way is a
/// minimum-jerk path x_d of its own duration, length, bend and lateral drift. The robot is free but for its inertia
/// m_r, so that undisturbed F_h = m_r ẍ_d. Where a servo takes the hand elsewhere, with the drive of the muscles
/// unchanged,
///   F_h = m_r ẍ_d − M (ẍ − ẍ_d) − B (ẋ − ẋ_d) − K (x − x_d) + e
struct SimulatedReaches {
  Matrix M = Matrix{{1.33, -0.93}, {-0.93, 1.88}};
  Matrix B = Matrix{{12.0, -4.0}, {-4.0, 20.0}};
  Matrix K = Matrix{{150.0, -55.0}, {-75.0, 330.0}};      ///< stiffer than at rest
  double robot_mass = 0.5;                                ///< m_r [kg]
  double distance = 0.25;                                 ///< along +y [m]
  double duration = 0.6;                                  ///< [s]
  double duration_spread = 0.06, distance_spread = 0.05;  ///< standard deviations, relative
  double bend = 0.006;                                    ///< standard deviation of the lateral bend [m]
  double drift = 0.006;                                   ///< and of the lateral place of the target [m]
  double noise = 0.3;                                     ///< of e, standard deviation, 1.5 Hz [N]
  double trigger = 0.08;                                  ///< the way after which the hand is displaced [m]
  double amplitude = 0.008;                               ///< of the displacement [m]
  double out = 0.1, hold = 0.1, back = 0.1;               ///< of the displacement [s]
  int undisturbed = 40;
  int directions = 8, repetitions = 10;
};

struct ReachesOfOneRun {
  std::vector<explore::RecordedReach> undisturbed;
  std::vector<explore::DisplacedReach> displaced;
  double sample_time = 0.001;  ///< [s]
};

/// Undisturbed reaches, then displaced ones in all directions: the servo follows the prediction that ReachPrediction
/// makes of the undisturbed ones and the reach's own past, and adds the displacement.
/// @fails  as explore::ReachPrediction
[[nodiscard]] Result<ReachesOfOneRun> simulate_reaches(const SimulatedReaches& hand, std::uint64_t seed);

}  // namespace mbk::validation
