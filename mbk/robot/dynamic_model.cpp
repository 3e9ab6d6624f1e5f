#include "mbk/robot/dynamic_model.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

namespace mbk::robot {

std::vector<Coefficient> DynamicModel::coefficients() const {
  std::vector<Coefficient> all = mechanism->coefficients();
  for (Coefficient& one : drive.coefficients(*mechanism)) all.push_back(std::move(one));
  return all;
}

std::vector<Matrix> DynamicModel::regressors(const JointMotion& motion) const {
  std::vector<Matrix> W = mechanism->regressors(motion);
  const Index terms = drive.per_joint(), n = mechanism->joints();
  std::vector<double> row(static_cast<std::size_t>(terms));
  for (Index joint = 0; joint < n; ++joint) {
    Matrix& of_joint = W[static_cast<std::size_t>(joint)];
    of_joint.conservativeResize(Eigen::NoChange, bodies() + n * terms);
    of_joint.rightCols(n * terms).setZero();
    const Index first = bodies() + joint * terms;
    for (Index i = 0; i < motion.samples(); ++i) {
      drive.regressor(motion.position(i, joint), motion.velocity(i, joint), motion.acceleration(i, joint), row.data());
      for (Index k = 0; k < terms; ++k) of_joint(i, first + k) = row[static_cast<std::size_t>(k)];
    }
  }
  return W;
}

Matrix DynamicModel::torques(const JointMotion& motion) const {
  const std::vector<Matrix> Y = mechanism->regressors(motion);
  const Vector phi = parameters.head(bodies());
  Matrix torque(motion.samples(), mechanism->joints());
  for (Index joint = 0; joint < torque.cols(); ++joint) torque.col(joint) = Y[static_cast<std::size_t>(joint)] * phi;
  for (Index i = 0; i < torque.rows(); ++i) {
    torque.row(i) += drive_torque(motion.position.row(i).transpose(), motion.velocity.row(i).transpose(),
                                  motion.acceleration.row(i).transpose())
                         .transpose();
  }
  return torque;
}

JointVector DynamicModel::drive_torque(const JointVector& position, const JointVector& velocity,
                                       const JointVector& acceleration) const {
  const Index terms = drive.per_joint();
  constexpr Index kMostTerms = 6;
  Eigen::Matrix<double, kMostTerms, 1> row;
  JointVector torque(position.size());
  for (Index joint = 0; joint < position.size(); ++joint) {
    drive.regressor(position[joint], velocity[joint], acceleration[joint], row.data());
    torque[joint] = row.head(terms).dot(parameters.segment(bodies() + joint * terms, terms));
  }
  return torque;
}

Result<HandJacobian> hand_from_joints(const Mechanism& mechanism, const JointVector& position) {
  const HandJacobian J = mechanism.jacobian(position);
  constexpr double kSmallestRatio = 1e-3;
  const auto singular = [&] {
    std::string joints;
    for (Index k = 0; k < position.size(); ++k) {
      joints += fmt::format("{}{:.4g}", joints.empty() ? "" : ", ", position[k]);
    }
    return bad_data(fmt::format("a singular configuration: with the joints at [{}] no torque of the motors answers a "
                                "force along one direction of the hand",
                                joints),
                    "choose a window or a test location away from it");
  };
  using HandMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2, 2>;
  const HandMatrix gram = J * J.transpose();
  if (gram.rows() == 1) {
    if (!(gram(0, 0) > 0.0)) return singular();
    return HandJacobian(J / gram(0, 0));
  }
  // Squares of the singular values, from trace and determinant.
  const double half = 0.5 * gram.trace(), det = gram.determinant();
  const double largest = half + std::sqrt(std::max(0.0, half * half - det));
  if (!(det > kSmallestRatio * kSmallestRatio * largest * largest)) return singular();
  HandMatrix inverse(2, 2);
  inverse << gram(1, 1), -gram(0, 1), -gram(1, 0), gram(0, 0);
  return HandJacobian(inverse / det * J);
}

}  // namespace mbk::robot
