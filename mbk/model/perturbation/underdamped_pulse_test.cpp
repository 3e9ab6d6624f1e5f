#include "mbk/model/perturbation/underdamped_pulse.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace mbk::perturbation {
namespace underdamped_pulse_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(UnderdampedPulse, SatisfiesItsDifferentialEquation) {
  const UnderdampedPulse pulse = UnderdampedPulse::create(0.005).value();
  for (double t = 0.0; t < 2.0; t += 0.013) {
    const Jet<double> r = pulse.at(t);
    const double residual = r.second + 2.0 * 0.1 * 15.0 * r.first + 225.0 * (r.value - 0.005);
    EXPECT_NEAR(residual, 0.0, 64 * kEps * 225.0 * 0.005) << t;
  }
}

TEST(UnderdampedPulse, DerivativesAgreeWithCentralDifferences) {
  const UnderdampedPulse pulse = UnderdampedPulse::create(1.0).value();
  const double step = 1e-4;
  for (double t = 0.01; t < 2.0; t += 0.013) {
    const Jet<double> r = pulse.at(t), before = pulse.at(t - step), after = pulse.at(t + step);
    EXPECT_NEAR((after.value - before.value) / (2.0 * step), r.first, 6e-6) << t;   // h²/6 ωₙ³
    EXPECT_NEAR((after.first - before.first) / (2.0 * step), r.second, 9e-5) << t;  // h²/6 ωₙ⁴
  }
}

TEST(UnderdampedPulse, StartsFromRestAndOvershootsAsItsDampingSays) {
  const UnderdampedPulse pulse = UnderdampedPulse::create(0.005).value();
  EXPECT_EQ(pulse.at(-1e-9).second, 0.0);
  EXPECT_EQ(pulse.at(0.0).value, 0.0);
  EXPECT_EQ(pulse.at(0.0).first, 0.0);
  EXPECT_NEAR(pulse.at(0.0).second, 1.125, 4 * kEps);
  const double root = std::sqrt(1.0 - 0.01);
  const double peak = std::numbers::pi / (15.0 * root);
  EXPECT_NEAR(pulse.at(peak).value, 0.005 * (1.0 + std::exp(-0.1 * std::numbers::pi / root)), 1e-16);
  EXPECT_LT(pulse.at(peak).value, 0.011);  // "up to 11 mm" (§3.4)
}

TEST(UnderdampedPulse, RefusesWhatIsNotUnderdamped) {
  EXPECT_FALSE(UnderdampedPulse::create(1.0, 1.0));
  EXPECT_FALSE(UnderdampedPulse::create(1.0, 0.0));
  EXPECT_FALSE(UnderdampedPulse::create(1.0, 0.1, RadPerSec(0.0)));
  EXPECT_FALSE(UnderdampedPulse::create(NAN));
}

PulseSchedule schedule(std::uint64_t seed) {
  PulseSchedule::Options options;
  options.seed = seed;
  return PulseSchedule::create(options).value();
}

TEST(PulseSchedule, HasEachDirectionTwiceWithTimesInRange) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const PulseSchedule pulses = schedule(seed);
    std::map<int, int> counts;
    double previous = 16.0;
    for (const PulseSchedule::Pulse& pulse : pulses.pulses()) {
      ++counts[pulse.direction];
      EXPECT_GE(pulse.onset - previous, 2.0) << "seed " << seed;
      EXPECT_LE(pulse.onset - previous, 7.0) << "seed " << seed;
      EXPECT_GE(pulse.offset - pulse.onset, 1.5 - 1e-13) << "seed " << seed;
      EXPECT_LE(pulse.offset - pulse.onset, 2.0 + 1e-13) << "seed " << seed;
      EXPECT_NEAR(pulse.direction_B.x(), std::cos(pulse.angle), 2 * kEps);
      EXPECT_NEAR(pulse.direction_B.y(), std::sin(pulse.angle), 2 * kEps);
      previous = pulse.offset;
    }
    EXPECT_EQ(counts.size(), 8u) << "seed " << seed;
    for (const auto& [direction, count] : counts) EXPECT_EQ(count, 2) << direction << ", seed " << seed;
  }
}

TEST(PulseSchedule, InSpaceHasEachCombinationOfSignsTwice) {
  PulseSchedule::Options options;
  options.axes = 3;
  const PulseSchedule pulses = PulseSchedule::create(options).value();
  std::map<std::array<int, 3>, int> count;
  for (const PulseSchedule::Pulse& pulse : pulses.pulses()) {
    ASSERT_EQ(pulse.direction_B.size(), 3);
    EXPECT_NEAR(pulse.direction_B.norm(), 1.0, 4 * kEps);
    const double largest = pulse.direction_B.cwiseAbs().maxCoeff();
    std::array<int, 3> signs{};
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double sign = pulse.direction_B[i] / largest;
      signs[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(sign));
      EXPECT_NEAR(sign, std::round(sign), 4 * kEps);
    }
    ++count[signs];
    EXPECT_NEAR((pulses.reference(pulse.onset) - 0.005 * pulse.direction_B).norm(), 0.0, kEps);
  }
  EXPECT_EQ(count.size(), 26u);
  for (const auto& [signs, times] : count) EXPECT_EQ(times, 2);
}

TEST(PulseSchedule, OrderComesFromTheSeed) {
  const auto order = [](std::uint64_t seed) {
    const PulseSchedule pulses = schedule(seed);
    std::vector<int> directions;
    for (const PulseSchedule::Pulse& pulse : pulses.pulses()) directions.push_back(pulse.direction);
    return directions;
  };
  EXPECT_EQ(order(1), order(1));
  EXPECT_NE(order(1), order(2));
}

TEST(PulseSchedule, ReferenceIsExactlyZeroButForThePulses) {
  const PulseSchedule pulses = schedule(7);
  for (const PulseSchedule::Pulse& pulse : pulses.pulses()) {
    EXPECT_EQ(pulses.reference(std::nextafter(pulse.onset, 0.0)), Eigen::Vector2d(0.0, 0.0));
    EXPECT_EQ(pulses.reference(pulse.onset), 0.005 * pulse.direction_B);
    EXPECT_EQ(pulses.reference(std::nextafter(pulse.offset, 0.0)), 0.005 * pulse.direction_B);
    EXPECT_EQ(pulses.reference(pulse.offset), Eigen::Vector2d(0.0, 0.0));
  }
}

TEST(PulseSchedule, ReturnsGentlyAndRestsBeforeTheNextOnset) {
  const PulseSchedule pulses = schedule(7);
  for (const PulseSchedule::Pulse& pulse : pulses.pulses()) {
    const double step = 1e-7;
    const Jet<AxesVector> before = pulses.at(pulse.offset - step), after = pulses.at(pulse.offset + step);
    // No jump at the offset: |ṙ| ≤ 0.06 m/s, |r̈| ≤ 1.2 m/s², |r⃛| ≤ 40 m/s³ over 2·step
    EXPECT_NEAR((after.value - before.value).norm(), 0.0, 0.06 * 2.0 * step);
    EXPECT_NEAR((after.first - before.first).norm(), 0.0, 1.2 * 2.0 * step);
    EXPECT_NEAR((after.second - before.second).norm(), 0.0, 40.0 * 2.0 * step);
    EXPECT_EQ(pulses.at(pulse.offset + 1.0).value, Eigen::Vector2d(0.0, 0.0));
    EXPECT_EQ(pulses.at(pulse.offset + 1.0).second, Eigen::Vector2d(0.0, 0.0));
  }
}

TEST(PulseSchedule, RefusesAReturnLongerThanThePause) {
  PulseSchedule::Options options;
  options.return_duration = 2.5;
  const auto refused = PulseSchedule::create(options);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("2.5 s"), std::string::npos) << refused.error().message;
  EXPECT_NE(refused.error().message.find(" 2 s"), std::string::npos) << refused.error().message;
}

}  // namespace underdamped_pulse_test
}  // namespace mbk::perturbation
