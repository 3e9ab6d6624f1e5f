#pragma once

#include <vector>

#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::identify {

/// Drives that gears couple, as those of the last two joints of many wrists: the motor of one joint turns with the
/// other too, and its friction depends on both speeds. The model has no term for it. The residual of joint j, less what
/// its own columns and torque rate explain, is regressed on the viscous and dry friction of each other joint k and on
/// dry friction of the sum and the difference of both speeds, with standard errors by Newey and West. Adds
/// `missing-dynamics` for the pair that explains most, where one of them is 6 standard errors from 0 and they explain
/// over 36 % of the residual's squares.
void warn_of_coupled_drives(const std::vector<PreparedDynamics>& trials, RobotIdentification& found);

}  // namespace mbk::identify
