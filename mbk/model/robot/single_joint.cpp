#include "mbk/model/robot/single_joint.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::robot {

SingleJoint::SingleJoint(const Options& options) : options_(options) {
  coefficients_ = {options.slides ? Coefficient{"mass", "kg"} : Coefficient{"inertia", "kg·m²"}};
}

void SingleJoint::regressor(const JointVector& /*position*/, const JointVector& /*velocity*/,
                            const JointVector& acceleration, Eigen::Ref<Matrix> Y) const {
  Y(0, 0) = acceleration[0];
}

JointTerms SingleJoint::terms(const JointVector& /*position*/, const JointVector& /*velocity*/,
                              const Vector& phi) const {
  return {JointMatrix::Constant(1, 1, phi[0]), JointVector::Zero(1), JointVector::Zero(1)};
}

HandJacobian SingleJoint::jacobian(const JointVector& /*position*/) const {
  return HandJacobian::Ones(1, 1);
}

HandJacobian SingleJoint::jacobian_rate(const JointVector& /*position*/, const JointVector& /*velocity*/) const {
  return HandJacobian::Zero(1, 1);
}

Result<void> SingleJoint::check_joints(const JointVector& position) const {
  const double q = position[0];
  if (q >= options_.low && q <= options_.high) return {};
  return bad_data(fmt::format("joint 1 at {:.4g} {unit} is outside {:.4g} … {:.4g} {unit}", q, options_.low,
                              options_.high, fmt::arg("unit", options_.slides ? "m" : "rad")),
                  "check the units and the sign in --channels, or the limits of the robot");
}

std::vector<JointVector> SingleJoint::postures(int /*per_joint*/) const {
  const bool bounded = std::isfinite(options_.high - options_.low);
  return {JointVector::Constant(1, bounded ? 0.5 * (options_.low + options_.high) : 0.0)};
}

}  // namespace mbk::robot
