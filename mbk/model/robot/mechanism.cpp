#include "mbk/model/robot/mechanism.h"

#include <algorithm>
#include <cmath>

namespace mbk::robot {

std::string Mechanism::joint_name(int joint) const {
  return std::to_string(joint + 1);
}

const Vector& Mechanism::stated_coefficients() const {
  static const Vector kNone;
  return kNone;
}

std::vector<Matrix> Mechanism::regressors(const JointMotion& motion) const {
  const Index n = joints(), p = static_cast<Index>(coefficients().size()), samples = motion.samples();
  std::vector<Matrix> all(static_cast<std::size_t>(n), Matrix(samples, p));
  Matrix Y(n, p);
  for (Index i = 0; i < samples; ++i) {
    regressor(motion.position.row(i).transpose(), motion.velocity.row(i).transpose(),
              motion.acceleration.row(i).transpose(), Y);
    for (Index joint = 0; joint < n; ++joint) all[static_cast<std::size_t>(joint)].row(i) = Y.row(joint);
  }
  return all;
}

JointTerms Mechanism::terms(const JointVector& position, const JointVector& velocity, const Vector& phi) const {
  const Index n = joints();
  const JointVector still = JointVector::Zero(n);
  Matrix Y(n, phi.size());
  const auto torque = [&](const JointVector& q, const JointVector& acceleration) -> JointVector {
    regressor(q, still, acceleration, Y);
    return Y * phi;
  };
  const auto kinetic_energy = [&](const JointVector& q) {
    return 0.5 * velocity.dot(torque(q, velocity) - torque(q, still));
  };
  JointTerms terms{JointMatrix(n, n), JointVector(n), torque(position, still)};
  for (Index k = 0; k < n; ++k) {
    terms.inertia.col(k) = torque(position, JointVector::Unit(n, k)) - terms.gravity;
    const double step = 1e-5 * std::max(1.0, std::abs(position[k]));
    JointVector ahead = position, behind = position;
    ahead[k] += step;
    behind[k] -= step;
    terms.coriolis_transposed[k] = (kinetic_energy(ahead) - kinetic_energy(behind)) / (ahead[k] - behind[k]);
  }
  return terms;
}

}  // namespace mbk::robot
