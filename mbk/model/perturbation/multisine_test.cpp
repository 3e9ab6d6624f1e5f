#include "mbk/model/perturbation/multisine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mbk::perturbation {
namespace multisine_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kPi = std::numbers::pi;

TEST(Multisine, OneLineIsASine) {
  const Multisine sine = Multisine::create(2.0, {{3, 0.5, kPi / 6.0}}).value();
  const double omega = 3.0 * kPi;
  EXPECT_NEAR(sine.at(0.0).value, 0.25, 4 * kEps);
  EXPECT_NEAR(sine.at(0.0).first, 0.5 * omega * std::sqrt(0.75), 32 * kEps);
  EXPECT_NEAR(sine.at(0.0).second, -0.25 * omega * omega, 64 * kEps);
}

TEST(Multisine, DerivativesAgreeWithCentralDifferences) {
  const Multisine signal = Multisine::with_random_phases(10.0, {1, 7, 29}, {1.0, 0.7, 0.3}, 4).value();
  const double step = 1e-4;
  for (double t = -3.0; t < 25.0; t += 0.37) {
    const Jet<double> here = signal.at(t), before = signal.at(t - step), after = signal.at(t + step);
    // Truncation h²/6 |r'''| ≤ 3.4e-6 and h²/6 |r''''| ≤ 6e-5 with ω ≤ 18.2 rad/s
    EXPECT_NEAR((after.value - before.value) / (2.0 * step), here.first, 4e-6) << t;
    EXPECT_NEAR((after.first - before.first) / (2.0 * step), here.second, 7e-5) << t;
  }
}

TEST(Multisine, RepeatsAfterItsPeriod) {
  const Multisine signal = Multisine::with_random_phases(10.0, {1, 29}, {1.0, 1.0}, 4).value();
  EXPECT_NEAR(signal.at(1234567.25 * 10.0).value, signal.at(2.5).value, 1e-9);
}

TEST(Multisine, SameSeedSamePhasesAndOtherStreamOthers) {
  const auto phase = [](std::uint64_t seed, std::uint32_t stream) {
    return Multisine::with_random_phases(1.0, {1}, {1.0}, seed, stream).value().lines()[0].phase;
  };
  EXPECT_EQ(phase(1, 0), phase(1, 0));
  EXPECT_NE(phase(1, 0), phase(2, 0));
  EXPECT_NE(phase(1, 0), phase(1, 1));
}

TEST(Multisine, RefusesWhatIsNoSumOfHarmonics) {
  EXPECT_FALSE(Multisine::create(0.0, {{1, 1.0, 0.0}}));
  EXPECT_FALSE(Multisine::create(1.0, {}));
  EXPECT_FALSE(Multisine::create(1.0, {{0, 1.0, 0.0}}));
  EXPECT_FALSE(Multisine::create(1.0, {{100'001, 1.0, 0.0}}));
  EXPECT_FALSE(Multisine::create(1.0, {{2, 1.0, 0.0}, {2, 1.0, 0.0}}));
  EXPECT_FALSE(Multisine::create(1.0, {{1, NAN, 0.0}}));
  EXPECT_FALSE(Multisine::with_random_phases(1.0, {1, 2}, {1.0}, 1));
}

}  // namespace multisine_test
}  // namespace mbk::perturbation
