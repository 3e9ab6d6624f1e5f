#include "mbk/model/robot/dynamic_model.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mbk::robot {
namespace {

/// A motion in pieces that stay in the cache: work(first sample, piece).
template <class Work>
void in_pieces(const JointMotion& motion, Work&& work) {
  constexpr Index kPiece = 1024;
  for (Index first = 0; first < motion.samples(); first += kPiece) {
    const Index samples = std::min(kPiece, motion.samples() - first);
    work(first, JointMotion{motion.position.middleRows(first, samples), motion.velocity.middleRows(first, samples),
                            motion.acceleration.middleRows(first, samples)});
  }
}

}  // namespace

std::vector<Coefficient> DynamicModel::coefficients() const {
  std::vector<Coefficient> all = mechanism->coefficients();
  for (Coefficient& one : drive.coefficients(*mechanism)) all.push_back(std::move(one));
  return all;
}

std::vector<PhysicalCondition> DynamicModel::physical_conditions() const {
  const std::vector<PhysicalCondition> of_drives = drive.physical_conditions(*mechanism);
  const Index all = bodies() + mechanism->joints() * drive.per_joint();
  std::vector<PhysicalCondition> conditions = mechanism->physical_conditions();
  for (PhysicalCondition& one : conditions) {
    one.A.conservativeResizeLike(Matrix::Zero(one.A.rows(), all));
  }
  for (const PhysicalCondition& one : of_drives) {
    conditions.push_back({one.name, Matrix::Zero(one.A.rows(), all)});
    conditions.back().A.rightCols(one.A.cols()) = one.A;
  }
  return conditions;
}

std::vector<Matrix> DynamicModel::regressors(const JointMotion& motion) const {
  const Index terms = drive.per_joint(), n = mechanism->joints();
  std::vector<Matrix> W(static_cast<std::size_t>(n));
  for (Matrix& of_joint : W) of_joint.setZero(motion.samples(), bodies() + n * terms);
  in_pieces(motion, [&](Index first, const JointMotion& piece) {
    const std::vector<Matrix> Y = mechanism->regressors(piece);
    for (Index joint = 0; joint < n; ++joint) {
      auto rows = W[static_cast<std::size_t>(joint)].middleRows(first, piece.samples());
      rows.leftCols(bodies()) = Y[static_cast<std::size_t>(joint)];
      drive.regressors(piece.position.col(joint), piece.velocity.col(joint), piece.acceleration.col(joint),
                       rows.middleCols(bodies() + joint * terms, terms));
    }
  });
  return W;
}

Matrix DynamicModel::torques(const JointMotion& motion) const {
  const Index terms = drive.per_joint();
  Matrix torque(motion.samples(), mechanism->joints());
  in_pieces(motion, [&](Index first, const JointMotion& piece) {
    const std::vector<Matrix> Y = mechanism->regressors(piece);
    Matrix D(piece.samples(), terms);
    for (Index joint = 0; joint < torque.cols(); ++joint) {
      drive.regressors(piece.position.col(joint), piece.velocity.col(joint), piece.acceleration.col(joint), D);
      auto of_joint = torque.col(joint).segment(first, piece.samples());
      of_joint.noalias() = Y[static_cast<std::size_t>(joint)] * parameters.head(bodies());
      of_joint.noalias() += D * parameters.segment(bodies() + joint * terms, terms);
    }
  });
  return torque;
}

JointVector DynamicModel::drive_torque(const JointVector& position, const JointVector& velocity,
                                       const JointVector& acceleration) const {
  const Index terms = drive.per_joint();
  constexpr Index kMaxTerms = 6;
  Eigen::Matrix<double, kMaxTerms, 1> row;
  JointVector torque(position.size());
  for (Index joint = 0; joint < position.size(); ++joint) {
    drive.regressor(position[joint], velocity[joint], acceleration[joint], row.data());
    torque[joint] = row.head(terms).dot(parameters.segment(bodies() + joint * terms, terms));
  }
  return torque;
}

namespace {

double volume(const HandJacobian& J) {
  const HandMatrix gram = J * J.transpose();
  return std::sqrt(std::max(0.0, gram.rows() == 1 ? gram(0, 0) : gram.determinant()));
}

/// J without what a push across its axes would do to the joints, too, as far as the joints distinguish the two.
/// @param told  in how many directions across they do
HandJacobian apart_from_across(const HandJacobian& J, HandJacobian across, Index& told) {
  constexpr double kNoMotion = 1e-6, kLeft = 0.1;
  const double whole = volume(J), length = J.norm();
  HandJacobian apart = J;
  told = 0;
  for (Index k = 0; k < across.rows(); ++k) {
    for (Index before = 0; before < told; ++before) {
      across.row(k) -= across.row(k).dot(across.row(before)) * across.row(before).eval();
    }
    const double size = across.row(k).norm();
    if (!(size > kNoMotion * length)) continue;
    const Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxJoints> direction = across.row(k) / size;
    HandJacobian without = apart;
    for (Index row = 0; row < apart.rows(); ++row) without.row(row) -= apart.row(row).dot(direction) * direction;
    if (!(volume(without) > kLeft * whole)) continue;
    apart = without;
    across.row(told++) = direction;
  }
  return apart;
}

}  // namespace

Index told_across(const Mechanism& mechanism, const JointVector& position) {
  Index told = 0;
  apart_from_across(mechanism.jacobian(position), mechanism.jacobian_across(position), told);
  return told;
}

std::optional<HandJacobian> regular_hand_from_joints(const Mechanism& mechanism, const JointVector& position) noexcept {
  constexpr double kSmallestRatio = 1e-3;
  Index told = 0;
  const HandJacobian J = apart_from_across(mechanism.jacobian(position), mechanism.jacobian_across(position), told);
  const HandMatrix gram = J * J.transpose();
  if (gram.rows() == 1) {
    if (!(gram(0, 0) > 0.0)) return std::nullopt;
    return HandJacobian(J / gram(0, 0));
  }
  if (gram.rows() == 3) {
    const Eigen::Matrix3d square = gram;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares;
    squares.computeDirect(square, Eigen::EigenvaluesOnly);
    const Eigen::Vector3d values = squares.eigenvalues();
    if (!(values[0] > kSmallestRatio * kSmallestRatio * values[2])) return std::nullopt;
    return HandJacobian(square.inverse() * J);
  }
  // Squares of the singular values, from trace and determinant.
  const double half = 0.5 * gram.trace(), det = gram.determinant();
  const double largest = half + std::sqrt(std::max(0.0, half * half - det));
  if (!(det > kSmallestRatio * kSmallestRatio * largest * largest)) return std::nullopt;
  HandMatrix inverse(2, 2);
  inverse << gram(1, 1), -gram(0, 1), -gram(1, 0), gram(0, 0);
  return HandJacobian(inverse / det * J);
}

Result<HandJacobian> hand_from_joints(const Mechanism& mechanism, const JointVector& position) {
  if (const auto regular = regular_hand_from_joints(mechanism, position)) return *regular;
  std::string joints;
  for (Index k = 0; k < position.size(); ++k) {
    joints += fmt::format("{}{:.4g}", joints.empty() ? "" : ", ", position[k]);
  }
  return bad_data(fmt::format("the configuration is singular: with the joints at [{}] no motor torque can balance a "
                              "force along one direction of the hand",
                              joints),
                  "choose a window or a test location away from it");
}

}  // namespace mbk::robot
