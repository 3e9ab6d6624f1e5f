#include "mbk/model/perturbation/random_binary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace mbk::perturbation {
namespace random_binary_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();

RandomBinary sequence(std::uint64_t seed, double switching_time = 0.3, double duration = 12.0) {
  RandomBinaryOptions options;
  options.switching_time = switching_time;
  options.seed = seed;
  return RandomBinary::create(options, duration).value();
}

TEST(RandomBinary, HasTwoValuesThatChangeOnlyAtSwitches) {
  const RandomBinary binary = sequence(3);
  std::set<double> values;
  for (std::size_t i = 0; i < binary.size(); ++i) {
    const double start = static_cast<double>(i) * 0.3, end = static_cast<double>(i + 1) * 0.3;
    values.insert(binary.reference(start));
    EXPECT_EQ(binary.reference(std::nextafter(end, 0.0)), binary.reference(start)) << i;
    EXPECT_EQ(binary.reference(0.5 * (start + end)), binary.reference(start)) << i;
  }
  EXPECT_EQ(values, (std::set<double>{-2.0, 2.0}));
  EXPECT_EQ(binary.reference(-1e-9), 0.0);
}

TEST(RandomBinary, SatisfiesTheDifferentialEquationOfTheFilter) {
  const RandomBinary binary = sequence(3);
  for (double t = 0.0; t < 12.0; t += 0.0137) {
    const Jet<double> y = binary.at(t);
    const double residual = y.second + 3.0 * y.first + 225.0 * (y.value - binary.reference(t));
    EXPECT_NEAR(residual, 0.0, 256 * kEps * 225.0 * 6.0) << t;  // |y| stays below 6 N
  }
}

TEST(RandomBinary, AgreesWithASlowIntegrationOfTheFilter) {
  const RandomBinary binary = sequence(5);
  const double step = 1e-4;  // Runge–Kutta of 4th order: (ωₙ h)⁵ for each step, 3e-13 over 3 s; 0.3 s is 3000 steps
  double y = 0.0, v = 0.0;
  for (int k = 0; k < 30000; ++k) {
    const double u = binary.reference((k + 0.5) * step);
    const auto acceleration = [&](double value, double rate) { return 225.0 * (u - value) - 3.0 * rate; };
    const double k1 = acceleration(y, v);
    const double v2 = v + 0.5 * step * k1, k2 = acceleration(y + 0.5 * step * v, v2);
    const double v3 = v + 0.5 * step * k2, k3 = acceleration(y + 0.5 * step * v2, v3);
    const double v4 = v + step * k3, k4 = acceleration(y + step * v3, v4);
    y += step / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  EXPECT_NEAR(binary.at(3.0).value, y, 1e-9);
  EXPECT_NEAR(binary.at(3.0).first, v, 1e-8);
}

TEST(RandomBinary, IsTheSumOfTheStepsBehindIt) {
  const RandomBinary binary = sequence(7);
  const UnderdampedFilter filter = UnderdampedFilter::create().value();
  for (const double t : {0.1, 1.234, 5.0, 11.99}) {
    double sum = 0.0, before = 0.0;
    for (std::size_t i = 0; i < binary.size() && static_cast<double>(i) * 0.3 <= t; ++i) {
      const double start = static_cast<double>(i) * 0.3, input = binary.reference(start);
      sum += filter.response(0.0, 0.0, input - before, t - start).value;
      before = input;
    }
    EXPECT_NEAR(binary.at(t).value, sum, 1e-12) << t;  // 40 terms of up to 8 N
  }
}

TEST(RandomBinary, ValueAndRateAreContinuousAtASwitch) {
  const RandomBinary binary = sequence(3);
  for (std::size_t i = 0; i < binary.size(); ++i) {
    const double t = static_cast<double>(i) * 0.3;
    EXPECT_NEAR(binary.at(std::nextafter(t, -1.0)).value, binary.at(t).value, 1e-12) << i;
    EXPECT_NEAR(binary.at(std::nextafter(t, -1.0)).first, binary.at(t).first, 1e-11) << i;
  }
}

TEST(RandomBinary, HasAsManyOfBothSignsWhereZeroMeanIsAskedFor) {
  RandomBinaryOptions options;
  options.zero_mean = true;
  options.switching_time = 0.1;
  for (options.seed = 1; options.seed <= 20; ++options.seed) {
    const RandomBinary binary = RandomBinary::create(options, 5.0).value();
    double sum = 0.0;
    for (int i = 0; i < 50; ++i) sum += binary.reference((i + 0.5) * 0.1);
    EXPECT_EQ(sum, 0.0) << options.seed;
  }
  const auto refused = RandomBinary::create(options, 5.1);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("5.2 s"), std::string::npos);
}

TEST(RandomBinary, SignsAreIndependentOfEachOther) {
  const RandomBinary binary = sequence(11, 0.01, 100.0);
  double mean = 0.0, neighbours = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double here = binary.reference((i + 0.5) * 0.01) / 2.0;
    mean += here / 10000.0;
    if (i > 0) neighbours += here * binary.reference((i - 0.5) * 0.01) / 2.0 / 10000.0;
  }
  EXPECT_LT(std::abs(mean), 0.04);  // four standard deviations, 1/√10000 each
  EXPECT_LT(std::abs(neighbours), 0.04);
}

TEST(RandomBinary, SequenceComesFromTheSeed) {
  const auto signs = [](std::uint64_t seed) {
    const RandomBinary binary = sequence(seed);
    std::vector<double> values;
    for (int i = 0; i < 40; ++i) values.push_back(binary.reference((i + 0.5) * 0.3));
    return values;
  };
  EXPECT_EQ(signs(1), signs(1));
  EXPECT_NE(signs(1), signs(2));
}

TEST(RandomBinary, BandwidthIsThatOfTheFilterForFastSwitchingAndOfTheSincForSlow) {
  EXPECT_NEAR(sequence(1, 1e-3, 1.0).bandwidth().value, 3.68, 0.01);
  // ½ = sinc²(f T): f T = 0.4429; |G|² is within 1 % of 1 at 0.044 Hz, and later lobes stay below ½ of the peak even
  // at the resonance, where 25 sinc² ≤ 25/(π 2.39 10)² = 0.005.
  EXPECT_NEAR(sequence(1, 10.0, 100.0).bandwidth().value, 0.0443, 0.0005);
}

TEST(RandomBinary, RefusesWhatIsNoSequence) {
  const auto refused = [](auto&& change, double duration = 10.0) {
    RandomBinaryOptions options;
    change(options);
    return !RandomBinary::create(options, duration).has_value();
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& o) { o.amplitude = 0.0; }));
  EXPECT_TRUE(refused([](auto& o) { o.amplitude = INFINITY; }));
  EXPECT_TRUE(refused([](auto& o) { o.switching_time = 0.0; }));
  EXPECT_TRUE(refused([](auto& o) { o.switching_time = 11.0; }));
  EXPECT_TRUE(refused([](auto& o) { o.switching_time = 1e-9; }));
  EXPECT_TRUE(refused([](auto& o) { o.damping_ratio = 1.0; }));
  EXPECT_TRUE(refused([](auto& o) { o.natural_frequency = RadPerSec(NAN); }));
  EXPECT_TRUE(refused([](auto&) {}, NAN));
}

}  // namespace random_binary_test
}  // namespace mbk::perturbation
