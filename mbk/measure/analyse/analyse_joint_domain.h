#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/joint_domain.h"

namespace mbk::analyse {

/// A result as the joints of a posture have it (impedance/joint_domain.h): those of the person's arm, or where the
/// posture is the robot's, those of the robot. Standard errors by the delta method from the covariance of the
/// parameters; what is unsure of the posture is not in them.
/// @fails  one axis; the posture is that of the hand alone (its note is said).
[[nodiscard]] Result<JointDomain> analyse_joint_domain(const Identification& identification, const ArmPosture& posture);

}  // namespace mbk::analyse
