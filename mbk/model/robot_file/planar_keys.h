#pragma once

#include "mbk/base/config/document.h"
#include "mbk/model/robot/dynamics.h"

namespace mbk::robot_file {

/// A planar robot from the keys of [robot] that robot descriptions and simulated trials share; defaults are those of
/// the thesis:
///   d1_mm, d2_mm; alpha_kg_m2 = [α₁, α₂, α₃]; theta1_deg = [low, high], theta2_deg, smallest_opening_deg;
///   for each joint viscous_Nms_per_rad, coulomb_Nm, breakaway_Nm, stribeck_velocity_rad_per_s, smoothing_rad_per_s
[[nodiscard]] robot::PlanarRobot read_planar_robot(const config::Section& section);

}  // namespace mbk::robot_file
