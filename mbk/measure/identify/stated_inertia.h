#pragma once

#include <vector>

#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::identify {

/// Compares the torque of each joint with what the masses and inertias of the URDF make of the motion:
///   τ_j = r_j Y_j φ_stated + D_j ψ_j + e_j
/// with the joint's own drive terms ψ_j free, by least squares; standard errors by Newey and West. Rotors whose inertia
/// is stated belong to the first term. A torque constant or gear ratio that is 15 % wrong gives r_j = 1.15.
/// Adds `torque-unit` for a joint whose torque is r_j times what the URDF gives: r_j is 5 % and 4.5 standard errors
/// from 1, and with it the URDF misses at most half as much (root mean square, beyond what `found` misses) as without.
/// One factor that fits all joints is named as one. Does nothing where the URDF states no mass for some body.
/// @param trials  as fitted, at the delay of `found`    @param stated  the robot as its description has it
void compare_with_stated(const std::vector<PreparedDynamics>& trials, const robot::DynamicModel& stated,
                         RobotIdentification& found);

}  // namespace mbk::identify
