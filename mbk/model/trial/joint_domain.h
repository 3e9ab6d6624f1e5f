#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/findings.h"

namespace mbk {

/// The impedance at the hand in coordinates of two joints: of the person's arm (shoulder, elbow against the upper arm)
/// or of the robot (both against the base). Joints are counted counter-clockwise, seen from above.
struct JointDomain {
  ArmPosture posture;                ///< posture for which it is valid, with three points
  Eigen::Vector2d angles;            ///< of the first link from x, and of the second as its joint has it [rad]
  Eigen::Matrix2d jacobian;          ///< of the hand by the joints [m]
  Matrix M, B, K;                    ///< 2×2 [kg·m²], [N·m·s/rad], [N·m/rad]
  Vector bias_force;                 ///< that the hand exerts on the robot at rest there, base frame [N]
  Matrix covariance;                 ///< of M, B, K by rows and the bias force, 14 square; the posture is assumed known
  Matrix M_error, B_error, K_error;  ///< standard errors, shaped like M, B, K
  Vector bias_force_error;           ///< [N]
  double m_a = 0, k_a = 0;           ///< antisymmetric parts of M and K, det(J) times those at the hand
  Interval m_a95, k_a95;
};

}  // namespace mbk
