#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/files/kinarm/exam_parameters.h"

namespace mbk::recording {

/// Which arm of a person.
enum class Arm : std::uint8_t { right, left };

/// "Right", as the names of signals begin.
[[nodiscard]] std::string_view name_of(Arm arm);
/// "RIGHT", as the names of parameters begin.
[[nodiscard]] std::string_view capitals_of(Arm arm);

/// Joint signals of an arm, in global angles: both are measured from the x-axis of the base, in the plane. All have
/// equal length; nullptr: not recorded.
struct JointMotion {
  const Vector *q1 = nullptr, *q2 = nullptr;            ///< [rad]
  const Vector *v1 = nullptr, *v2 = nullptr;            ///< [rad/s]
  const Vector *a1 = nullptr, *a2 = nullptr;            ///< [rad/s²]
  const Vector *torque1 = nullptr, *torque2 = nullptr;  ///< [N·m] commanded motor torque along q1 and q2

  [[nodiscard]] bool has_velocity() const { return v1 != nullptr && v2 != nullptr; }
  [[nodiscard]] bool has_acceleration() const { return has_velocity() && a1 != nullptr && a2 != nullptr; }
  [[nodiscard]] bool has_torque() const { return torque1 != nullptr && torque2 != nullptr; }
};

/// Two signals of the hand in the plane: x and y.
struct HandSignal {
  Vector x, y;
};

/// Two links driven at global angles, and a pointer perpendicular to the second:
/// r = L1 (cos q1, sin q1) + L2 (cos q2, sin q2) + p (−sin q2, cos q2)    [m], from the axis of the first link
struct HandGeometry {
  double link1 = 0.0, link2 = 0.0;  ///< L1, L2 [m]
  double pointer = 0.0;             ///< p [m], towards larger q2
  std::string from;                 ///< source of the lengths, for messages

  [[nodiscard]] HandSignal position(const JointMotion& joints) const;
  /// ṙ = J q̇, J = [−L1 s1, −L2 s2 − p c2; L1 c1, L2 c2 − p s2]    [m/s]; needs v1 and v2
  [[nodiscard]] HandSignal velocity(const JointMotion& joints) const;
  /// r̈ = J q̈ − L1 (c1, s1) q̇1² − (L2 (c2, s2) + p (−s2, c2)) q̇2²    [m/s²]; needs v1, v2, a1 and a2
  [[nodiscard]] HandSignal acceleration(const JointMotion& joints) const;
  /// F = J⁻ᵀ τ [N], commanded force of the motors on the hand; NaN if the links are collinear. Needs
  /// torque1 and torque2.
  [[nodiscard]] HandSignal commanded_force(const JointMotion& joints) const;
};

/// The geometry of an arm from the parameters of its exam: an End-Point robot (RIGHT_KINARM:VERSION begins with
/// KINARM_EP) has L1_L and L2_L, an Exoskeleton (KINARM_H, KINARM_M) RIGHT_L1, RIGHT_L2 and RIGHT_PTR_ANTERIOR of
/// CALIBRATION, the last with opposite sign for the left arm.
/// @fails  data: the version is neither; a length is missing or not positive.
[[nodiscard]] Result<HandGeometry> geometry_of(Arm arm, const ExamParameters& parameters);

}  // namespace mbk::recording
