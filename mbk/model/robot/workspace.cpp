#include "mbk/model/robot/workspace.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mbk::robot {
namespace {

constexpr double kRightAngle = 0.5 * std::numbers::pi;
constexpr double kRounding = 1e-9;  // [rad]: a place on the limit stays inside after the way to the hand and back

double degrees(double angle) {
  return angle * 180.0 / std::numbers::pi;
}

/// normal · θ ≥ offset.
struct HalfPlane {
  Vector2d normal;
  double offset = 0;
  [[nodiscard]] double inside(const Vector2d& theta) const { return normal.dot(theta) - offset; }
};

/// The part of a convex polygon inside a half plane (Sutherland & Hodgman 1974).
std::vector<Vector2d> clipped(const std::vector<Vector2d>& corners, const HalfPlane& half_plane) {
  std::vector<Vector2d> kept;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d &from = corners[k], &to = corners[(k + 1) % corners.size()];
    const double a = half_plane.inside(from), b = half_plane.inside(to);
    if (a >= 0.0) kept.push_back(from);
    if ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)) kept.emplace_back(from + a / (a - b) * (to - from));
  }
  return kept;
}

std::vector<Vector2d> without_repeats(const std::vector<Vector2d>& corners) {
  std::vector<Vector2d> distinct;
  for (const Vector2d& corner : corners) {
    if (distinct.empty() || (corner - distinct.back()).norm() > kRounding) distinct.push_back(corner);
  }
  while (distinct.size() > 1 && (distinct.front() - distinct.back()).norm() <= kRounding) distinct.pop_back();
  return distinct;
}

}  // namespace

std::array<Margin, 5> margins(const JointLimits& limits, const Vector2d& theta) {
  const double opening = theta[0] - (theta[1] - kRightAngle);
  return {{{"θ₁", theta[0], limits.theta1_low, false},
           {"θ₁", theta[0], limits.theta1_high, true},
           {"θ₂", theta[1], limits.theta2_low, false},
           {"θ₂", theta[1], limits.theta2_high, true},
           {"θ₁ − (θ₂ − 90°)", opening, limits.smallest_opening, false}}};
}

double margin(const JointLimits& limits, const Vector2d& theta) {
  double least = std::numeric_limits<double>::infinity();
  for (const Margin& one : margins(limits, theta)) least = std::min(least, one.left());
  return least;
}

Result<void> check_joints(const JointLimits& limits, const Vector2d& theta) {
  if (!theta.allFinite()) {
    return bad_usage(fmt::format("joint angles ({}, {}) rad are not finite", theta[0], theta[1]), "give two numbers");
  }
  const auto all = margins(limits, theta);
  const Margin& worst =
      *std::ranges::min_element(all, [](const Margin& a, const Margin& b) { return a.left() < b.left(); });
  if (worst.left() >= -kRounding) return {};
  return bad_usage(fmt::format("{} is {:.2f}°, {:.3g}° {} its limit {:.4g}°", worst.quantity, degrees(worst.value),
                               -degrees(worst.left()), worst.upper ? "above" : "below", degrees(worst.limit)),
                   "choose a position inside the workspace; 'mbk robot workspace' draws it");
}

Result<Vector2d> check_hand(const Geometry& geometry, const Vector2d& hand) {
  const auto theta = joint_angles(geometry, hand);
  if (!theta) return theta;
  if (auto ok = check_joints(geometry.limits, *theta); !ok) {
    return tl::unexpected(ok.error().in(fmt::format("the hand at ({:.4g}, {:.4g}) m", hand.x(), hand.y())));
  }
  return theta;
}

std::vector<Vector2d> joint_space_corners(const JointLimits& limits) {
  if (!(limits.theta1_low <= limits.theta1_high && limits.theta2_low <= limits.theta2_high)) return {};
  const std::vector<Vector2d> rectangle = {{limits.theta1_low, limits.theta2_low},
                                           {limits.theta1_high, limits.theta2_low},
                                           {limits.theta1_high, limits.theta2_high},
                                           {limits.theta1_low, limits.theta2_high}};
  return without_repeats(clipped(rectangle, {{1.0, -1.0}, limits.smallest_opening - kRightAngle}));
}

Result<std::vector<Vector2d>> boundary(const Geometry& geometry, int points) {
  if (!(geometry.d1 > 0.0 && geometry.d2 > 0.0 && std::isfinite(geometry.d1) && std::isfinite(geometry.d2))) {
    return bad_usage(fmt::format("the link lengths {:g} m and {:g} m are not both positive", geometry.d1, geometry.d2),
                     "give both lengths");
  }
  if (points < 3) return bad_usage(fmt::format("{} points are too few for an outline", points), "request at least 3");
  const std::vector<Vector2d> corners = joint_space_corners(geometry.limits);
  if (corners.size() < 3) {
    return bad_usage("the joint limits leave no workspace", "check the sign and unit of each limit");
  }
  double length = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const double difference = corners[k][0] - corners[k][1];
    if (std::abs(difference) > kRightAngle + kRounding) {
      return bad_usage(
          fmt::format("the limits allow θ₁ − θ₂ = {:.4g}°, beyond 90°, where the links fold over", degrees(difference)),
          "narrow the limits: one outline then does not bound the workspace");
    }
    length += (corners[(k + 1) % corners.size()] - corners[k]).norm();
  }
  std::vector<Vector2d> line;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d edge = corners[(k + 1) % corners.size()] - corners[k];
    const int steps = std::max(1, static_cast<int>(std::lround(points * edge.norm() / length)));
    for (int i = 0; i < steps; ++i) {
      line.push_back(hand_position(geometry, corners[k] + (static_cast<double>(i) / steps) * edge));
    }
  }
  line.push_back(line.front());
  return line;
}

double enclosed_area(const std::vector<Vector2d>& closed_line) {
  double twice = 0.0;
  for (std::size_t k = 0; k + 1 < closed_line.size(); ++k) {
    const Vector2d &a = closed_line[k], &b = closed_line[k + 1];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * std::abs(twice);
}

Result<Workspace> workspace(const Geometry& geometry) {
  constexpr int kPoints = 7200;  // chords of 0.07°: the area to 10⁻⁶ of itself
  auto outline = MBK_TRY(boundary(geometry, kPoints));
  Workspace space{geometry, std::move(outline), {}, {}, 0.0};
  space.low = space.high = space.outline.front();
  for (const Vector2d& place : space.outline) {
    space.low = space.low.cwiseMin(place);
    space.high = space.high.cwiseMax(place);
  }
  space.area = enclosed_area(space.outline);
  return space;
}

Result<Posture> posture(const PlanarRobot& robot, const Vector2d& hand) {
  const auto theta = MBK_TRY(check_hand(robot.geometry, hand));
  const auto inertia = MBK_TRY(robot.inertia_at_hand(theta));
  const Matrix2d J = jacobian(robot.geometry, theta);
  return Posture{hand, theta, J, std::abs(J.determinant()), margins(robot.geometry.limits, theta), inertia};
}

}  // namespace mbk::robot
