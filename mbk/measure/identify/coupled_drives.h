#pragma once

#include <vector>

#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::identify {

/// Tests for drives coupled by gears, as in the last two joints of many wrists: the motor of one joint also turns with
/// the other, and its friction depends on both speeds. The model has no term for this. The residual of joint j, after
/// removing the contribution of its own columns and torque rate, is regressed on the viscous and dry friction of each
/// other joint k and on dry friction of the sum and the difference of both speeds, with standard errors by Newey and
/// West. Adds `missing-dynamics` for the pair that explains most, if one coefficient is 6 standard errors from 0 and
/// the pair explains more than 36 % of the sum of squares of the residual.
void warn_of_coupled_drives(const std::vector<PreparedDynamics>& trials, RobotIdentification& found);

}  // namespace mbk::identify
