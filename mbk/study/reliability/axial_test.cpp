#include "mbk/study/reliability/axial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::reliability {
namespace axial_test {

constexpr double kPi = std::numbers::pi, kDegree = kPi / 180.0;
constexpr double kRounding = 1e-12;

TEST(AxialMean, IsAcrossTheCutWhereAnglesLieOnBothSidesOfIt) {
  const auto mean = axial_mean(Vector{{1.0 * kDegree, 179.0 * kDegree, 2.0 * kDegree, 178.0 * kDegree}});
  ASSERT_TRUE(mean);
  EXPECT_NEAR(std::sin(mean->mean), 0.0, kRounding);
  EXPECT_NEAR(mean->standard_deviation, std::sqrt(2.5) * kDegree, 1e-3 * kDegree);  // of small angles the plain one
}

TEST(AxialMean, OfTwoAxesIsHalfWayAndItsSpreadInClosedForm) {
  const auto mean = axial_mean(Vector{{20.0 * kDegree, 60.0 * kDegree}});
  ASSERT_TRUE(mean);
  EXPECT_NEAR(mean->mean, 40.0 * kDegree, kRounding);
  EXPECT_NEAR(mean->resultant, std::cos(40.0 * kDegree), kRounding);
  EXPECT_NEAR(mean->standard_deviation, 0.5 * std::sqrt(-2.0 * std::log(std::cos(40.0 * kDegree))), kRounding);
}

TEST(AxialMean, TurnsWithTheAxesAndDoesNotSeeHalfTurns) {
  numeric::Random random(3);
  Vector angles(9);
  for (double& angle : angles) angle = 0.3 * random.normal();
  const auto mean = axial_mean(angles);
  Vector turned = angles.array() + 1.1;
  turned[4] += kPi;
  turned[5] -= 3.0 * kPi;
  const auto other = axial_mean(turned);
  ASSERT_TRUE(mean && other);
  EXPECT_NEAR(axial_difference(other->mean, mean->mean), 1.1, kRounding);
  EXPECT_NEAR(other->standard_deviation, mean->standard_deviation, kRounding);
}

TEST(AxialMean, OfAxesThatPointEverywhereAlikeIsNone) {
  const auto mean = axial_mean(Vector{{0.0, 0.5 * kPi}});
  ASSERT_TRUE(mean);
  EXPECT_EQ(mean->support, Support::no_variation);
  EXPECT_TRUE(std::isnan(mean->mean));
  EXPECT_FALSE(axial_mean(Vector()));
  EXPECT_FALSE(axial_mean(Vector{{std::nan("")}}));
}

TEST(AxialMean, OfOneAxisIsThatAxis) {
  const auto mean = axial_mean(Vector{{0.7}});
  ASSERT_TRUE(mean);
  EXPECT_NEAR(mean->mean, 0.7, kRounding);
  EXPECT_NEAR(mean->standard_deviation, 0.0, 1e-8);
}

TEST(AxialDifference, LiesWithinAQuarterTurnEitherWay) {
  EXPECT_NEAR(axial_difference(1.0 * kDegree, 179.0 * kDegree), 2.0 * kDegree, kRounding);
  EXPECT_NEAR(axial_difference(179.0 * kDegree, 1.0 * kDegree), -2.0 * kDegree, kRounding);
  EXPECT_NEAR(axial_difference(0.0, 0.5 * kPi), 0.5 * kPi, kRounding);
  EXPECT_NEAR(axial_difference(0.5 * kPi, 0.0), 0.5 * kPi, kRounding);
}

TEST(Unwrapped, SaysWhetherPlainStatisticsMayBeUsed) {
  const Unwrapped near = unwrapped_about(Vector{{0.1, kPi - 0.1, 0.05}}, 0.0);
  EXPECT_TRUE(near.trusted);
  EXPECT_NEAR(near.angles[1], -0.1, kRounding);
  EXPECT_NEAR(near.farthest, 0.1, kRounding);
  EXPECT_FALSE(unwrapped_about(Vector{{0.1, 0.4 * kPi}}, 0.0).trusted);
}

TEST(WidthSpread, IsLnOfTheRatioForMatricesThatAreMultiples) {
  std::vector<std::vector<Matrix>> matrices;
  for (int person = 0; person < 5; ++person) {
    const Matrix own = std::exp2(person) * Matrix{{2.0, 0.3}, {0.3, 1.0}};
    matrices.push_back({own, 1.5 * own});
  }
  const auto spread = width_spread(matrices);
  ASSERT_TRUE(spread) << spread.error().line();
  EXPECT_EQ(spread->support, Support::enough);
  ASSERT_EQ(spread->within.size(), 5);
  ASSERT_EQ(spread->between.size(), 10);
  // both eigenvalues of A⁻¹B are the ratio: d = √2 ln ratio
  for (const double one : spread->within) EXPECT_NEAR(one, std::numbers::sqrt2 * std::log(1.5), kRounding);
  EXPECT_NEAR(spread->between.maxCoeff(), std::numbers::sqrt2 * std::log(16.0), kRounding);
  matrices.resize(4);
  EXPECT_EQ(width_spread(matrices)->support, Support::too_few_people);
  matrices[0][1] = -matrices[0][1];
  EXPECT_FALSE(width_spread(matrices));
}

}  // namespace axial_test
}  // namespace mbk::reliability
