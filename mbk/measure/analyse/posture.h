#pragma once

#include <optional>

#include "mbk/model/trial/arm_posture.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// The posture with the hand at its mean place between two times [s] from the first sample. With the metadata
/// shoulder_x_m, shoulder_y_m, upper_arm_m and forearm_m it is that of the person's arm,
///   elbow = shoulder + l₁ R(±γ) u,  cos γ = (l₁² + r² − l₂²)/(2 l₁ r)
/// u the direction and r the distance of the hand from the shoulder; the elbow is to the right of that line, seen from
/// above, or where the metadata say `elbow` = left to the left. Else it is that of the robot (Dyck 2013, eq. A.1) where
/// joint_1 and joint_2 lead to the hand; else the hand alone. Absent without a hand in two axes.
[[nodiscard]] std::optional<ArmPosture> posture(const Recording& recording, double from_s, double to_s);

}  // namespace mbk::analyse
