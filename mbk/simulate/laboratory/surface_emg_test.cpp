#include "mbk/simulate/laboratory/surface_emg.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/dsp/fourier.h"

namespace mbk::laboratory {
namespace surface_emg_test {

constexpr Hertz kRate{2000.0};
constexpr Index kSamples = 40000;

Vector signal(const SurfaceEmgOptions& options, double activation, std::uint64_t seed = 1, std::uint32_t channel = 0) {
  SurfaceEmg emg = SurfaceEmg::create(options, kRate, seed, channel).value();
  Vector v(kSamples);
  for (double& value : v) value = emg.step(activation);
  return v;
}

double rms(const Vector& v) {
  return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

/// Share of the power from `low` to `high`.
double share(const Vector& v, double low, double high) {
  const Eigen::VectorXcd spectrum = dsp::fourier_transform(v);
  double inside = 0.0, all = 0.0;
  for (Index k = 1; k < v.size() / 2; ++k) {
    const double f = kRate.value * static_cast<double>(k) / static_cast<double>(v.size());
    const double power = std::norm(spectrum[k]);
    all += power;
    if (f >= low && f <= high) inside += power;
  }
  return inside / all;
}

/// 20 s of 430 Hz have 2·20·430 independent values: the rms has a standard error of 0.54 %.
constexpr double kFourErrors = 4 * 0.0054;

TEST(SurfaceEmg, RmsIsProportionalToTheActivation) {
  for (const double activation : {0.05, 0.4, 1.0}) {
    EXPECT_NEAR(rms(signal({.noise = 0.0}, activation)) / (500e-6 * activation), 1.0, kFourErrors);
  }
  EXPECT_EQ(rms(signal({.noise = 0.0}, 0.0)), 0.0);
}

/// Share of the power from `low` to `high`, of white noise behind both Butterworth filters.
double expected_share(double low, double high) {
  const auto warped = [](double f) { return std::tan(std::numbers::pi * f / kRate.value); };
  double inside = 0.0, all = 0.0;
  for (int k = 0; k < 10000; ++k) {
    const double f = 0.1 * k + 0.05;
    const double power =
        1.0 / (1.0 + std::pow(warped(20.0) / warped(f), 8)) / (1.0 + std::pow(warped(f) / warped(450.0), 8));
    all += power;
    if (f >= low && f <= high) inside += power;
  }
  return inside / all;
}

TEST(SurfaceEmg, PowerIsWithinTheBand) {
  const Vector v = signal({.noise = 0.0}, 1.0);
  EXPECT_GT(share(v, 15.0, 550.0), 0.99);
  constexpr double kChance = 0.03;  // of 200 Hz over 20 s: four standard errors of 1.1 % of each of both
  for (const auto& [low, high] : {std::pair{20.0, 450.0}, {100.0, 300.0}, {400.0, 500.0}}) {
    EXPECT_NEAR(share(v, low, high), expected_share(low, high), kChance) << low;
  }
  EXPECT_LT(share(v, 0.0, 10.0), 1e-3);
  EXPECT_LT(share(v, 600.0, 1000.0), 5e-3);
}

TEST(SurfaceEmg, HasElectrodeNoiseAndMainsHum) {
  EXPECT_NEAR(rms(signal({.noise = 5e-6}, 0.0)), 5e-6, 5e-6 * 4.0 / std::sqrt(2.0 * kSamples));
  const Vector hum = signal({.noise = 0.0, .hum = 1e-5, .mains = Hertz(60.0)}, 0.0);
  for (Index k = 0; k < 100; ++k) {
    EXPECT_NEAR(hum[k], 1e-5 * std::sin(2.0 * std::numbers::pi * 60.0 * static_cast<double>(k + 1) / 2000.0), 1e-15);
  }
}

TEST(SurfaceEmg, ChannelsAreIndependentAndASeedRepeatsThem) {
  const Vector biceps = signal({}, 0.1), triceps = signal({}, 0.1, 1, 1);
  EXPECT_EQ(biceps, signal({}, 0.1));
  EXPECT_NE(biceps, signal({}, 0.1, 2));
  const double correlation = biceps.dot(triceps) / (biceps.norm() * triceps.norm());
  EXPECT_LT(std::abs(correlation), 4.0 / std::sqrt(2.0 * 20.0 * 430.0));
}

TEST(SurfaceEmg, RefusesABandThatTheRateCannotHold) {
  EXPECT_FALSE(SurfaceEmg::create({}, Hertz(900.0), 1, 0));
  EXPECT_TRUE(SurfaceEmg::create({}, Hertz(1000.0), 1, 0));
  EXPECT_FALSE(SurfaceEmg::create({.lowest = Hertz(500.0)}, kRate, 1, 0));
  EXPECT_FALSE(SurfaceEmg::create({.largest = -1.0}, kRate, 1, 0));
  EXPECT_FALSE(SurfaceEmg::create({}, Hertz(0.0), 1, 0));
}

}  // namespace surface_emg_test
}  // namespace mbk::laboratory
