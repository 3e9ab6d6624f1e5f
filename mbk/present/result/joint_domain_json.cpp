#include <Eigen/LU>

#include "mbk/present/result/result_document.h"

namespace mbk {

using document::Fields;

void describe(Fields<JointDomain>& fields) {
  using From = const JointDomain&;
  fields.type("JointDomain", "The impedance in joint coordinates.");
  fields.add("of", document::through(&JointDomain::posture, &ArmPosture::of));
  fields.add_choice(
      "second_joint_against", [](From joints) { return joints.posture.of == ArmPosture::Of::arm; }, "first link",
      "base", "reference of the angle of the second joint");
  fields.add("points_m", document::through(&JointDomain::posture, &ArmPosture::points), "base frame [m]");
  fields.add(
      "joint_angles_deg", [](From joints) { return Eigen::Vector2d(kDegrees * joints.angles); }, "[°]");
  fields.add("jacobian_m", &JointDomain::jacobian, "[m]");
  fields.add(
      "determinant_m2", [](From joints) { return joints.jacobian.determinant(); }, "[m²]");
  fields.group("units", [](Fields<JointDomain>& part) {
    const Units units = units_of(Motion::rotation);
    part.constant("M", units.inertia);
    part.constant("B", units.damping);
    part.constant("K", units.stiffness);
  });
  const auto matrices = [&fields](const char* name, auto M, auto B, auto K) {
    fields.group(name, [=](Fields<JointDomain>& part) {
      part.type("JointMatrices");
      part.add("M", M);
      part.add("B", B);
      part.add("K", K);
    });
  };
  matrices("model", &JointDomain::M, &JointDomain::B, &JointDomain::K);
  matrices("standard_error", &JointDomain::M_error, &JointDomain::B_error, &JointDomain::K_error);
  fields.add("bias_force_N", &JointDomain::bias_force, "[N]");
  fields.add("bias_force_standard_error_N", &JointDomain::bias_force_error, "[N]");
  fields.group("antisymmetry", [](Fields<JointDomain>& both) {
    const auto antisymmetry = [&both](const char* name, auto value, auto interval95) {
      both.group(name, [=](Fields<JointDomain>& part) {
        part.type("JointAntisymmetry");
        part.add("value", value);
        part.add("value_interval95", interval95);
      });
    };
    antisymmetry("inertia", &JointDomain::m_a, &JointDomain::m_a95);
    antisymmetry("stiffness", &JointDomain::k_a, &JointDomain::k_a95);
  });
  fields.add("covariance", [](From joints) {
    return result::Covariance{
        {"m_11", "m_12", "m_21", "m_22", "b_11", "b_12", "b_21", "b_22", "k_11", "k_12", "k_21", "k_22", "F_x", "F_y"},
        joints.covariance};
  });
}

}  // namespace mbk
