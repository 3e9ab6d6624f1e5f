#include "mbk/measure/analyse/compare_forces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mbk::analyse {
namespace {

using testing::HasSubstr;

constexpr double kTick = 1e-3;

/// Of one axis and one joint: measured = f(t), estimated = e(t), velocity = v(t) for `rows` rows.
template <class Measured, class Estimated, class Velocity>
ForcePair pair_of(Index rows, Measured f, Estimated e, Velocity v) {
  ForcePair pair{Matrix(rows, 1), Matrix(rows, 1), Matrix(rows, 1)};
  for (Index i = 0; i < rows; ++i) {
    const double t = kTick * static_cast<double>(i);
    pair.measured(i, 0) = f(t);
    pair.estimated(i, 0) = e(t);
    pair.joint_velocity(i, 0) = v(t);
  }
  return pair;
}

double swing(double t) {
  return 3.0 * std::sin(7.0 * t) + std::sin(17.0 * t + 1.0);
}

double steady(double /*t*/) {
  return 1.0;
}

TEST(CompareForces, FindsGainBiasRmseAndVafOfAStraightRelation) {
  const ForcePair pair = pair_of(
      20000, swing, [](double t) { return 0.8 * swing(t) + 0.5; }, steady);
  const ForceComparison found = compare_forces({pair}, kTick).value();
  const double mean = pair.measured.mean();
  EXPECT_NEAR(found.gain[0], 0.8, 1e-12);
  EXPECT_NEAR(found.correlation[0], 1.0, 1e-12);
  EXPECT_NEAR(found.all.bias[0], 0.5 - 0.2 * mean, 1e-12);
  EXPECT_NEAR(found.vaf[0], 96.0, 1e-9);  // 1 − 0.2²
  EXPECT_NEAR(found.all.rmse[0], std::hypot(0.2 * found.measured_rms[0], found.all.bias[0]), 1e-12);
  EXPECT_NEAR(found.lag[0], 0.0, 1e-6);  // a thousandth of a row
  EXPECT_DOUBLE_EQ(found.duration, 20.0);
}

TEST(CompareForces, IsBlindToABiasOnlyInTheVaf) {
  const ForcePair pair = pair_of(
      5000, swing, [](double t) { return swing(t) + 2.0; }, steady);
  const ForceComparison found = compare_forces({pair}, kTick).value();
  EXPECT_NEAR(found.vaf[0], 100.0, 1e-9);
  EXPECT_NEAR(found.all.rmse[0], 2.0, 1e-12);
  EXPECT_NEAR(found.all.bias[0], 2.0, 1e-12);
}

TEST(CompareForces, FindsALagToAFractionOfARow) {
  for (const double lag : {0.0167, 0.0003, -0.0222}) {
    const ForcePair pair = pair_of(
        10000, swing, [lag](double t) { return swing(t - lag); }, steady);
    const ForceComparison found = compare_forces({pair}, kTick).value();
    EXPECT_NEAR(found.lag[0], lag, 1e-5);
    EXPECT_NEAR(found.correlation_at_lag[0], 1.0, 1e-6);
    EXPECT_LT(found.correlation[0], 1.0);
  }
}

TEST(CompareForces, SaysNoLagWhereItIsLongerThanWhatIsTried) {
  const ForcePair pair = pair_of(
      10000, [](double t) { return std::sin(2.0 * t); }, [](double t) { return std::sin(2.0 * (t - 0.15)); }, steady);
  EXPECT_TRUE(std::isnan(compare_forces({pair}, kTick).value().lag[0]));
  EXPECT_NEAR(compare_forces({pair}, kTick, {.longest_lag = 0.3}).value().lag[0], 0.15, 1e-4);
}

TEST(CompareForces, PutsDryFrictionThatIsNotKnownIntoReversalsAndOffsetsIntoRest) {
  // A joint that swings, rests and swings again; the error is 0.3 N at rest, 1 N within 20 ms of a reversal, else 0.
  const double kPeriod = 0.5;
  const auto velocity = [&](double t) {
    return t >= 2.0 && t < 4.0 ? 0.0 : std::cos(2.0 * std::numbers::pi * t / kPeriod);
  };
  const auto reversal = [&](double t) {
    const double phase = std::fmod(t + 0.25 * kPeriod, 0.5 * kPeriod);
    return !(t >= 2.0 && t < 4.0) && std::min(phase, 0.5 * kPeriod - phase) < 0.020;
  };
  const auto error = [&](double t) { return t >= 2.0 && t < 4.0 ? 0.3 : reversal(t) ? 1.0 : 0.0; };
  const ForcePair pair = pair_of(
      6000, swing, [&](double t) { return swing(t) + error(t); }, velocity);
  const ForceComparison found = compare_forces({pair}, kTick).value();
  EXPECT_EQ(found.rest.rows, 2000);
  EXPECT_NEAR(found.rest.bias[0], 0.3, 1e-12);
  EXPECT_EQ(found.reversals.rows, 16 * 51);  // four a second, over four seconds
  EXPECT_NEAR(found.reversals.bias[0], 39.0 / 51.0, 0.03);
  EXPECT_EQ(found.motion.rows, 6000 - 2000 - 16 * 51);
  EXPECT_NEAR(found.motion.bias[0], 0.0, 1e-12);
}

TEST(CompareForces, TakesNoiseAtRestForNoReversal) {
  const ForcePair pair = pair_of(2000, swing, swing, [](double t) { return 0.01 * std::sin(900.0 * t); });
  const ForceComparison found = compare_forces({pair}, kTick).value();
  EXPECT_EQ(found.rest.rows, 2000);
  EXPECT_EQ(found.reversals.rows, 0);
  EXPECT_TRUE(std::isnan(found.reversals.bias[0]));
}

TEST(CompareForces, CountsAReversalOfAnyJoint) {
  ForcePair pair = pair_of(2000, swing, swing, steady);
  pair.joint_velocity.conservativeResize(2000, 2);
  for (Index i = 0; i < 2000; ++i) pair.joint_velocity(i, 1) = i < 700 ? -0.5 : 0.5;
  EXPECT_EQ(compare_forces({pair}, kTick).value().reversals.rows, 51);
}

TEST(CompareForces, OfTwoSegmentsIsThatOfTheirRowsAndNoLagOrReversalReachesAcross) {
  const auto late = [](double t) { return swing(t - 0.01); };
  ForcePair one = pair_of(4000, swing, late, steady),
            other = pair_of(
                3000, [](double t) { return swing(t + 1.3); }, [](double t) { return swing(t + 1.29); },
                [](double) { return -1.0; });
  const ForceComparison both = compare_forces({one, other}, kTick).value();
  EXPECT_EQ(both.all.rows, 7000);
  EXPECT_EQ(both.reversals.rows, 0);
  EXPECT_NEAR(both.lag[0], 0.01, 1e-5);
  EXPECT_NEAR(both.correlation_at_lag[0], 1.0, 1e-6);
  const double squares =
      (one.estimated - one.measured).squaredNorm() + (other.estimated - other.measured).squaredNorm();
  EXPECT_NEAR(both.all.rmse[0], std::sqrt(squares / 7000.0), 1e-12);
}

TEST(CompareForces, HasNoRelationToAForceThatDoesNotChange) {
  const ForceComparison found = compare_forces({pair_of(500, steady, swing, steady)}, kTick).value();
  EXPECT_TRUE(std::isnan(found.gain[0]));
  EXPECT_TRUE(std::isnan(found.vaf[0]));
  EXPECT_TRUE(std::isnan(found.lag[0]));
  EXPECT_TRUE(std::isfinite(found.all.rmse[0]));
}

TEST(CompareForces, HasNoLagWhereTheSegmentIsTooShortForIt) {
  EXPECT_TRUE(std::isnan(compare_forces({pair_of(150, swing, swing, steady)}, kTick).value().lag[0]));
}

TEST(CompareForces, RefusesWhatCannotBeCompared) {
  ForcePair pair = pair_of(100, swing, swing, steady);
  EXPECT_FALSE(compare_forces({pair}, 0.0));
  EXPECT_FALSE(compare_forces({pair}, kTick, {.rest_speed = -1.0}));
  EXPECT_FALSE(compare_forces({}, kTick));
  pair.measured(31, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(compare_forces({pair}, kTick).error().message,
              AllOf(HasSubstr("measured"), HasSubstr("axis 1"), HasSubstr("row 31")));
  pair.measured.conservativeResize(99, 1);
  EXPECT_THAT(compare_forces({pair}, kTick).error().message, AllOf(HasSubstr("100×1"), HasSubstr(" 99×1")));
}

}  // namespace
}  // namespace mbk::analyse
