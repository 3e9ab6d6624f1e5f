#pragma once

#include <limits>

#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// A drive with one joint, which slides (φ = M [kg]) or turns (φ = I [kg·m²]) in no field of gravity; its coordinate is
/// the position of the hand.
class SingleJoint : public Mechanism {
 public:
  struct Options {
    bool slides = true;
    double low = -std::numeric_limits<double>::infinity();  ///< its limits [m or rad]; infinite if none
    double high = std::numeric_limits<double>::infinity();
  };
  explicit SingleJoint(const Options& options);

  [[nodiscard]] int joints() const override { return 1; }
  [[nodiscard]] JointRange joint_range(int /*joint*/) const override { return {options_.low, options_.high}; }
  [[nodiscard]] bool slides(int /*joint*/) const override { return options_.slides; }
  [[nodiscard]] int hand_axes() const override { return 1; }
  [[nodiscard]] bool hand_turns() const override { return !options_.slides; }
  [[nodiscard]] const std::vector<Coefficient>& coefficients() const override { return coefficients_; }
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions() const override {
    return {{coefficients_.front().name, Matrix::Ones(1, 1)}};
  }
  void regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                 Eigen::Ref<Matrix> Y) const override;
  [[nodiscard]] JointTerms terms(const JointVector& position, const JointVector& velocity,
                                 const Vector& phi) const override;
  [[nodiscard]] HandVector hand_position(const JointVector& position) const override { return position; }
  [[nodiscard]] HandJacobian jacobian(const JointVector& position) const override;
  [[nodiscard]] HandJacobian jacobian_rate(const JointVector& position, const JointVector& velocity) const override;
  [[nodiscard]] Result<void> check_joints(const JointVector& position) const override;
  [[nodiscard]] std::vector<JointVector> postures(int per_joint) const override;

 private:
  Options options_;
  std::vector<Coefficient> coefficients_;
};

}  // namespace mbk::robot
