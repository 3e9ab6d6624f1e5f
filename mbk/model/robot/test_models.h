#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/planar_mechanism.h"

namespace mbk::robot {

/// φ of a planar robot.
inline Vector coefficients_of(const Inertia& inertia) {
  return Eigen::Vector3d(inertia.alpha1, inertia.alpha2, inertia.alpha3);
}

/// The same robot in both descriptions: the viscous friction and, where there are any, the dry parts of both joints.
inline DynamicModel model_of(const PlanarRobot& robot) {
  DynamicModel model{std::make_shared<PlanarMechanism>(PlanarMechanism::Options{robot.geometry, {}, {}}),
                     {.stribeck = true, .offset = false}};
  model.parameters.resize(9);
  model.parameters.head(3) = coefficients_of(robot.inertia);
  for (Index joint = 0; joint < 2; ++joint) {
    const JointFriction& friction = robot.friction[static_cast<std::size_t>(joint)];
    model.parameters.segment(3 + 3 * joint, 3) << friction.viscous, friction.coulomb,
        std::max(0.0, friction.breakaway - friction.coulomb);
  }
  return model;
}

/// An arm of three joints in a vertical plane, each turned against the link before it, with a point mass at the end of
/// each link: more joints than its hand has axes, and no closed form of its terms.
class ThreePointMasses : public Mechanism {
 public:
  [[nodiscard]] int joints() const override { return 3; }
  [[nodiscard]] bool slides(int /*joint*/) const override { return false; }
  [[nodiscard]] int hand_axes() const override { return 2; }
  [[nodiscard]] JointRange joint_range(int /*joint*/) const override { return {-3.0, 3.0}; }
  [[nodiscard]] const std::vector<Coefficient>& coefficients() const override { return coefficients_; }

  /// Of mass k: J_kᵀ (J_k q̈ + J̇_k q̇ + [0, g]).
  void regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                 Eigen::Ref<Matrix> Y) const override {
    for (int mass = 0; mass < 3; ++mass) {
      const HandJacobian J = of_mass(mass, position);
      const Vector2d up(0.0, 9.81);
      Y.col(mass) = J.transpose() * (J * acceleration + rate_of_mass(mass, position, velocity) * velocity + up);
    }
  }

  [[nodiscard]] HandVector hand_position(const JointVector& position) const override {
    Vector2d hand = Vector2d::Zero();
    for (int link = 0; link < 3; ++link) hand += kLength[link] * direction(position.head(link + 1).sum());
    return hand;
  }
  [[nodiscard]] HandJacobian jacobian(const JointVector& position) const override { return of_mass(2, position); }
  [[nodiscard]] HandJacobian jacobian_rate(const JointVector& position, const JointVector& velocity) const override {
    return rate_of_mass(2, position, velocity);
  }
  [[nodiscard]] Result<void> check_joints(const JointVector& /*position*/) const override { return {}; }
  [[nodiscard]] std::vector<JointVector> postures(int /*per_joint*/) const override { return {}; }

 private:
  static constexpr double kLength[3] = {0.3, 0.25, 0.2};  // [m]

  static Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

  static HandJacobian of_mass(int mass, const JointVector& position) {
    HandJacobian J = HandJacobian::Zero(2, 3);
    for (int link = 0; link <= mass; ++link) {
      const Vector2d d = direction(position.head(link + 1).sum());
      for (int joint = 0; joint <= link; ++joint) J.col(joint) += kLength[link] * Vector2d(-d.y(), d.x());
    }
    return J;
  }

  static HandJacobian rate_of_mass(int mass, const JointVector& position, const JointVector& velocity) {
    HandJacobian rate = HandJacobian::Zero(2, 3);
    for (int link = 0; link <= mass; ++link) {
      const Vector2d d = direction(position.head(link + 1).sum());
      for (int joint = 0; joint <= link; ++joint) rate.col(joint) -= kLength[link] * velocity.head(link + 1).sum() * d;
    }
    return rate;
  }

  std::vector<Coefficient> coefficients_ = {{"mass_1", "kg"}, {"mass_2", "kg"}, {"mass_3", "kg"}};
};

/// Sines of each joint about a place in the workspace, and their derivatives.
struct Swing {
  double amplitude = 0.2;  // [rad]

  [[nodiscard]] Vector2d position(double t) const {
    return {0.4 + amplitude * std::sin(kOmega[0] * t), 0.9 + amplitude * std::sin(kOmega[1] * t)};
  }
  [[nodiscard]] Vector2d velocity(double t) const {
    return {amplitude * kOmega[0] * std::cos(kOmega[0] * t), amplitude * kOmega[1] * std::cos(kOmega[1] * t)};
  }
  [[nodiscard]] Vector2d acceleration(double t) const {
    return {-amplitude * kOmega[0] * kOmega[0] * std::sin(kOmega[0] * t),
            -amplitude * kOmega[1] * kOmega[1] * std::sin(kOmega[1] * t)};
  }
  /// At 0, T, 2T, …
  [[nodiscard]] JointMotion sampled(Index samples, double sample_time) const {
    JointMotion motion{Matrix(samples, 2), Matrix(samples, 2), Matrix(samples, 2)};
    for (Index i = 0; i < samples; ++i) {
      const double t = sample_time * static_cast<double>(i);
      motion.position.row(i) = position(t).transpose();
      motion.velocity.row(i) = velocity(t).transpose();
      motion.acceleration.row(i) = acceleration(t).transpose();
    }
    return motion;
  }

 private:
  static constexpr double kOmega[2] = {9.0, 13.0};  // [rad/s]
};

}  // namespace mbk::robot
