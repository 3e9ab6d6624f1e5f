#pragma once

#include "mbk/base/core/result.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::participant {

/// A limb whose hand impedance is the same everywhere, M ẍ + B ẋ + K (x − x₀) = −F_h (Dyck 2013, eq. 3.2): exactly as
/// assumed by the estimators. M symmetric; B and K arbitrary.
class LinearLimb : public Load<2> {
 public:
  /// @fails  usage: not two axes, not finite, M not symmetric positive semidefinite.
  [[nodiscard]] static Result<LinearLimb> create(const impedance::Model& model);

  /// s_K and s_D ≥ 0 multiply K and B, both 1 for the limb as it was created: co-contraction. May change between ticks.
  void scale(double stiffness, double damping) {
    stiffness_scale_ = stiffness;
    damping_scale_ = damping;
  }

  /// Sets the rest position [m], base frame. May change between ticks.
  void rest_at(const Eigen::Vector2d& place) { x0_ = place; }

  [[nodiscard]] LoadDynamics<2> dynamics(const HandState<2>& hand) const override;
  [[nodiscard]] impedance::Model impedance(const Eigen::Vector2d& hand) const override;

  /// Its K alone; does not allocate.
  [[nodiscard]] Eigen::Matrix2d stiffness(const Eigen::Vector2d& /*hand*/) const { return stiffness_scale_ * K_; }

 private:
  LinearLimb(const Eigen::Matrix2d& M, const Eigen::Matrix2d& B, const Eigen::Matrix2d& K, const Eigen::Vector2d& x0)
      : M_(M), B_(B), K_(K), x0_(x0) {}

  Eigen::Matrix2d M_, B_, K_;
  Eigen::Vector2d x0_;
  double stiffness_scale_ = 1.0, damping_scale_ = 1.0;
};

}  // namespace mbk::participant
