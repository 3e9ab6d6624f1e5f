#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/robot/rigid_body.h"
#include "mbk/model/trial/torque_fit.h"

namespace mbk {

/// A link of a robot that can exist. Single numbers of it are one choice of many that move the robot alike.
struct ConsistentBody {
  std::string link;
  robot::RigidBody body;           ///< in the frame of its link
  double smallest_eigenvalue = 0;  ///< of the pseudo-inertia, in SI units; above 0
};

/// What torque and motion decide: a coefficient with what else acts in its place.
struct RobotCombination {
  std::string name, unit;
  std::string together_with;  ///< as RobotCoefficient::together_with
  double value = 0;           ///< of the consistent fit
  double free = 0;            ///< of the free fit
  double standard_error = 0;  ///< of the free fit
};

/// Among the robots that can exist the one that predicts the torques most like the free fit; what the data do not
/// decide is nearest to the bodies of the description. RobotIdentification's parameters are then these.
struct ConsistentRobot {
  std::vector<ConsistentBody> bodies;  ///< where the robot is a chain of rigid bodies
  std::vector<RobotCombination> combinations;
  std::vector<TorqueFit> free_fit;         ///< of each joint, as RobotIdentification::fit
  std::vector<double> vaf_lost;            ///< of each joint, free fit less consistent one, as TorqueFit::vaf [points]
  std::vector<double> vaf_lost_in_sample;  ///< [points]
  double mean_vaf_lost = 0;                ///< mean over the joints whose torque counts [points]
  double loss = 0;  ///< ½ Σ e²/σ² that the conditions add, σ² the variance of the free fit's residual
  double gap = 0;   ///< to which this is known to be the least, in the same unit
  int newton_steps = 0;
  std::vector<std::string> pressing;  ///< the conditions that the data alone would break, strongest first
};

}  // namespace mbk
