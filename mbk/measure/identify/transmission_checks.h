#pragma once

#include <vector>

#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::identify {

/// Between motor and link, a drive of stiffness k with a gap g turns by δ = s/k + ½ g sgn(s) under the torque s that it
/// transmits. The motor's inertia J and the link's inertia M are then not one:
///   τ − W θ = −M δ̈ where the encoder sits on the motor,  +J δ̈ where it sits on the link
/// to first order in δ (Spong 1987; Nordin & Gutman 2002), so that the residual goes with s̈ where the drive is elastic,
/// and with d²/dt² sgn(s), pulses at each reversal of s, where it has a gap. s is what the bodies take, Σ W_k φ_k. Each
/// joint's torque is regressed on its own columns of W, its rate (a delay, damping), on friction that grows with the
/// square of the velocity or near standstill, and on these; standard errors by Newey & West. Noise of the motion makes
/// the first column of W θ positive, noise of the torque makes that of τ negative (E[n n̈] = −E[ṅ²]), so that either
/// column counts only where both ways of making it agree. A gap is closed some time after the torque turns; of five
/// such times, slower reversals later, that which explains most. Each column's `found` says whether it is there beyond
/// chance and matters; of two alike, the one that explains more.
/// @param trials  as fitted, at the delay of `found`, which gets one test for each joint
void test_transmission(const std::vector<PreparedDynamics>& trials, RobotIdentification& found);

/// Adds `elastic-drive` and `backlash` for what was found, where the model explains 80 % of the joint's torque (of the
/// held-out data): the residual of a model that fits worse is not that of a drive. A resonance within the band of the
/// motion is not reported, because the column of an elastic drive holds only below it.
void warn_of_transmission(RobotIdentification& found);

}  // namespace mbk::identify
