#include "mbk/simulate/participant/linear_limb.h"

#include "mbk/base/numeric/dense.h"

namespace mbk::participant {

Result<LinearLimb> LinearLimb::create(const impedance::Model& model) {
  if (model.axes() != 2 || model.B.rows() != 2 || model.K.rows() != 2 || model.M.cols() != 2 || model.B.cols() != 2 ||
      model.K.cols() != 2 || model.x0.size() != 2) {
    return bad_usage("a limb at the hand of a planar robot needs 2×2 matrices M, B and K and two coordinates x0");
  }
  if (!impedance::stacked(model).allFinite()) return bad_usage("M, B, K and x0 of a limb must be finite");
  const Eigen::Matrix2d M = model.M;
  if (M(0, 1) != M(1, 0)) return bad_usage("the inertia of a limb must be symmetric");
  if (numeric::symmetric_eigenvalues(M)[0] < 0.0) {
    return bad_usage("the inertia of a limb must not have a negative eigenvalue");
  }
  return LinearLimb(M, model.B, model.K, model.x0);
}

LoadDynamics<2> LinearLimb::dynamics(const HandState<2>& hand) const {
  return {M_, damping_scale_ * B_ * hand.velocity + stiffness_scale_ * K_ * (hand.position - x0_), 0.0};
}

impedance::Model LinearLimb::impedance(const Eigen::Vector2d& /*hand*/) const {
  return {M_, damping_scale_ * B_, stiffness_scale_ * K_, x0_};
}

}  // namespace mbk::participant
