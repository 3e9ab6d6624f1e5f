#pragma once

#include "mbk/model/trial/joint_domain.h"
#include "mbk/present/result/json_parts.h"

/// For the sources of this module only.
namespace mbk::result {

/// Object `joint_domain` of a result: posture, M, B and K of the joints with standard errors and covariance.
[[nodiscard]] Json joint_domain_json(const JointDomain& joints);

}  // namespace mbk::result
