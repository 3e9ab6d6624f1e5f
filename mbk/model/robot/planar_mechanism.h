#pragma once

#include <optional>

#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// The bodies of the thesis's robot, and of any with the same linkage: φ = [α₁ α₂ α₃] of (A.6) and, where the plane is
/// not horizontal, [γ₁ γ₂] with the potential energy γ₁ cos(θ₁ − φ_u) + γ₂ sin(θ₂ − φ_u), φ_u the direction that is up.
class PlanarMechanism : public Mechanism {
 public:
  /// Which lower-left entry of C is used.
  enum class Coriolis {
    skew,     ///< −½ α₂ cos(θ₁ − θ₂) θ̇₁: İ − 2C is skew-symmetric, so that energy is conserved
    printed,  ///< +½ α₂ cos(θ₁ − θ₂) θ̇₁, as printed in (A.6); for comparison only
  };
  struct Options {
    Geometry geometry;
    std::optional<double> up;  ///< φ_u, from +x [rad]; absent: the plane is horizontal
    Coriolis coriolis = Coriolis::skew;
  };
  explicit PlanarMechanism(const Options& options);

  [[nodiscard]] int joints() const override { return 2; }
  [[nodiscard]] JointRange joint_range(int joint) const override;
  [[nodiscard]] bool slides(int /*joint*/) const override { return false; }
  [[nodiscard]] int hand_axes() const override { return 2; }
  [[nodiscard]] const std::vector<Coefficient>& coefficients() const override { return coefficients_; }
  /// [α₁ ½α₂; ½α₂ α₃]: if positive definite, the kinetic energy is positive in every posture.
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions() const override;
  void regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                 Eigen::Ref<Matrix> Y) const override;
  [[nodiscard]] std::vector<Matrix> regressors(const JointMotion& motion) const override;
  [[nodiscard]] JointTerms terms(const JointVector& position, const JointVector& velocity,
                                 const Vector& phi) const override;
  [[nodiscard]] HandVector hand_position(const JointVector& position) const override;
  [[nodiscard]] HandJacobian jacobian(const JointVector& position) const override;
  [[nodiscard]] HandJacobian jacobian_rate(const JointVector& position, const JointVector& velocity) const override;
  [[nodiscard]] Result<void> check_joints(const JointVector& position) const override;
  [[nodiscard]] std::vector<JointVector> postures(int per_joint) const override;

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  Options options_;
  std::vector<Coefficient> coefficients_;
};

}  // namespace mbk::robot
