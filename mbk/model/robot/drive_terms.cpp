#include "mbk/model/robot/drive_terms.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::robot {

std::vector<Coefficient> DriveTerms::coefficients(const Mechanism& mechanism) const {
  std::vector<Coefficient> all;
  for (int joint = 0; joint < mechanism.joints(); ++joint) {
    const bool slides = mechanism.slides(joint);
    const auto add = [&](bool requested, const char* name, const char* turning, const char* sliding) {
      if (requested) all.push_back({fmt::format("{}_{}", name, joint + 1), slides ? sliding : turning});
    };
    add(motor_inertia, "motor_inertia", "kg·m²", "kg");
    add(viscous, "viscous", "N·m·s/rad", "N·s/m");
    add(coulomb, "coulomb", "N·m", "N");
    add(stribeck, "stribeck", "N·m", "N");
    add(cable, "cable", "N·m/rad", "N/m");
    add(offset, "offset", "N·m", "N");
  }
  return all;
}

std::vector<PhysicalCondition> DriveTerms::physical_conditions(const Mechanism& mechanism) const {
  const std::vector<Coefficient> all = coefficients(mechanism);
  const auto count = static_cast<Index>(all.size());
  std::vector<PhysicalCondition> conditions;
  Index coulomb_before = -1;
  for (Index k = 0; k < count; ++k) {
    const std::string& name = all[static_cast<std::size_t>(k)].name;
    const bool dry = name.starts_with("coulomb"), growing = name.starts_with("stribeck");
    if (dry) coulomb_before = k;
    if (!dry && !growing && !name.starts_with("motor_inertia") && !name.starts_with("viscous")) continue;
    PhysicalCondition one{name, Matrix::Zero(1, count)};
    one.A(0, k) = 1.0;
    if (growing && coulomb) {
      one.A(0, coulomb_before) = 1.0;
      one.name = all[static_cast<std::size_t>(coulomb_before)].name + " + " + name;
    }
    conditions.push_back(std::move(one));
  }
  return conditions;
}

int DriveTerms::per_joint() const {
  int count = 0;
  for (const bool requested : {motor_inertia, viscous, coulomb, stribeck, cable, offset}) count += requested ? 1 : 0;
  return count;
}

void DriveTerms::regressor(double position, double velocity, double acceleration, double* row) const {
  if (motor_inertia) *row++ = acceleration;
  if (viscous) *row++ = velocity;
  if (coulomb || stribeck) {
    const double sign =
        smoothing > 0.0 ? std::tanh(velocity / smoothing) : static_cast<double>((velocity > 0.0) - (velocity < 0.0));
    if (coulomb) *row++ = sign;
    if (stribeck) {
      const double ratio = velocity / stribeck_velocity;
      *row++ = sign * std::exp(-ratio * ratio);
    }
  }
  if (cable) *row++ = position;
  if (offset) *row++ = 1.0;
}

void DriveTerms::regressors(const Eigen::Ref<const Vector>& position, const Eigen::Ref<const Vector>& velocity,
                            const Eigen::Ref<const Vector>& acceleration, Eigen::Ref<Matrix> rows) const {
  Index term = 0;
  if (motor_inertia) rows.col(term++) = acceleration;
  if (viscous) rows.col(term++) = velocity;
  if (coulomb || stribeck) {
    Eigen::ArrayXd sign = velocity.array().sign();
    if (smoothing > 0.0) {  // tanh by the exponential function, which Eigen vectorises
      const Eigen::ArrayXd decay = (-2.0 / smoothing * velocity.array().abs()).exp();
      sign *= (1.0 - decay) / (1.0 + decay);
    }
    if (coulomb) rows.col(term++) = sign;
    if (stribeck) rows.col(term++) = sign * (-(velocity.array() / stribeck_velocity).square()).exp();
  }
  if (cable) rows.col(term++) = position;
  if (offset) rows.col(term++).setOnes();
}

}  // namespace mbk::robot
