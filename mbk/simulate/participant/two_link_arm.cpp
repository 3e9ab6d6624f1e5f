#include "mbk/simulate/participant/two_link_arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"

namespace mbk::participant {
namespace {

Result<void> within_reach(const ArmGeometry& geometry, const Vector2d& hand) {
  // A reachable position is reproduced by its joint angles
  const double gap = (hand_position(geometry, joint_angles(geometry, hand)) - hand).norm();
  if (gap < 1e-9) return {};
  return bad_usage(
      fmt::format("the hand at ({:.4g}, {:.4g}) m is {:.4g} m from the shoulder, out of reach of links of "
                  "{:.4g} and {:.4g} m",
                  hand.x(), hand.y(), (hand - geometry.shoulder).norm(), geometry.upper_arm, geometry.forearm),
      "move the shoulder or the hand");
}

Result<void> check(const ArmGeometry& geometry) {
  if (!geometry.shoulder.allFinite() || !std::isfinite(geometry.rotation)) {
    return bad_usage("the position or rotation of the shoulder is not finite");
  }
  return above_zero({{"upper arm", geometry.upper_arm, "m"}, {"forearm", geometry.forearm, "m"}});
}

}  // namespace

Matrix2d ChainInertia::matrix(const Elbow& elbow) const {
  const double coupling = b * elbow.cosine;
  return (Matrix2d() << a + 2.0 * coupling, c + coupling, c + coupling, c).finished();
}

Vector2d ChainInertia::coriolis_torque(const Elbow& elbow, const Vector2d& q_rate) const {
  return b * elbow.sine * Vector2d(-(2.0 * q_rate[0] + q_rate[1]) * q_rate[1], q_rate[0] * q_rate[0]);
}

Result<ChainInertia> ChainInertia::from_matrix(const Matrix2d& I_q, double elbow_angle) {
  if (!I_q.allFinite() || !std::isfinite(elbow_angle)) return bad_usage("the inertia of an arm must be finite");
  if (std::abs(I_q(0, 1) - I_q(1, 0)) > 1e-9 * I_q.norm()) {
    return bad_usage("the joint inertia of an arm must be symmetric");
  }
  const double cosine = std::cos(elbow_angle);
  if (std::abs(cosine) < 0.05) {
    return bad_usage(fmt::format("the inertia at elbow angle {:.3g} rad does not determine that of other postures: "
                                 "|cos q2| = {:.3g} is below 0.05",
                                 elbow_angle, std::abs(cosine)),
                     "give the inertia in a posture with the elbow farther from a right angle");
  }
  ChainInertia chain;
  chain.c = I_q(1, 1);
  chain.b = (I_q(0, 1) - chain.c) / cosine;
  chain.a = I_q(0, 0) - 2.0 * chain.b * cosine;
  double largest_cosine = 0.0;  // |cos q₂| in the range
  for (const double angle : {elbow_angle - kElbowRange, elbow_angle, elbow_angle + kElbowRange}) {
    largest_cosine = std::max(largest_cosine, std::abs(std::cos(angle)));
  }
  // det I = c (a − c) − b² cos² q₂
  if (!(chain.c > 0.0 && chain.c * (chain.a - chain.c) > std::pow(chain.b * largest_cosine, 2))) {
    return bad_usage(fmt::format("the joint inertia gives a, b, c = {:.4g}, {:.4g}, {:.4g} kg·m², which is not "
                                 "positive definite {:.2g} rad of elbow rotation away",
                                 chain.a, chain.b, chain.c, kElbowRange),
                     "make c (a - c) larger than (b cos q2)²");
  }
  return chain;
}

Result<JointParameters> joint_parameters(const ArmGeometry& geometry, const impedance::Model& hand) {
  if (hand.axes() != 2 || hand.M.cols() != 2 || hand.B.rows() != 2 || hand.B.cols() != 2 || hand.K.rows() != 2 ||
      hand.K.cols() != 2 || hand.x0.size() != 2) {
    return bad_usage("the hand of a two-link arm needs 2×2 matrices M, B and K and two coordinates x0");
  }
  if (!impedance::stacked(hand).allFinite()) return bad_usage("M, B, K and x0 of a hand must be finite");
  MBK_TRY(check(geometry));
  const Vector2d x0 = hand.x0;
  MBK_TRY(within_reach(geometry, x0));
  const Vector2d q = joint_angles(geometry, x0);
  const Matrix2d J = jacobian(geometry, q);
  const auto at_joints = [&](const Matrix& at_hand) { return Matrix2d(J.transpose() * at_hand * J); };
  return JointParameters{at_joints(hand.M), q[1], at_joints(hand.B), at_joints(hand.K)};
}

Result<TwoLinkArm> TwoLinkArm::create(const Options& options) {
  MBK_TRY(check(options.geometry));
  if (!options.joints.damping.allFinite() || !options.joints.stiffness.allFinite()) {
    return bad_usage("the joint damping and stiffness of an arm must be finite");
  }
  MBK_TRY(within_reach(options.geometry, options.equilibrium));
  const auto inertia = MBK_TRY(ChainInertia::from_matrix(options.joints.inertia, options.joints.elbow_angle));
  return TwoLinkArm(options, inertia);
}

Vector2d TwoLinkArm::elastic_torque(const Vector2d& q) const {
  return stiffness_scale_ * options_.joints.stiffness * (q - q0_);
}

const TwoLinkArm::AtPlace& TwoLinkArm::at(const Vector2d& hand) const {
  if (last_.hand == hand) return last_;
  last_.hand = hand;
  last_.posture = posture(options_.geometry, hand);
  last_.J_inverse = jacobian(last_.posture.links).inverse();
  last_.inertia = last_.J_inverse.transpose() * inertia_.matrix(last_.posture.elbow) * last_.J_inverse;
  return last_;
}

LoadDynamics<2> TwoLinkArm::dynamics(const HandState<2>& hand) const {
  const auto& [place, posture, J_inverse, inertia] = at(hand.position);
  const Vector2d q_rate = J_inverse * hand.velocity;
  // q̈ = J⁻¹ (ẍ − J̇ q̇)
  const Vector2d torque = inertia_.coriolis_torque(posture.elbow, q_rate) +
                          damping_scale_ * options_.joints.damping * q_rate + elastic_torque(posture.q);
  const Vector2d convective = jacobian_rate(posture.links, q_rate) * q_rate;
  return {inertia, J_inverse.transpose() * torque - inertia * convective, 0.0};
}

Matrix2d TwoLinkArm::stiffness(const Vector2d& hand) const {
  const auto& [place, posture, J_inverse, inertia] = at(hand);
  const Vector2d force_hand_on_robot = -(J_inverse.transpose() * elastic_torque(posture.q));
  return J_inverse.transpose() *
         (stiffness_scale_ * options_.joints.stiffness + force_curvature(posture.links, force_hand_on_robot)) *
         J_inverse;
}

impedance::Model TwoLinkArm::impedance(const Vector2d& hand) const {
  const auto& [place, posture, J_inverse, inertia] = at(hand);
  const Matrix2d K = stiffness(hand);
  const Vector2d bias = J_inverse.transpose() * elastic_torque(posture.q);
  const Eigen::FullPivLU<Matrix2d> solver(K);
  const Vector2d x0 = solver.isInvertible() ? Vector2d(hand - solver.solve(bias)) : Vector2d::Constant(kNaN);
  return {inertia, damping_scale_ * J_inverse.transpose() * options_.joints.damping * J_inverse, K, x0};
}

double TwoLinkArm::kinetic_energy(const HandState<2>& hand) const {
  const AtPlace& now = at(hand.position);
  const Vector2d q_rate = now.J_inverse * hand.velocity;
  return 0.5 * q_rate.dot(inertia_.matrix(now.posture.elbow) * q_rate);
}

double TwoLinkArm::elastic_energy(const Vector2d& hand) const {
  const Vector2d q = joint_angles(options_.geometry, hand);
  return 0.5 * (q - q0_).dot(elastic_torque(q));
}

}  // namespace mbk::participant
