#include "mbk/files/kinarm/hand_geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace mbk::recording {
namespace {

constexpr double kStraight = 1e-6;  ///< |det J| / (L1 L2) at which the links count as lying in one line

Result<double> length(const ExamParameters& parameters, std::string_view group, const std::string& name) {
  const auto value = parameters.number(group, name);
  if (!value) return bad_data(fmt::format("{}:{} is missing", group, name));
  if (!(*value > 0.0 && std::isfinite(*value))) return bad_data(fmt::format("{}:{} is {}", group, name, *value));
  return *value;
}

/// r = f(sample): x and y sample by sample.
template <class Function>
HandSignal each(Index samples, const Function& function) {
  HandSignal signal{Vector(samples), Vector(samples)};
  for (Index i = 0; i < samples; ++i) {
    const auto [x, y] = function(i);
    signal.x[i] = x;
    signal.y[i] = y;
  }
  return signal;
}

struct Pair {
  double x, y;
};

}  // namespace

std::string_view name_of(Arm arm) {
  return arm == Arm::right ? "Right" : "Left";
}

std::string_view capitals_of(Arm arm) {
  return arm == Arm::right ? "RIGHT" : "LEFT";
}

HandSignal HandGeometry::position(const JointMotion& joints) const {
  return each(joints.q1->size(), [&](Index i) {
    const double s1 = std::sin((*joints.q1)[i]), c1 = std::cos((*joints.q1)[i]);
    const double s2 = std::sin((*joints.q2)[i]), c2 = std::cos((*joints.q2)[i]);
    return Pair{link1 * c1 + link2 * c2 - pointer * s2, link1 * s1 + link2 * s2 + pointer * c2};
  });
}

HandSignal HandGeometry::velocity(const JointMotion& joints) const {
  const Vector& v1 = *joints.v1;
  const Vector& v2 = *joints.v2;
  return each(joints.q1->size(), [&](Index i) {
    const double s1 = std::sin((*joints.q1)[i]), c1 = std::cos((*joints.q1)[i]);
    const double s2 = std::sin((*joints.q2)[i]), c2 = std::cos((*joints.q2)[i]);
    return Pair{-link1 * s1 * v1[i] - link2 * s2 * v2[i] - pointer * c2 * v2[i],
                link1 * c1 * v1[i] + link2 * c2 * v2[i] - pointer * s2 * v2[i]};
  });
}

HandSignal HandGeometry::acceleration(const JointMotion& joints) const {
  const Vector& v1 = *joints.v1;
  const Vector& v2 = *joints.v2;
  const Vector& a1 = *joints.a1;
  const Vector& a2 = *joints.a2;
  return each(joints.q1->size(), [&](Index i) {
    const double s1 = std::sin((*joints.q1)[i]), c1 = std::cos((*joints.q1)[i]);
    const double s2 = std::sin((*joints.q2)[i]), c2 = std::cos((*joints.q2)[i]);
    const double square1 = v1[i] * v1[i], square2 = v2[i] * v2[i];
    return Pair{-link1 * (c1 * square1 + s1 * a1[i]) - link2 * (c2 * square2 + s2 * a2[i]) -
                    pointer * (-s2 * square2 + c2 * a2[i]),
                link1 * (-s1 * square1 + c1 * a1[i]) + link2 * (-s2 * square2 + c2 * a2[i]) -
                    pointer * (c2 * square2 + s2 * a2[i])};
  });
}

HandSignal HandGeometry::commanded_force(const JointMotion& joints) const {
  const Vector& torque1 = *joints.torque1;
  const Vector& torque2 = *joints.torque2;
  return each(joints.q1->size(), [&](Index i) {
    const double s1 = std::sin((*joints.q1)[i]), c1 = std::cos((*joints.q1)[i]);
    const double s2 = std::sin((*joints.q2)[i]), c2 = std::cos((*joints.q2)[i]);
    const double xx = -link1 * s1, xy = -link2 * s2 - pointer * c2;  // the rows of J
    const double yx = link1 * c1, yy = link2 * c2 - pointer * s2;
    const double determinant = xx * yy - xy * yx;
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    if (!(std::abs(determinant) > kStraight * link1 * link2)) return Pair{kNaN, kNaN};
    return Pair{(yy * torque1[i] - yx * torque2[i]) / determinant, (xx * torque2[i] - xy * torque1[i]) / determinant};
  });
}

Result<HandGeometry> geometry_of(Arm arm, const ExamParameters& parameters) {
  // The version of a robot is stored with its own arm, or with the right one if both belong to one robot.
  const std::string own = fmt::format("{}_KINARM", capitals_of(arm));
  std::string version = parameters.text(own, "VERSION");
  if (version.empty()) version = parameters.text("RIGHT_KINARM", "VERSION");
  const bool end_point = version.starts_with("KINARM_EP");
  if (!end_point && !version.starts_with("KINARM_H") && !version.starts_with("KINARM_M")) {
    return bad_data(version.empty() ? "RIGHT_KINARM:VERSION is missing"
                                    : fmt::format("the geometry of the robot '{}' is unknown", version));
  }
  const std::string group = end_point ? own : "CALIBRATION";
  const std::string side(capitals_of(arm));
  const std::string first = end_point ? "L1_L" : side + "_L1", second = end_point ? "L2_L" : side + "_L2";
  const auto link1 = MBK_TRY(length(parameters, group, first));
  const auto link2 = MBK_TRY(length(parameters, group, second));
  HandGeometry geometry{link1, link2, 0.0,
                        fmt::format("{}:{} {:.6g} m, {} {:.6g} m", group, first, link1, second, link2)};
  if (end_point) return geometry;
  const std::string offset = side + "_PTR_ANTERIOR";
  const auto pointer = parameters.number(group, offset);
  if (!pointer || !std::isfinite(*pointer)) return bad_data(fmt::format("{}:{} is missing", group, offset));
  geometry.pointer = arm == Arm::left ? -*pointer : *pointer;
  geometry.from += fmt::format(", {} {:.6g} m{}", offset, *pointer, arm == Arm::left ? ", sign reversed" : "");
  return geometry;
}

}  // namespace mbk::recording
