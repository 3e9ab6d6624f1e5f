#include "mbk/present/result/joint_domain_json.h"

#include <Eigen/LU>
#include <numbers>

#include "mbk/model/trial/identification.h"

namespace mbk::result {

Json joint_domain_json(const JointDomain& joints) {
  const bool of_arm = joints.posture.of == ArmPosture::Of::arm;
  const Units units = units_of(Motion::rotation);
  const auto antisymmetric = [](double value, const Interval& value95) {
    return Json{{"value", number(value)}, {"value_interval95", interval(value95)}};
  };
  Json points = Json::array();
  for (const Eigen::Vector2d& point : joints.posture.points) points.push_back(list(point));
  return {
      {"of", word_of(joints.posture.of)},
      {"second_joint_against", of_arm ? "first link" : "base"},
      {"points_m", std::move(points)},
      {"joint_angles_deg", list(180.0 / std::numbers::pi * joints.angles)},
      {"jacobian_m", rows(joints.jacobian)},
      {"determinant_m2", number(joints.jacobian.determinant())},
      {"units", {{"M", units.inertia}, {"B", units.damping}, {"K", units.stiffness}}},
      {"model", {{"M", rows(joints.M)}, {"B", rows(joints.B)}, {"K", rows(joints.K)}}},
      {"standard_error", {{"M", rows(joints.M_error)}, {"B", rows(joints.B_error)}, {"K", rows(joints.K_error)}}},
      {"bias_force_N", list(joints.bias_force)},
      {"bias_force_standard_error_N", list(joints.bias_force_error)},
      {"antisymmetry",
       {{"inertia", antisymmetric(joints.m_a, joints.m_a95)}, {"stiffness", antisymmetric(joints.k_a, joints.k_a95)}}},
      {"covariance",
       {{"parameters",
         {"m_11", "m_12", "m_21", "m_22", "b_11", "b_12", "b_21", "b_22", "k_11", "k_12", "k_21", "k_22", "F_x",
          "F_y"}},
        {"matrix", rows(joints.covariance)}}}};
}

}  // namespace mbk::result
