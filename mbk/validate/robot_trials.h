#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/trial/robot_identification.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::validation {

/// What is left of a robot's friction in a model: all that the laboratory's robot has and an offset (the default of
/// `mbk robot identify`), viscous friction alone (Dyck 2013, A.6), or none.
enum class FrictionModel { full, viscous, none };

[[nodiscard]] robot::DriveTerms drive_terms(FrictionModel friction);

/// White noise of the measured motor currents, times the torque constant [N·m].
inline constexpr double kTorqueNoise = 0.005;

/// The sensors of these studies: those of the scenario, but torques from motor currents with kTorqueNoise.
void measure_currents(laboratory::Scenario& scenario);

/// The robot of a planar scenario.
[[nodiscard]] laboratory::PlanarTrial& planar(laboratory::Scenario& scenario);

/// The ready scenario free_motion with the phases and the noise of that seed, on a rigid or an elastic drive.
/// @fails  as simulate
[[nodiscard]] Result<Recording> free_motion(std::uint64_t seed, const std::optional<robot::Capstan>& capstan = {});

/// Its robot: the parameters that free_motion should give, in the order of its coefficients.
/// @fails  as `ready`
[[nodiscard]] Result<Vector> true_parameters(FrictionModel friction);

/// As `mbk robot identify` does by default: weighted least squares, the delay found too.
/// @fails  as measurement::identify_robot
[[nodiscard]] Result<RobotIdentification> identified_robot(
    const Recording& recording, FrictionModel friction,
    robot::PlanarMechanism::Coriolis coriolis = robot::PlanarMechanism::Coriolis::skew);

}  // namespace mbk::validation
