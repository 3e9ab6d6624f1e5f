#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// One reach of a hand, from rest to rest.
struct Reach {
  double begin_s = 0, end_s = 0;          ///< from the recording's first sample [s]
  double sparc = 0;                       ///< spectral arc length of the speed; nearer to 0 is smoother
  double ldlj = 0;                        ///< log dimensionless jerk; larger is smoother
  int peaks = 0;                          ///< of the speed
  double mean_speed = 0, peak_speed = 0;  ///< [m/s or rad/s]
  double path = 0;                        ///< path length [m or rad]
  double distance = 0;                    ///< straight distance from start to end [m or rad]
  std::optional<double> path_ratio;       ///< path/distance ≥ 1; absent if start and end coincide
  std::optional<double> endpoint_error;   ///< distance from the target, the reference at its end [m or rad]
  std::optional<double> robot_work;       ///< −∫ F_h·dx, done by the robot on the hand [J]
  std::optional<double> force_angle;      ///< mean angle of F_h to the direction of motion [rad]; two axes
};

/// Reaches found in one recording.
struct MovementQuality {
  SourceFile source;
  int axes = 2;
  Motion motion = Motion::translation;
  double rate_hz = 0, from_s = 0, to_s = 0;
  double cutoff_hz = 0;   ///< of the filter before the speed
  double rest_speed = 0;  ///< speed below which the hand is at rest [m/s or rad/s]
  std::vector<Reach> reaches;
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
};

}  // namespace mbk
