#include "mbk/measure/calibration/spring_array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "tests/support/allocations.h"

namespace mbk::calibration {
namespace spring_array_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using ::testing::HasSubstr;

constexpr double kRounding = 1e-11;  // of forces near 10 N and stiffnesses near 500 N/m, summed over eight springs

/// Eight springs from the screw eyes of the published frame, of unequal constants and lengths, on the holes of a disc.
std::vector<Spring> representative_springs(double hole_radius = 0.0) {
  const double k[] = {60, 45, 110, 80, 35, 120, 70, 90};
  const double l[] = {0.11, 0.09, 0.12, 0.085, 0.13, 0.095, 0.10, 0.08};
  const double x[] = {-0.175, -0.175, -0.175, 0, 0.175, 0.175, 0.175, 0},
               y[] = {-0.183, 0, 0.183, 0.183, 0.183, 0, -0.183, -0.183};
  std::vector<Spring> springs;
  for (std::size_t i = 0; i < 8; ++i) {
    const double angle = std::atan2(y[i], x[i]);
    springs.push_back(
        {k[i], l[i], {0.39 + x[i], y[i]}, {hole_radius * std::cos(angle), hole_radius * std::sin(angle)}});
  }
  return springs;
}

SpringArray array_of(std::vector<Spring> springs, Compression compression = Compression::slack) {
  auto array = SpringArray::create(std::move(springs), compression);
  EXPECT_TRUE(array) << array.error().line();
  return *array;
}

TEST(Springs, ForceIsTheSumOverSpringsOfEquationD1) {
  // Hand at the origin; a 3-4-5 triangle: L = 0.5, u = −(0.6, 0.8), k (L − l) = 100·0.3 = 30 N towards the anchor.
  const SpringArray array = array_of({{100.0, 0.2, {0.3, 0.4}}, {50.0, 0.1, {-0.2, 0.0}}});
  EXPECT_LT((array.force({0, 0}) - Vector2d(18.0 - 5.0, 24.0)).norm(), kRounding);
  EXPECT_NEAR(array.tension(0, {0, 0}), 30.0, kRounding);
  EXPECT_NEAR(array.length(1, {0, 0}), 0.2, kRounding);
  EXPECT_NEAR(array.energy({0, 0}), 0.5 * 100 * 0.09 + 0.5 * 50 * 0.01, kRounding);
}

TEST(Springs, StiffnessOfOneSpringIsKAlongItAndTensionOverLengthAcross) {
  const SpringArray array = array_of({{200.0, 0.1, {0.0, 0.16}}});
  EXPECT_LT((array.stiffness({0, 0}) - Matrix2d(Vector2d(200.0 * 0.06 / 0.16, 200.0).asDiagonal())).norm(), kRounding);
}

TEST(Springs, SpringsOfNoRestLengthAreExactlyLinear) {
  std::vector<Spring> springs = representative_springs();
  double sum = 0.0;
  for (Spring& spring : springs) {
    spring.rest_length = 0.0;
    sum += spring.stiffness;
  }
  const SpringArray array = array_of(springs);
  const auto field = spring_field(array, {0.3, 0.1}, 0.05);
  ASSERT_TRUE(field);
  EXPECT_LT((field->K - sum * Matrix2d::Identity()).norm(), kRounding);
  EXPECT_LT((field->equilibrium - centre_of_anchors(springs)).norm(), 1e-12);
  EXPECT_LT(field->linearisation.largest_error, kRounding);
}

TEST(Springs, ForceAndMomentAreMinusTheGradientOfTheEnergy) {
  const double h = 1e-6, tolerance = 1e-7;  // differences of ~1 J over 1e-6: rounding 1e-10, curvature h² ~ 1e-9
  for (const double hole : {0.0, 0.01125}) {
    for (const Compression compression : {Compression::slack, Compression::push}) {
      const SpringArray array = array_of(representative_springs(hole), compression);
      numeric::Random random(7);
      for (int trial = 0; trial < 50; ++trial) {
        const Vector2d hand(0.39 + random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12));
        const double rotation = random.uniform(-1.0, 1.0);
        Vector2d gradient;
        for (int axis = 0; axis < 2; ++axis) {
          const Vector2d step = h * Vector2d::Unit(axis);
          gradient[axis] = (array.energy(hand + step, rotation) - array.energy(hand - step, rotation)) / (2 * h);
        }
        EXPECT_LT((array.force(hand, rotation) + gradient).norm(), tolerance) << hand.transpose();
        const double turned = (array.energy(hand, rotation + h) - array.energy(hand, rotation - h)) / (2 * h);
        EXPECT_NEAR(array.moment(hand, rotation), -turned, tolerance) << hand.transpose();
      }
    }
  }
}

TEST(Springs, StiffnessIsMinusTheGradientOfTheForceAndSymmetric) {
  const double h = 1e-6,
               tolerance = 1e-5;  // rounding 1e-15·10 N/1e-6 = 1e-8; h² F''' ~ 1e-8; a spring near slack: k h/L
  const SpringArray array = array_of(representative_springs(0.01125));
  numeric::Random random(8);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector2d hand(0.39 + random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04));
    const double rotation = random.uniform(-1.0, 1.0);
    Matrix2d gradient;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = h * Vector2d::Unit(axis);
      gradient.col(axis) = (array.force(hand + step, rotation) - array.force(hand - step, rotation)) / (2 * h);
    }
    const Matrix2d K = array.stiffness(hand, rotation);
    EXPECT_LT((K + gradient).norm(), tolerance) << hand.transpose();
    EXPECT_EQ(K(0, 1), K(1, 0));
  }
}

TEST(Springs, HavePrincipalPropertiesThatTurnWithTheWholeRig) {
  const std::vector<Spring> springs = representative_springs(0.01125);
  const SpringArray array = array_of(springs);
  const double angle = 0.7;
  const Eigen::Matrix2d Q =
      (Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
  std::vector<Spring> turned = springs;
  for (Spring& spring : turned) spring.anchor = Q * spring.anchor;
  const SpringArray other = array_of(turned);  // the holes turn through disc_rotation
  const Vector2d hand(0.41, -0.02);
  EXPECT_LT((other.force(Q * hand, angle) - Q * array.force(hand)).norm(), kRounding);
  EXPECT_LT((other.stiffness(Q * hand, angle) - Q * array.stiffness(hand) * Q.transpose()).norm(), kRounding);
  EXPECT_NEAR(other.moment(Q * hand, angle), array.moment(hand), kRounding);
}

TEST(Springs, SlackSpringsDoNothingUnlessTheyMayPush) {
  const Spring spring{100.0, 0.2, {0.1, 0.0}};
  const SpringArray slack = array_of({spring}), push = array_of({spring}, Compression::push);
  EXPECT_EQ(slack.force({0, 0}), Vector2d(0, 0));
  EXPECT_TRUE(slack.stiffness({0, 0}).isZero(0.0));
  EXPECT_EQ(slack.energy({0, 0}), 0.0);
  EXPECT_LT((push.force({0, 0}) - Vector2d(-10.0, 0.0)).norm(), kRounding);
}

TEST(Springs, ASpringOfNoLengthExertsNoForce) {
  const Spring spring{100.0, 0.2, {0.1, 0.0}};
  EXPECT_EQ(array_of({spring}, Compression::push).force({0.1, 0.0}), Vector2d(0, 0));
  EXPECT_FALSE(array_of({spring}, Compression::push).stiffness({0.1, 0.0}).allFinite());
  EXPECT_EQ(array_of({spring}).force({0.1, 0.0}), Vector2d(0, 0));
}

TEST(Springs, AllocateNothing) {
  const SpringArray array = array_of(representative_springs(0.01125));
  const long before = testing_support::allocations();
  double sum = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Vector2d hand(0.39 + 1e-4 * i, 0.01);
    sum += array.force(hand, 0.1).sum() + array.moment(hand, 0.1) + array.energy(hand, 0.1) +
           array.stiffness(hand, 0.1).sum() + array.tension(0, hand, 0.1);
  }
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
  const auto guard = std::make_unique<double>(sum);
  EXPECT_GT(testing_support::allocations(), before) << "the guard itself does not count";
}

TEST(Springs, RefuseWhatIsNoSpring) {
  EXPECT_FALSE(SpringArray::create({}));
  EXPECT_THAT(SpringArray::create({{0.0, 0.1, {0, 0}}}).error().line(),
              AllOf(HasSubstr("spring 1"), HasSubstr(" 0 N/m")));
  EXPECT_THAT(SpringArray::create({{9.0, 0.1, {0, 0}}, {9.0, -0.1, {0, 0}}}).error().line(), HasSubstr("spring 2"));
  EXPECT_THAT(SpringArray::create({{9.0, 0.1, {std::nan(""), 0}}}).error().line(), HasSubstr("screw eye"));
}

TEST(Equilibrium, IsFoundFromAnywhereInTheFrameToTheToleranceAndBack) {
  const SpringArray array = array_of(representative_springs(0.01125));
  const auto reference = equilibrium(array, {0.39, 0.0});
  ASSERT_TRUE(reference) << reference.error().line();
  numeric::Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector2d start(0.39 + random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06));
    const auto found = equilibrium(array, start);
    ASSERT_TRUE(found) << start.transpose() << ": " << found.error().line();
    EXPECT_LE(array.force(*found).norm(), kEquilibriumForce);
    EXPECT_LT((*found - *reference).norm(), 1e-12);  // 1e-10 N over 300 N/m
  }
}

TEST(Equilibrium, OfASymmetricArrayIsItsCentre) {
  std::vector<Spring> springs;
  for (const Vector2d& anchor : {Vector2d(0.2, 0), Vector2d(-0.2, 0), Vector2d(0, 0.2), Vector2d(0, -0.2)})
    springs.push_back({100.0, 0.1, anchor});
  const auto field = spring_field(array_of(springs), {0.03, -0.02}, 0.03);
  ASSERT_TRUE(field) << field.error().line();
  EXPECT_LT(field->equilibrium.norm(), 1e-12);
  // two along each axis with k, two across with k (1 − l/L) = k/2
  EXPECT_LT((field->K - 300.0 * Matrix2d::Identity()).norm(), kRounding);
  EXPECT_NEAR(field->linearisation.smallest_extension, 0.2 - 0.03 - 0.1, 1e-12);
  EXPECT_NEAR(field->tensions[2], 10.0, kRounding);
}

TEST(Equilibrium, IsNamedWhereASpringIsSlackThere) {
  const auto found = equilibrium(array_of({{100, 0.05, {0.1, 0}},
                                           {100, 0.05, {-0.1, 0}},
                                           {9, 0.3, {0, 0.1}},
                                           {100, 0.05, {0, -0.1}},
                                           {100, 0.05, {0, 0.1}}}),
                                 {0.01, 0});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::not_usable);
  EXPECT_THAT(found.error().line(), HasSubstr("spring 3"));
}

TEST(Equilibrium, OfOneSpringIsNone) {
  // It ends where the spring is as long as at rest, free to swing round its screw eye.
  EXPECT_FALSE(equilibrium(array_of({{100, 0.05, {0.1, 0}}}), {0.0, 0.0}));
}

TEST(Equilibrium, ThatIsNotStableIsRefused) {
  // Two compressed springs in line hold the hand by symmetry only.
  const auto found =
      equilibrium(array_of({{100, 0.2, {0.1, 0}}, {100, 0.2, {-0.1, 0}}}, Compression::push), {0.0, 0.0});
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().line(), HasSubstr("stiffness"));
}

TEST(Equilibrium, WhereTheEndsOfASpringCoincideIsRefused) {
  const auto found =
      equilibrium(array_of({{100, 0.05, {0.1, 0}}, {100, 0.05, {-0.1, 0}}, {100, 0.0, {0, 0}}}), {0.0, 0.0});
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().line(), HasSubstr("spring 3"));
}

/// Largest relative error of K beside the diagonal, over where the equilibrium may lie between the points.
double largest_grid_error(double step) {
  double largest = 0.0;
  numeric::Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Spring> springs = representative_springs();
    const Vector2d shift(random.uniform(0.0, step), random.uniform(0.0, step));
    for (Spring& spring : springs) spring.anchor += shift;
    const SpringArray array = array_of(springs);
    const auto place = equilibrium(array, {0.39, 0.0});
    EXPECT_TRUE(place);
    const auto grid = grid_field(array, *place, 4 * step, step);
    EXPECT_TRUE(grid);
    EXPECT_FALSE(grid->at_border);
    // Half a step along each axis is the furthest that the nearest point is; the least force may choose its neighbour.
    EXPECT_LT((grid->equilibrium - *place).cwiseAbs().maxCoeff(), step);
    const double kxy = array.stiffness(*place)(0, 1);
    largest = std::max(largest, std::abs(grid->K(0, 1) - kxy) / std::abs(kxy));
  }
  return largest;
}

TEST(Grid, ErrsInProportionToItsStep) {
  // The table of docs/theory/springs.md, to a fifth of each figure: where the worst place between points lies is
  // chance.
  for (const auto& [step, percent] : {std::pair{0.15e-3, 0.14}, {0.5e-3, 0.46}, {1.0e-3, 0.92}, {1.5e-3, 1.4}}) {
    EXPECT_NEAR(100.0 * largest_grid_error(step), percent, 0.2 * percent) << step;
  }
}

TEST(Grid, SaysWhereTheLeastForceIsOnItsBorder) {
  const SpringArray array = array_of(representative_springs());
  const auto place = equilibrium(array, {0.39, 0.0});
  ASSERT_TRUE(place);
  const auto grid = grid_field(array, *place + Vector2d(0.02, 0.0), 0.01, 0.5e-3);
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->at_border);
  EXPECT_GT(grid->residual, 1.0);
}

TEST(Grid, NeedsAStepThatSuitsItsSize) {
  const SpringArray array = array_of(representative_springs());
  for (const double step : {0.0, -1e-3, 0.1, 1e-7, std::nan("")})
    EXPECT_FALSE(grid_field(array, {0.39, 0}, 0.03, step)) << step;
}

TEST(Linearisation, ErrorGrowsWithTheSquareOfTheRadius) {
  const SpringArray array = array_of(representative_springs());
  const auto place = equilibrium(array, {0.39, 0.0});
  ASSERT_TRUE(place);
  const Linearisation small = linearisation(array, *place, 0.001), large = linearisation(array, *place, 0.002);
  EXPECT_NEAR(large.largest_error / small.largest_error, 4.0, 0.1);
  EXPECT_NEAR(large.largest_force / small.largest_force, 2.0, 0.05);
}

}  // namespace spring_array_test
}  // namespace mbk::calibration
