#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/joint_domain.h"

namespace mbk::analyse {

/// A result in joint coordinates (impedance/joint_domain.h): joints of the person's arm or, if the posture is that of
/// the robot, of the robot. Standard errors by the delta method from the covariance of the parameters; they do not
/// include the uncertainty of the posture.
/// @fails  one axis; only the hand position is known (the error contains the note of the posture).
[[nodiscard]] Result<JointDomain> analyse_joint_domain(const Identification& identification, const ArmPosture& posture);

}  // namespace mbk::analyse
