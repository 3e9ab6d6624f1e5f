#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/robot/rigid_body.h"
#include "mbk/model/trial/torque_fit.h"

namespace mbk {

/// A link of a physically possible robot. Its individual values are one of many choices with identical robot motion.
struct ConsistentBody {
  std::string link;
  robot::RigidBody body;           ///< in the frame of its link
  double smallest_eigenvalue = 0;  ///< of the pseudo-inertia, in SI units; above 0
};

/// An identifiable combination: a coefficient with others that have the same effect.
struct RobotCombination {
  std::string name, unit;
  std::string together_with;  ///< as RobotCoefficient::together_with
  double value = 0;           ///< of the consistent fit
  double free = 0;            ///< of the free fit
  double standard_error = 0;  ///< of the free fit
};

/// The physically possible robot whose torque prediction is closest to the free fit; what the data do not determine is
/// closest to the bodies of the description. RobotIdentification then has these parameters.
struct ConsistentRobot {
  std::vector<ConsistentBody> bodies;  ///< if the robot is a chain of rigid bodies
  std::vector<RobotCombination> combinations;
  std::vector<TorqueFit> free_fit;         ///< of each joint, as RobotIdentification::fit
  std::vector<double> vaf_lost;            ///< of each joint, free fit less consistent one, as TorqueFit::vaf [points]
  std::vector<double> vaf_lost_in_sample;  ///< [points]
  double mean_vaf_lost = 0;                ///< mean over the joints with a relevant torque [points]
  double loss = 0;  ///< increase of ½ Σ e²/σ² by the conditions, σ² the variance of the free-fit residual
  double gap = 0;   ///< optimality tolerance, in the same unit
  int newton_steps = 0;
  std::vector<std::string> pressing;  ///< the conditions that the data alone would violate, strongest first
};

}  // namespace mbk
