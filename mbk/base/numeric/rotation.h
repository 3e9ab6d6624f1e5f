#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mbk::numeric {

/// [a]×: [a]× u = a × u.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  return (Eigen::Matrix3d() << 0.0, -a[2], a[1], a[2], 0.0, -a[0], -a[1], a[0], 0.0).finished();
}

/// exp [r]×: the rotation about r by |r| [rad].
[[nodiscard]] inline Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& r) {
  const double angle = r.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, r / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

}  // namespace mbk::numeric
