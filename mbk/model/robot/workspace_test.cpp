#include "mbk/model/robot/workspace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/model/robot/test_postures.h"

namespace mbk::robot {
namespace workspace_test {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;
const Geometry kGeometry;
const JointLimits kLimits;

TEST(CheckJoints, AllowsTheWholeWorkspaceAndItsCorners) {
  for (const Vector2d& theta : postures(kLimits, 30)) {
    EXPECT_TRUE(check_joints(kLimits, theta));
    EXPECT_GT(margin(kLimits, theta), 0.0);
  }
  for (const Vector2d& corner : joint_space_corners(kLimits)) {
    EXPECT_TRUE(check_joints(kLimits, corner));
    EXPECT_NEAR(margin(kLimits, corner), 0.0, 1e-15);
  }
}

TEST(CheckJoints, SaysWhichLimitIsBrokenAndByHowMuch) {
  struct Broken {
    double theta1, theta2;  // [°]
    const char *quantity, *value, *excess, *limit;
  };
  for (const Broken& broken :
       {Broken{95.0, 60.0, "θ₁", "95.00°", " 5°", "90°"}, Broken{30.0, -2.0, "θ₂", "-2.00°", " 2°", " 0°"},
        Broken{0.0, 65.0, "θ₁ − (θ₂ − 90°)", "25.00°", "10°", "35°"},
        Broken{-75.0, -30.0, "θ₂", "-30.00°", " 30°", " 0°"}}) {
    const auto checked = check_joints(kLimits, kDegree * Vector2d(broken.theta1, broken.theta2));
    ASSERT_FALSE(checked) << broken.quantity << " " << broken.value;
    EXPECT_EQ(checked.error().kind, ErrorKind::usage);
    EXPECT_THAT(checked.error().message, AllOf(HasSubstr(broken.quantity), HasSubstr(broken.value),
                                               HasSubstr(broken.excess), HasSubstr(broken.limit)));
    EXPECT_FALSE(checked.error().remedy.empty());
  }
  EXPECT_FALSE(check_joints(kLimits, {std::numeric_limits<double>::quiet_NaN(), 0.0}));
}

TEST(CheckHand, GivesTheJointAnglesOrSaysWhy) {
  const auto theta = check_hand(kGeometry, {0.3, 0.0});
  ASSERT_TRUE(theta) << theta.error().line();
  EXPECT_TRUE(hand_position(kGeometry, *theta).isApprox(Vector2d(0.3, 0.0), 1e-14));
  const auto far = check_hand(kGeometry, {0.6, 0.0});
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().line(), HasSubstr("0.6 m"));
  const auto beyond = check_hand(kGeometry, {0.1, -0.45});
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().line(), AllOf(HasSubstr("(0.1, -0.45) m"), HasSubstr("θ")));
}

TEST(CheckHand, HoldsWithinTheOutlineAndNotBeyondIt) {
  const auto outline = boundary(kGeometry, 1000);
  ASSERT_TRUE(outline);
  constexpr double kAside = 1e-4;  // [m]: more than an arc's height above its chord, less than any corner is wide but
  constexpr double kCusp = 0.02;   // [m] from the base, where the links fold and the workspace ends in a needle
  for (std::size_t k = 0; k + 1 < outline->size(); ++k) {
    const Vector2d along = ((*outline)[k + 1] - (*outline)[k]).normalized();
    const Vector2d middle = 0.5 * ((*outline)[k] + (*outline)[k + 1]);
    const Vector2d outwards(-along.y(), along.x());  // det J < 0 turns the anticlockwise corners round
    EXPECT_FALSE(check_hand(kGeometry, middle + kAside * outwards)) << middle.transpose();
    if (middle.norm() > kCusp) {
      EXPECT_TRUE(check_hand(kGeometry, middle - kAside * outwards)) << middle.transpose();
    }
  }
}

TEST(Margin, IsTheLeastAngleThatIsLeft) {
  EXPECT_NEAR(margin(kLimits, kDegree * Vector2d(80.0, 60.0)), 10.0 * kDegree, 1e-15);
  EXPECT_NEAR(margin(kLimits, kDegree * Vector2d(30.0, 60.0)), 25.0 * kDegree, 1e-15);
  EXPECT_NEAR(margin(kLimits, kDegree * Vector2d(30.0, -5.0)), -5.0 * kDegree, 1e-15);
}

TEST(JointSpace, IsATriangleBecauseTheLimitsMeetInPoints) {
  // θ₂ ≤ θ₁ + 55° meets θ₁ ≥ −55° at θ₂ = 0° and θ₁ ≤ 90° at θ₂ = 145°
  const auto corners = joint_space_corners(kLimits);
  ASSERT_EQ(corners.size(), 3u);
  const std::array<Vector2d, 3> expected = {kDegree * Vector2d(-55.0, 0.0), kDegree * Vector2d(90.0, 0.0),
                                            kDegree * Vector2d(90.0, 145.0)};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LE((corners[k] - expected[k]).norm(), 1e-15);
}

TEST(JointSpace, HasACornerWhereTheLinksCutTheRectangle) {
  JointLimits limits;
  limits.smallest_opening = 60.0 * kDegree;  // θ₂ ≤ θ₁ + 30°
  const auto corners = joint_space_corners(limits);
  ASSERT_EQ(corners.size(), 3u);
  EXPECT_LE((corners[0] - kDegree * Vector2d(-30.0, 0.0)).norm(), 1e-15);
  EXPECT_LE((corners[1] - kDegree * Vector2d(90.0, 0.0)).norm(), 1e-15);
  EXPECT_LE((corners[2] - kDegree * Vector2d(90.0, 120.0)).norm(), 1e-15);
  limits.smallest_opening = 10.0 * kDegree;  // θ₂ ≤ θ₁ + 80° leaves five
  EXPECT_EQ(joint_space_corners(limits).size(), 5u);
  limits.smallest_opening = 200.0 * kDegree;
  EXPECT_TRUE(joint_space_corners(limits).empty());
}

TEST(Boundary, IsClosedAndHoldsEveryCorner) {
  const auto line = boundary(kGeometry, 60);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->front(), line->back());
  EXPECT_NEAR(static_cast<double>(line->size()), 61.0, 3.0);
  for (const Vector2d& corner : joint_space_corners(kLimits)) {
    const Vector2d hand = hand_position(kGeometry, corner);
    double nearest = 1.0;
    for (const Vector2d& place : *line) nearest = std::min(nearest, (place - hand).norm());
    EXPECT_EQ(nearest, 0.0);
  }
}

TEST(Boundary, RefusesWhatHasNoOutline) {
  Geometry no_link;
  no_link.d2 = 0.0;
  EXPECT_FALSE(boundary(no_link, 100));
  EXPECT_FALSE(boundary(kGeometry, 2));
  Geometry nothing;
  nothing.limits.smallest_opening = 4.0;
  EXPECT_FALSE(boundary(nothing, 100));
  Geometry folding;
  folding.limits.theta1_high = 100.0 * kDegree;
  const auto folded = boundary(folding, 100);
  ASSERT_FALSE(folded);
  EXPECT_THAT(folded.error().message, AllOf(HasSubstr("100°"), HasSubstr("90°")));
}

TEST(EnclosedArea, IsKnownForARectangle) {
  EXPECT_DOUBLE_EQ(enclosed_area({{0.0, 0.0}, {2.0, 0.0}, {2.0, 3.0}, {0.0, 3.0}, {0.0, 0.0}}), 6.0);
  EXPECT_DOUBLE_EQ(enclosed_area({{0.0, 0.0}, {0.0, 3.0}, {2.0, 3.0}, {2.0, 0.0}, {0.0, 0.0}}), 6.0);
}

TEST(WorkspaceArea, IsTheIntegralOfTheJacobiansDeterminant) {
  // d₁d₂ ∫∫ cos(θ₁ − θ₂) dθ₁dθ₂ over 0 ≤ θ₂, θ₁ ≤ 90°, θ₂ ≤ θ₁ + 55°. Along a line of constant a = θ₁ − θ₂, θ₁ runs
  // from max(a, −55°) = a to 90°, so that it is d₁d₂ ∫ (90° − a) cos a da from −55° to 90°.
  const double low = -55.0 * kDegree, high = 90.0 * kDegree;
  const auto primitive = [&](double a) { return (high - a) * std::sin(a) - std::cos(a); };
  const double exact = kGeometry.d1 * kGeometry.d2 * (primitive(high) - primitive(low));
  const auto space = workspace(kGeometry);
  ASSERT_TRUE(space);
  constexpr double kChords = 1e-6;  // what polygons of 0.07° lose of an arc
  EXPECT_NEAR(space->area, exact, kChords * exact);
}

TEST(WorkspaceArea, IsWhatAGridCounts) {
  const auto space = workspace(kGeometry);
  ASSERT_TRUE(space);
  constexpr double kCell = 2e-3;  // [m]
  int inside = 0;
  for (double x = space->low.x(); x < space->high.x(); x += kCell) {
    for (double y = space->low.y(); y < space->high.y(); y += kCell) {
      inside += check_hand(kGeometry, {x + 0.5 * kCell, y + 0.5 * kCell}) ? 1 : 0;
    }
  }
  // Cells that the outline (2 m long) cuts are counted to half a cell at random: far less than one in a hundred
  EXPECT_NEAR(inside * kCell * kCell, space->area, 0.005 * space->area);
}

TEST(WorkspaceExtent, IsReachedAndNeverLeft) {
  const auto space = workspace(kGeometry);
  ASSERT_TRUE(space);
  constexpr double kChords = 1e-7;  // [m]
  Vector2d low = Vector2d::Constant(1.0), high = -low;
  for (const Vector2d& theta : postures(kLimits, 200)) {
    const Vector2d hand = hand_position(kGeometry, theta);
    low = low.cwiseMin(hand);
    high = high.cwiseMax(hand);
  }
  EXPECT_GE((low - space->low).minCoeff(), -kChords);
  EXPECT_GE((space->high - high).minCoeff(), -kChords);
  constexpr double kGrid = 0.01;  // [m]: the grid of postures stops that far from the outline
  EXPECT_LE((low - space->low).maxCoeff(), kGrid);
  EXPECT_LE((space->high - high).maxCoeff(), kGrid);
}

TEST(Posture, PutsEverythingAboutOnePlaceTogether) {
  const PlanarRobot robot;
  const Vector2d place(0.3, 0.1);
  const auto at = posture(robot, place);
  ASSERT_TRUE(at) << at.error().line();
  EXPECT_LE((hand_position(robot.geometry, at->theta) - place).norm(), 1e-15);
  EXPECT_EQ(at->manipulability, std::abs(at->jacobian.determinant()));
  EXPECT_GT(at->inertia_at_hand.determinant(), 0.0);
  double least = 10.0;
  for (const Margin& one : at->margins) least = std::min(least, one.left());
  EXPECT_EQ(least, margin(kLimits, at->theta));
  EXPECT_FALSE(posture(robot, {0.7, 0.0}));
}

}  // namespace workspace_test
}  // namespace mbk::robot
