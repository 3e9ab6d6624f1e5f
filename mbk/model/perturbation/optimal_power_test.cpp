#include "mbk/model/perturbation/optimal_power.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::perturbation {
namespace optimal_power_test {

const std::vector<int> kLaboratory = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29};
const NominalImpedance kArm{1.9, 10.6, 125.0};  // y axis of a relaxed arm

OptimalPowerOptions options_of(LimitedSignal limited, double floor) {
  return {limited, kArm, floor};
}

/// ln det of the information, written out from a sampled regression: one period of [ẍ ẋ x] on 1000 samples.
double sampled_log_determinant(const std::vector<int>& harmonics, const Vector& shares, const OptimalPowerOptions& o) {
  std::vector<Multisine::Line> lines;
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    lines.push_back({harmonics[i], std::sqrt(2.0 * shares[static_cast<Index>(i)]), 0.7 * static_cast<double>(i)});
  }
  for (Multisine::Line& line : lines) {
    const double omega = 2.0 * std::numbers::pi * line.harmonic / 10.0;
    const auto& [M, B, K] = *o.nominal;
    line.amplitude /= o.limited == LimitedSignal::position   ? 1.0
                      : o.limited == LimitedSignal::velocity ? omega
                                                             : std::hypot(K - M * omega * omega, B * omega);
  }
  const Multisine position = Multisine::create(10.0, lines).value();
  Eigen::Matrix3d I = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 1000; ++n) {
    const Jet<double> x = position.at(0.01 * n);
    const Eigen::Vector3d z(x.second, x.first, x.value);
    I += z * z.transpose() / 1000.0;
  }
  return std::log(I.determinant());
}

TEST(OptimalPower, PutsOneThirdAtTheLowestAndTwoThirdsAtTheHighestLineForLimitedPosition) {
  const OptimalPower power = optimal_power(10.0, kLaboratory, options_of(LimitedSignal::position, 0.0)).value();
  const double r = 1.0 / (29.0 * 29.0 - 1.0);
  const double q = (1.0 - r + std::sqrt(1.0 + r + r * r)) / 3.0;
  const double tolerance = 2e-4;  // ln det is flat: a gap of 1e-7 allows √(2e-7/4.5) in the shares
  EXPECT_NEAR(power.shares[9], q, tolerance);
  EXPECT_NEAR(power.shares[0], 1.0 - q, tolerance);
  EXPECT_NEAR(q, 2.0 / 3.0, 1e-3);
}

TEST(OptimalPower, FollowsItsClosedFormWhereTheBandIsNarrow) {
  const OptimalPower power = optimal_power(10.0, {10, 12, 14}, options_of(LimitedSignal::position, 0.0)).value();
  const double r = 100.0 / 96.0;
  EXPECT_NEAR(power.shares[2], (1.0 - r + std::sqrt(1.0 + r + r * r)) / 3.0, 2e-4);
}

TEST(OptimalPower, HasNoSensitivityAboveTheNumberOfParameters) {
  for (const LimitedSignal limited : {LimitedSignal::position, LimitedSignal::velocity, LimitedSignal::force}) {
    const OptimalPower power = optimal_power(10.0, kLaboratory, options_of(limited, 0.0)).value();
    EXPECT_NEAR(power.shares.sum(), 1.0, 1e-12);
    EXPECT_NEAR(power.shares.dot(power.sensitivity), 3.0, 1e-9);
    EXPECT_LE(power.sensitivity.maxCoeff(), 3.0 + 1e-6);
    for (Index k = 0; k < power.shares.size(); ++k) {
      if (power.shares[k] > 1e-3) {
        EXPECT_NEAR(power.sensitivity[k], 3.0, 1e-3) << k;
      }
    }
  }
}

TEST(OptimalPower, NoOtherSharesHaveALargerDeterminant) {
  numeric::Random random(1);
  for (const LimitedSignal limited : {LimitedSignal::position, LimitedSignal::velocity, LimitedSignal::force}) {
    for (const double floor : {0.0, 0.02}) {
      const OptimalPowerOptions options = options_of(limited, floor);
      const OptimalPower power = optimal_power(10.0, kLaboratory, options).value();
      EXPECT_GE(power.shares.minCoeff(), floor);
      const double best = sampled_log_determinant(kLaboratory, power.shares, options);
      for (int trial = 0; trial < 30; ++trial) {
        Vector other(10);
        for (double& share : other) share = std::pow(random.uniform(), 4);  // from nearly equal to nearly one line
        other *= (1.0 - 10.0 * floor) / other.sum();
        other.array() += floor;
        const double mix = trial % 2 == 0 ? 1.0 : 0.1;  // far away, and near
        other = (1.0 - mix) * power.shares + mix * other;
        EXPECT_LE(sampled_log_determinant(kLaboratory, other, options), best + 1e-6) << trial;
      }
    }
  }
}

TEST(OptimalPower, KeepsTheFloorAtEveryLineAndIsOptimalAboveIt) {
  const OptimalPower power = optimal_power(10.0, kLaboratory).value();
  for (Index k = 1; k < 9; ++k) EXPECT_NEAR(power.shares[k], 0.02, 1e-3) << k;
  EXPECT_GT(power.shares[9], 1.8 * power.shares[0]);
  const double best = power.sensitivity.maxCoeff();
  EXPECT_NEAR(power.sensitivity[0], best, 1e-3);
  EXPECT_NEAR(power.sensitivity[9], best, 1e-3);
}

TEST(OptimalPower, RefusesWhatCannotBeDesigned) {
  EXPECT_FALSE(optimal_power(0.0, kLaboratory));
  EXPECT_FALSE(optimal_power(10.0, {3}, {.floor = 0.0}));
  EXPECT_FALSE(optimal_power(10.0, {3, 3, 4, 5, 6}));
  EXPECT_FALSE(optimal_power(10.0, {1, 2, 3, 4}));
  EXPECT_FALSE(optimal_power(10.0, kLaboratory, {.floor = 0.1}));
  EXPECT_FALSE(optimal_power(10.0, kLaboratory, {.floor = NAN}));
  EXPECT_FALSE(optimal_power(10.0, kLaboratory, {.limited = LimitedSignal::force}));
  EXPECT_FALSE(
      optimal_power(10.0, kLaboratory, {.limited = LimitedSignal::force, .nominal = NominalImpedance{0, 0, 0}}));
}

}  // namespace optimal_power_test
}  // namespace mbk::perturbation
