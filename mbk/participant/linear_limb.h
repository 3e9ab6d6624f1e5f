#pragma once

#include "mbk/core/result.h"
#include "mbk/participant/load.h"

namespace mbk::participant {

/// A limb whose hand impedance is the same everywhere, M ẍ + B ẋ + K (x − x₀) = −F_h (Dyck 2013, eq. 3.2): exactly
/// what the estimators assume. M symmetric; B and K any.
class LinearLimb : public Load {
 public:
  /// @fails  usage: not two axes, not finite, M not symmetric positive semidefinite.
  [[nodiscard]] static Result<LinearLimb> create(const impedance::Model& model);

  [[nodiscard]] LoadDynamics dynamics(const HandState& hand) const override;
  [[nodiscard]] impedance::Model impedance(const Eigen::Vector2d& hand) const override;

 private:
  LinearLimb(const Eigen::Matrix2d& M, const Eigen::Matrix2d& B, const Eigen::Matrix2d& K, const Eigen::Vector2d& x0)
      : M_(M), B_(B), K_(K), x0_(x0) {}

  Eigen::Matrix2d M_, B_, K_;
  Eigen::Vector2d x0_;
};

}  // namespace mbk::participant
