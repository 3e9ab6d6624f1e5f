#include "mbk/present/report/joint_domain_text.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

std::vector<std::string> matrix_row(const char* name, const Matrix& value, const Matrix& error, const char* unit) {
  std::vector<std::string> row = {name};
  for (Index i = 0; i < 2; ++i) {
    for (Index j = 0; j < 2; ++j) row.push_back(with_interval(value(i, j), numeric::kNormal95 * error(i, j)));
  }
  row.emplace_back(unit);
  return row;
}

std::string between(double value, const Interval& interval, const char* unit) {
  if (!std::isfinite(value)) return "undefined";
  if (!std::isfinite(interval.first)) return fmt::format("{:.3g} {}", value, unit);
  return fmt::format("{:.3g} [{:.3g}, {:.3g}] {}", value, interval.first, interval.second, unit);
}

}  // namespace

std::string joint_domain_text(const JointDomain& joints) {
  const bool of_arm = joints.posture.of == ArmPosture::Of::arm;
  const Eigen::Vector2d angles = 180.0 / std::numbers::pi * joints.angles;
  const Eigen::Vector2d &hand = joints.posture.points.back(), &base = joints.posture.points.front();
  std::string text = paragraph(
      "  ", of_arm
                ? fmt::format("at the joints of the arm: 1 shoulder, at ({:.3f}, {:.3f}) m, {:.1f}° from x; 2 elbow, "
                              "{:.1f}° against the upper arm; hand at ({:.3f}, {:.3f}) m",
                              base.x(), base.y(), angles[0], angles[1], hand.x(), hand.y())
                : fmt::format("at the joints of the robot: 1 at {:.1f}° from x, 2 at {:.1f}° from −y, both against "
                              "its base; hand at ({:.3f}, {:.3f}) m",
                              angles[0], angles[1], hand.x(), hand.y()));
  const Units units = units_of(Motion::rotation);
  text += table({{"", "11", "12", "21", "22", ""},
                 matrix_row("inertia M", joints.M, joints.M_error, units.inertia),
                 matrix_row("damping B", joints.B, joints.B_error, units.damping),
                 matrix_row("stiffness K", joints.K, joints.K_error, units.stiffness)});
  const auto force = [&](Index k) {
    return with_interval(joints.bias_force[k], numeric::kNormal95 * joints.bias_force_error[k]);
  };
  text +=
      table({{"antisymmetry", "m_a " + between(joints.m_a, joints.m_a95, units.inertia)},
             {"", "k_a " + between(joints.k_a, joints.k_a95, units.stiffness)},
             {"bias force", fmt::format("x {}, y {} N: force of the hand on the robot at rest", force(0), force(1))}});
  return text + paragraph("  ", fmt::format("(M = JᵀMJ, B = JᵀBJ, K = JᵀKJ − Σ F ∂²x/∂q² of the matrices at the hand, "
                                            "det J = {:.3g} m²; ± does not include the uncertainty of the posture)",
                                            joints.jacobian.determinant()));
}

}  // namespace mbk::report
