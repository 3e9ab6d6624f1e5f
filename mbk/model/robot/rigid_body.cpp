#include "mbk/model/robot/rigid_body.h"

namespace mbk::robot {
namespace {

/// ½ tr(I) 1 − I: moments of inertia into second moments of mass, Σ = ∫ r rᵀ dm.
Eigen::Matrix3d second_moments(const Eigen::Matrix3d& inertia) {
  return 0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia;
}

}  // namespace

Eigen::Matrix4d pseudo_inertia(const Eigen::Matrix<double, kCoefficientsPerBody, 1>& coefficients) {
  const auto& c = coefficients;
  Eigen::Matrix3d about_origin;
  about_origin << c[4], c[5], c[6], c[5], c[7], c[8], c[6], c[8], c[9];
  Eigen::Matrix4d J;
  J.topLeftCorner<3, 3>() = second_moments(about_origin);
  J.topRightCorner<3, 1>() = c.segment<3>(1);
  J.bottomLeftCorner<1, 3>() = c.segment<3>(1).transpose();
  J(3, 3) = c[0];
  return J;
}

Eigen::Matrix4d pseudo_inertia(const RigidBody& body) {
  Eigen::Matrix4d J;
  J.topLeftCorner<3, 3>() = second_moments(body.inertia) + body.mass * body.centre * body.centre.transpose();
  J.topRightCorner<3, 1>() = body.mass * body.centre;
  J.bottomLeftCorner<1, 3>() = body.mass * body.centre.transpose();
  J(3, 3) = body.mass;
  return J;
}

RigidBody body_of(const Eigen::Matrix4d& pseudo_inertia) {
  RigidBody body;
  body.mass = pseudo_inertia(3, 3);
  body.centre = pseudo_inertia.topRightCorner<3, 1>() / body.mass;
  const Eigen::Matrix3d about_centre =
      pseudo_inertia.topLeftCorner<3, 3>() - body.mass * body.centre * body.centre.transpose();
  body.inertia = about_centre.trace() * Eigen::Matrix3d::Identity() - about_centre;
  return body;
}

}  // namespace mbk::robot
