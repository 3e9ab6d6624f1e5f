#include "mbk/measure/explore/stiffness_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"

namespace mbk::explore {
namespace stiffness_regression_test {

const Matrix kTruth = Matrix{{42.0, -20.0}, {-36.0, 125.0}};

std::vector<DisplacedHand> displaced_hands(int directions, int repetitions, double noise, std::uint64_t seed,
                                           double follows = 1.0, double moved = 0.0) {
  numeric::Random random(seed);
  std::vector<DisplacedHand> all;
  for (int i = 0; i < directions * repetitions; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i % directions) / directions;
    DisplacedHand one;
    one.commanded = 0.006 * Vector{{std::cos(angle), std::sin(angle)}};
    one.displacement = follows * one.commanded;
    Vector own{{noise * random.normal(), 2.0 * noise * random.normal()}};
    one.displacement -= moved * own;  // the limb's own force moves the hand at a soft robot
    one.force = kTruth * one.displacement + own;
    all.push_back(one);
  }
  return all;
}

TEST(StiffnessRegression, FindsAStiffnessThatIsNotSymmetricExactly) {
  const auto fit = regress_stiffness(displaced_hands(8, 2, 0.0, 1));
  ASSERT_TRUE(fit) << fit.error().line();
  EXPECT_NEAR((fit->K - kTruth).norm(), 0.0, 1e-10);
  EXPECT_NEAR(fit->standard_error.norm(), 0.0, 1e-9);
  EXPECT_NEAR(fit->reached, 1.0, 1e-12);
  EXPECT_EQ(fit->directions, 8);
  EXPECT_EQ(fit->displacements, 16);
  EXPECT_NEAR(fit->amplitude, 0.006, 1e-12);
}

/// The same by loops over the normal equations of one axis of force at a time, where the robot follows exactly.
TEST(StiffnessRegression, IsThePlainTwin) {
  const auto hands = displaced_hands(6, 4, 0.1, 5);
  const auto fit = regress_stiffness(hands);
  ASSERT_TRUE(fit);
  for (Index r = 0; r < 2; ++r) {
    double xx = 0, xy = 0, yy = 0, fx = 0, fy = 0;
    for (const DisplacedHand& one : hands) {
      const double x = one.displacement[0], y = one.displacement[1], f = one.force[r];
      xx += x * x, xy += x * y, yy += y * y, fx += f * x, fy += f * y;
    }
    const double det = xx * yy - xy * xy;
    const double kx = (fx * yy - fy * xy) / det, ky = (fy * xx - fx * xy) / det;
    EXPECT_NEAR(fit->K(r, 0), kx, 1e-9);
    EXPECT_NEAR(fit->K(r, 1), ky, 1e-9);
    double variance_x = 0, variance_y = 0, trace = 0;
    for (const DisplacedHand& one : hands) {
      const double x = one.displacement[0], y = one.displacement[1], e = one.force[r] - kx * x - ky * y;
      const double ax = (x * yy - y * xy) / det, ay = (y * xx - x * xy) / det, h = ax * x + ay * y;
      variance_x += ax * ax * e * e / (1.0 - h);
      variance_y += ay * ay * e * e / (1.0 - h);
      trace += h;
    }
    EXPECT_NEAR(trace, 2.0, 1e-9);
    EXPECT_NEAR(fit->standard_error(r, 0), std::sqrt(variance_x), 1e-9);
    EXPECT_NEAR(fit->standard_error(r, 1), std::sqrt(variance_y), 1e-9);
  }
}

TEST(StiffnessRegression, HoldsTheTruthInNinetyFivePercent) {
  constexpr int kRuns = 2000;
  int held[4] = {};
  for (int run = 0; run < kRuns; ++run) {
    const auto fit = regress_stiffness(displaced_hands(8, 2, 0.1, 100U + static_cast<unsigned>(run)));
    ASSERT_TRUE(fit);
    for (Index k = 0; k < 4; ++k) {
      held[k] += std::abs(fit->K(k / 2, k % 2) - kTruth(k / 2, k % 2)) <= fit->half_width95(k / 2, k % 2) ? 1 : 0;
    }
  }
  for (const int n : held) EXPECT_NEAR(n / static_cast<double>(kRuns), 0.95, 0.015);  // 3 standard deviations
}

TEST(StiffnessRegression, IsNotBiasedByAHandThatItsOwnForceMoves) {
  Vector sum = Vector::Zero(4), plain = Vector::Zero(4);
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const auto hands = displaced_hands(8, 5, 0.3, 1U + static_cast<unsigned>(run), 0.8, 1.0 / 400.0);
    const auto fit = regress_stiffness(hands);
    ASSERT_TRUE(fit);
    sum += fit->K.reshaped<Eigen::RowMajor>() / kRuns;
    Matrix dd = Matrix::Zero(2, 2), fd = dd;
    for (const DisplacedHand& one : hands) {
      dd += one.displacement * one.displacement.transpose();
      fd += one.force * one.displacement.transpose();
    }
    plain += Matrix(fd * numeric::inverse(dd)).reshaped<Eigen::RowMajor>() / kRuns;
  }
  EXPECT_NEAR(sum[3], 125.0, 2.0);
  EXPECT_LT(plain[3], 115.0);  // what least squares on the measured displacement would say
}

TEST(StiffnessRegression, SaysHowMuchOfTheDisplacementIsReached) {
  const auto fit = regress_stiffness(displaced_hands(8, 2, 0.01, 1, 0.4));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->reached, 0.4, 1e-9);
  EXPECT_NEAR(fit->K(1, 1), 125.0, 10.0);
}

TEST(StiffnessRegression, TestsWhetherOneStiffnessHoldsForAllDirections) {
  int rejected = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto fit = regress_stiffness(displaced_hands(8, 5, 0.1, seed));
    ASSERT_TRUE(fit && fit->linear_p);
    rejected += *fit->linear_p < 0.05 ? 1 : 0;
  }
  EXPECT_LE(rejected, 22);  // 10 expected; 4 standard deviations more
  auto bent = displaced_hands(8, 5, 0.02, 1);
  for (DisplacedHand& one : bent) one.force += Vector{{0.0, 3e4 * one.displacement.x() * one.displacement.x()}};
  const auto fit = regress_stiffness(bent);
  ASSERT_TRUE(fit && fit->linear_p);
  EXPECT_LT(*fit->linear_p, 1e-6);
}

TEST(StiffnessRegression, RefusesWhatDoesNotDetermineAStiffness) {
  EXPECT_FALSE(regress_stiffness(displaced_hands(2, 20, 0.1, 1)));  // ±x: across it nothing is known
  EXPECT_FALSE(regress_stiffness(displaced_hands(5, 1, 0.1, 1)));   // too few
  auto hands = displaced_hands(8, 2, 0.1, 1);
  hands[3].force[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(regress_stiffness(hands));
  hands = displaced_hands(8, 2, 0.0, 1, 0.0);  // a hand that does not follow
  EXPECT_FALSE(regress_stiffness(hands));
}

TEST(StiffnessRegression, TakesOneAxis) {
  std::vector<DisplacedHand> hands;
  for (int i = 0; i < 12; ++i) {
    const Vector z = Vector::Constant(1, i % 2 == 0 ? 0.05 : -0.05);
    hands.push_back({0.0, 0, z, z, 70.0 * z + Vector::Constant(1, i % 3 == 0 ? 0.01 : -0.005)});
  }
  const auto fit = regress_stiffness(hands);
  ASSERT_TRUE(fit) << fit.error().line();
  EXPECT_NEAR(fit->K(0, 0), 70.0, 0.2);
  EXPECT_EQ(fit->directions, 2);
}

}  // namespace stiffness_regression_test
}  // namespace mbk::explore
