#include "mbk/model/impedance/joint_impedance.h"

namespace mbk::impedance {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Vector2d quarter_turn(const Vector2d& v) {
  return {-v.y(), v.x()};
}

constexpr Index kForce = 12, kEquilibrium = 12;  ///< rows and columns of a gradient that F and x₀ begin

}  // namespace

JointMap two_link_map(const Vector2d& shoulder, const Vector2d& elbow, const Vector2d& hand, ElbowAngle angle) {
  const bool relative = angle == ElbowAngle::first_link;
  const Vector2d last = hand - elbow;
  const Vector2d first = relative ? hand - shoulder : elbow - shoulder;
  JointMap map;
  map.jacobian << quarter_turn(first), quarter_turn(last);
  for (Index k = 0; k < 2; ++k) {
    const double cross = relative ? -last[k] : 0.0;
    map.curvature[static_cast<std::size_t>(k)] << -first[k], cross, cross, -last[k];
  }
  return map;
}

JointImpedance joint_impedance(const Model& hand, const JointMap& joints, const Vector2d& place) {
  const Matrix2d& J = joints.jacobian;
  const auto at_joints = [&](const Matrix& at_hand) { return Matrix(J.transpose() * at_hand * J); };
  const Vector2d displacement = place - Vector2d(hand.x0);
  JointImpedance result;
  result.M = at_joints(hand.M);
  result.B = at_joints(hand.B);
  result.K = at_joints(hand.K);
  result.bias_force = -(hand.K * displacement);
  for (Index k = 0; k < 2; ++k) result.K -= result.bias_force[k] * joints.curvature[static_cast<std::size_t>(k)];

  result.gradient = Matrix::Zero(14, 14);
  for (Index part = 0; part < 3; ++part) {
    for (Index i = 0; i < 2; ++i) {
      for (Index j = 0; j < 2; ++j) {
        for (Index a = 0; a < 2; ++a) {
          for (Index b = 0; b < 2; ++b) result.gradient(4 * part + 2 * i + j, 4 * part + 2 * a + b) = J(a, i) * J(b, j);
        }
      }
    }
  }
  auto of_force = result.gradient.bottomRows(2);
  for (Index k = 0; k < 2; ++k) {
    of_force.block<1, 2>(k, 8 + 2 * k) = -displacement.transpose();
    of_force.block<1, 2>(k, kEquilibrium) = hand.K.row(k);
  }
  for (Index i = 0; i < 2; ++i) {
    for (Index j = 0; j < 2; ++j) {
      for (Index k = 0; k < 2; ++k) {
        result.gradient.row(8 + 2 * i + j) -=
            joints.curvature[static_cast<std::size_t>(k)](i, j) * result.gradient.row(kForce + k);
      }
    }
  }
  return result;
}

}  // namespace mbk::impedance
