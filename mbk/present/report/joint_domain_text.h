#pragma once

#include <string>

#include "mbk/model/trial/joint_domain.h"

namespace mbk::report {

/// The impedance at the joints, with intervals, and in which posture it holds.
[[nodiscard]] std::string joint_domain_text(const JointDomain& joints);

}  // namespace mbk::report
