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

// The slow plain twin: each sine by itself. Harmonics in any order, close together, far apart and as high as they may
// be.
TEST(Multisine, IsTheSumOfItsSines) {
  constexpr double kPeriod = 7.0;
  const std::vector<Multisine::Line> lines = {
      {40, 0.2, 1.1}, {1, 0.5, 0.3}, {2, -0.1, 5.9}, {977, 0.05, 2.2}, {Multisine::kHighestHarmonic, 0.01, 4.0}};
  const Multisine signal = Multisine::create(kPeriod, lines).value();
  for (const double t : {0.0, 0.3, 3.5, 6.999, -2.2, 1000.7}) {
    const double turns = std::fmod(t, kPeriod) / kPeriod;
    for (const auto& [harmonic, amplitude, phase] : lines) {
      const Multisine one = Multisine::create(kPeriod, {{harmonic, amplitude, phase}}).value();
      const double omega = 2.0 * kPi * harmonic / kPeriod;
      const double angle = 2.0 * kPi * std::fmod(harmonic * turns, 1.0) + phase;
      const double rounding = 16 * kEps * harmonic * std::abs(amplitude);  // of the angle
      EXPECT_NEAR(one.at(t).value, amplitude * std::sin(angle), rounding) << harmonic << " at " << t;
      EXPECT_NEAR(one.at(t).first, omega * amplitude * std::cos(angle), omega * rounding);
      EXPECT_NEAR(one.at(t).second, -omega * omega * amplitude * std::sin(angle), omega * omega * rounding);
    }
    Jet<double> sum{0.0, 0.0, 0.0};
    for (const Multisine::Line& line : lines) {
      const Jet<double> one = Multisine::create(kPeriod, {line}).value().at(t);
      sum.value += one.value;
      sum.first += one.first;
      sum.second += one.second;
    }
    const double rounding = 64 * kEps * Multisine::kHighestHarmonic * 0.01;
    const double highest = 2.0 * kPi * Multisine::kHighestHarmonic / kPeriod;
    EXPECT_NEAR(signal.at(t).value, sum.value, rounding) << t;
    EXPECT_NEAR(signal.at(t).first, sum.first, highest * rounding) << t;
    EXPECT_NEAR(signal.at(t).second, sum.second, highest * highest * rounding) << t;
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
  EXPECT_FALSE(Multisine::create(1.0, {{1, std::numeric_limits<double>::quiet_NaN(), 0.0}}));
  EXPECT_FALSE(Multisine::with_random_phases(1.0, {1, 2}, {1.0}, 1));
}

}  // namespace multisine_test
}  // namespace mbk::perturbation
