#include "mbk/model/robot_file/planar_keys.h"

#include "mbk/model/robot/workspace.h"

namespace mbk::robot_file {

using config::above;
using config::at_least;
using Eigen::Vector2d;

robot::PlanarRobot read_planar_robot(const config::Section& s) {
  robot::PlanarRobot robot;
  robot.geometry.d1 = s.number("d1_mm", robot.geometry.d1, above(0));
  robot.geometry.d2 = s.number("d2_mm", robot.geometry.d2, above(0));
  const std::vector<double> alpha =
      s.numbers("alpha_kg_m2", {robot.inertia.alpha1, robot.inertia.alpha2, robot.inertia.alpha3}, config::any(), 3);
  robot.inertia = {alpha[0], alpha[1], alpha[2]};
  constexpr double kRounding = 1e-9;
  if (alpha[0] < 0.0 || alpha[2] < 0.0 || alpha[1] * alpha[1] > (4.0 + kRounding) * alpha[0] * alpha[2]) {
    s.reject("alpha_kg_m2", "this inertia is physically impossible for two links",
             "make the first and third non-negative, and the second at most twice the square root of their product");
  }

  robot::JointLimits& limits = robot.geometry.limits;
  const auto range = [&](const char* key, double& low, double& high) {
    const Vector2d both = s.vector2(key, {low, high});
    if (!(both[0] < both[1])) s.reject(key, "the first value is not below the second", "write [low, high]");
    low = both[0];
    high = both[1];
  };
  range("theta1_deg", limits.theta1_low, limits.theta1_high);
  range("theta2_deg", limits.theta2_low, limits.theta2_high);
  limits.smallest_opening = s.number("smallest_opening_deg", limits.smallest_opening);
  if (robot::joint_space_corners(limits).size() < 3) {
    s.reject("smallest_opening_deg", "the joint limits leave no workspace",
             "check the sign and unit of theta1_deg, theta2_deg and smallest_opening_deg");
    limits = {};
  }

  const auto both = [&](const char* key, double robot::JointFriction::*part, config::Range allowed) {
    const Vector2d value = s.vector2(key, Vector2d(robot.friction[0].*part, robot.friction[1].*part), allowed);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      robot.friction[joint].*part = value[static_cast<Eigen::Index>(joint)];
    }
  };
  both("viscous_Nms_per_rad", &robot::JointFriction::viscous, at_least(0));
  both("coulomb_Nm", &robot::JointFriction::coulomb, at_least(0));
  both("breakaway_Nm", &robot::JointFriction::breakaway, at_least(0));
  both("stribeck_velocity_rad_per_s", &robot::JointFriction::stribeck_velocity, above(0));
  both("smoothing_rad_per_s", &robot::JointFriction::smoothing, above(0));
  return robot;
}

}  // namespace mbk::robot_file
