#include "mbk/measure/analyse/analyse_joint_domain.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/joint_impedance.h"

namespace mbk::analyse {
namespace {

using Eigen::Vector2d;

double angle_of(const Vector2d& link) {
  return std::atan2(link.y(), link.x());
}

/// Angles of both links as the joints of `of` count them.
Vector2d joint_angles(const ArmPosture& posture) {
  const double first = angle_of(posture.points[1] - posture.points[0]);
  const double last = angle_of(posture.points[2] - posture.points[1]);
  if (posture.of == ArmPosture::Of::arm) return {first, std::remainder(last - first, 2.0 * std::numbers::pi)};
  // θ₂ turns the robot's last link from the −y axis (Dyck 2013, fig. A.1)
  return {first, std::remainder(last + 0.5 * std::numbers::pi, 2.0 * std::numbers::pi)};
}

}  // namespace

Result<JointDomain> analyse_joint_domain(const Identification& identification, const ArmPosture& posture) {
  if (identification.axes != 2) {
    return bad_data(identification.axes == 1 ? "a result with one axis is already in the joint domain"
                                             : "the joint domain is that of a planar arm, not of three axes",
                    "use a result with two axes");
  }
  if (posture.of == ArmPosture::Of::hand || posture.points.size() != 3) {
    return bad_data(fmt::format("the posture of the arm is not known{}",
                                posture.note.empty() ? "" : fmt::format(" ({})", posture.note)),
                    "give shoulder position and arm lengths with --arm X,Y,UPPER,FORE in metres");
  }
  const Vector2d &shoulder = posture.points[0], &elbow = posture.points[1], &hand = posture.points[2];
  const bool of_arm = posture.of == ArmPosture::Of::arm;
  const impedance::JointMap map = impedance::two_link_map(
      shoulder, elbow, hand, of_arm ? impedance::ElbowAngle::first_link : impedance::ElbowAngle::base);
  const impedance::JointImpedance at_joints = impedance::joint_impedance(identification.model, map, hand);

  JointDomain found;
  found.posture = posture;
  found.angles = joint_angles(posture);
  found.jacobian = map.jacobian;
  found.M = at_joints.M;
  found.B = at_joints.B;
  found.K = at_joints.K;
  found.bias_force = at_joints.bias_force;
  found.covariance = at_joints.gradient * identification.covariance * at_joints.gradient.transpose();
  const Vector variances = found.covariance.diagonal();
  const Vector errors = variances.unaryExpr([](double v) { return v < 0.0 ? 0.0 : std::sqrt(v); });  // NaN stays NaN
  const auto square = [&](Index part) { return Matrix(errors.segment(4 * part, 4).reshaped(2, 2).transpose()); };
  found.M_error = square(0);
  found.B_error = square(1);
  found.K_error = square(2);
  found.bias_force_error = errors.tail(2);
  const auto antisymmetric95 = [&](double value, Index part) {
    const Eigen::Matrix2d block = found.covariance.block<2, 2>(4 * part + 1, 4 * part + 1);
    const double variance = 0.25 * (block(0, 0) + block(1, 1) - 2.0 * block(0, 1));
    return numeric::interval95(value, variance < 0.0 ? 0.0 : std::sqrt(variance));
  };
  found.m_a = impedance::antisymmetric_part(found.M);
  found.k_a = impedance::antisymmetric_part(found.K);
  found.m_a95 = antisymmetric95(found.m_a, 0);
  found.k_a95 = antisymmetric95(found.k_a, 2);
  return found;
}

}  // namespace mbk::analyse
