#include "mbk/measure/analyse/posture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "mbk/model/robot/kinematics.h"

namespace mbk::analyse {
namespace {

using Eigen::Vector2d;

constexpr std::array kArmKeys = {"shoulder_x_m", "shoulder_y_m", "upper_arm_m", "forearm_m"};
constexpr double kSamePlace = 0.01;  ///< [m]: joints and hand of the robot of these lengths agree better

/// Mean of two channels over the samples between two times that are numbers; absent where there are none.
std::optional<Vector2d> mean_of(const Recording& recording, const char* first, const char* second, double from_s,
                                double to_s) {
  const Channel* x = recording.find(first);
  const Channel* y = recording.find(second);
  if (x == nullptr || y == nullptr || recording.samples() == 0) return std::nullopt;
  Vector2d sum = Vector2d::Zero();
  double count = 0.0;
  for (Index i = 0; i < recording.samples(); ++i) {
    const double t = recording.time[i] - recording.time[0];
    const Vector2d place(x->values[i], y->values[i]);
    if (!(t >= from_s && t <= to_s) || !place.allFinite()) continue;
    sum += place;
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  return Vector2d(sum / count);
}

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Shoulder, elbow and hand from what the metadata say, or why not; neither where they say nothing.
ArmPosture arm_posture(const Recording& recording, const Vector2d& hand) {
  ArmPosture posture{ArmPosture::Of::hand, {hand}, ""};
  const auto& metadata = recording.metadata;
  std::array<double, kArmKeys.size()> values{};
  std::string missing;
  for (std::size_t k = 0; k < kArmKeys.size(); ++k) {
    const auto found = metadata.find(kArmKeys[k]);
    if (found == metadata.end()) {
      missing += (missing.empty() ? "" : ", ") + std::string(kArmKeys[k]);
      continue;
    }
    const auto value = number_of(found->second);
    if (!value || (k >= 2 && !(*value > 0.0))) {
      posture.note = fmt::format("the arm is not drawn: metadata {} is '{}', which is not a {}", kArmKeys[k],
                                 found->second, k >= 2 ? "length in metres" : "position in metres");
      return posture;
    }
    values[k] = *value;
  }
  if (!missing.empty()) {
    const bool any = std::ranges::any_of(kArmKeys, [&](const char* key) { return metadata.contains(key); });
    if (any) posture.note = fmt::format("the arm is not drawn: the metadata do not contain {}", missing);
    return posture;
  }
  const auto stated = metadata.find("elbow");
  const std::optional<ElbowSide> side =
      stated == metadata.end() ? ElbowSide::right : value_of<ElbowSide>(stated->second);
  if (!side) {
    posture.note = fmt::format("the arm is not drawn: metadata elbow is '{}', neither right nor left", stated->second);
    return posture;
  }
  const Vector2d shoulder(values[0], values[1]);
  const auto [l1, l2] = std::pair(values[2], values[3]);
  const double r = (hand - shoulder).norm();
  const double cosine = (l1 * l1 + r * r - l2 * l2) / (2.0 * l1 * r);
  if (!(std::abs(cosine) <= 1.0)) {
    posture.note = fmt::format(
        "the arm is not drawn: the hand is {:.3g} m from the shoulder, out of reach of an arm of {:g} and {:g} m", r,
        l1, l2);
    return posture;
  }
  const double gamma = (side == ElbowSide::left ? 1.0 : -1.0) * std::acos(cosine);
  const Vector2d elbow = shoulder + l1 / r * (Eigen::Rotation2Dd(gamma) * (hand - shoulder));
  return {ArmPosture::Of::arm, {shoulder, elbow, hand}, ""};
}

}  // namespace

std::optional<ArmPosture> posture(const Recording& recording, double from_s, double to_s) {
  const auto hand = mean_of(recording, "hand_x", "hand_y", from_s, to_s);
  if (!hand) return std::nullopt;
  ArmPosture found = arm_posture(recording, *hand);
  if (found.of == ArmPosture::Of::arm) return found;
  const Channel* const sliding = recording.find("joint_1");
  const auto joints = sliding != nullptr && sliding->unit == "m"
                          ? std::nullopt
                          : mean_of(recording, "joint_1", "joint_2", from_s, to_s);
  if (!joints) return found;
  const robot::Geometry geometry;
  if ((robot::hand_position(geometry, *joints) - *hand).norm() > kSamePlace) return found;
  return ArmPosture{ArmPosture::Of::robot,
                    {Vector2d::Zero(), robot::elbow_position(geometry, *joints), *hand},
                    std::move(found.note)};
}

}  // namespace mbk::analyse
