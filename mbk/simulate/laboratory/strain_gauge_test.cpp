#include "mbk/simulate/laboratory/strain_gauge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <set>

namespace mbk::laboratory {
namespace strain_gauge_test {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kTick = 1e-3;

/// No noise, no filter, no converter.
StrainGaugeOptions plain() {
  StrainGaugeOptions options;
  options.bridge_noise = 0.0;
  options.cutoff = Hertz(0.0);
  options.converter_bits = 0;
  return options;
}

Vector2d first_reading(const StrainGaugeOptions& options, const Vector2d& force) {
  return StrainGauge::create(options, kTick, 1).value().read(force);
}

TEST(StrainGauge, WithEverythingOffReadsTheForce) {
  const Vector2d force(7.3, -21.9);
  EXPECT_LT((first_reading(plain(), force) - force).norm(), 1e-14);  // to volts and back: some eps of 22 N
}

TEST(StrainGauge, ReadsInStepsOfSlopeTimesTheConvertersVoltStep) {
  StrainGaugeOptions options = plain();
  options.converter_bits = 12;
  std::set<long> codes;
  const double step = 8.56 * 20.0 / 4096.0;
  EXPECT_NEAR(step, 0.042, 5e-4);  // [N]
  double square = 0.0, smallest_jump = 1.0, last = first_reading(options, {-5.0, 0.0})[0];
  constexpr int kCount = 20000;
  StrainGauge gauge = StrainGauge::create(options, kTick, 1).value();
  for (int k = 0; k < kCount; ++k) {
    const double force = -5.0 + 10.0 * k / kCount;
    const double reading = gauge.read({force, 0.0})[0];
    ASSERT_LE(std::abs(reading - force), 0.5 * step * (1.0 + 1e-9)) << force;
    square += std::pow(reading - force, 2) / kCount;
    if (reading != last) smallest_jump = std::min(smallest_jump, std::abs(reading - last));
    last = reading;
  }
  EXPECT_NEAR(smallest_jump, step, 1e-9);
  EXPECT_NEAR(std::sqrt(square), step / std::sqrt(12.0), 0.02 * step);
  EXPECT_EQ(gauge.clipped_samples(), 0);
}

TEST(StrainGauge, ClipsAtTheLastCodeAndCountsTheSamples) {
  StrainGaugeOptions options = plain();
  options.converter_bits = 12;
  StrainGauge gauge = StrainGauge::create(options, kTick, 1).value();
  // x: 10 V stands for 0.54 − 85.6 N and −10 V for 0.54 + 85.6 N; the highest code is one step short of 10 V
  EXPECT_NEAR(gauge.read({200.0, 0.0})[0], 0.54 + 85.6, 1e-12);
  EXPECT_NEAR(gauge.read({-200.0, 0.0})[0], 0.54 - 85.6 * 2047.0 / 2048.0, 1e-12);
  EXPECT_EQ(gauge.clipped_samples(), 2);
  (void)gauge.read({80.0, -70.0});
  EXPECT_EQ(gauge.clipped_samples(), 2);
  (void)gauge.read({200.0, 200.0});
  EXPECT_EQ(gauge.clipped_samples(), 3);  // both axes, one sample
}

TEST(StrainGauge, LeverArmScalesTheSlopeAlone) {
  StrainGaugeOptions longer = plain();
  longer.arm = 1.25 * longer.calibration_arm;  // its user does not know
  EXPECT_LT(first_reading(longer, Vector2d::Zero()).norm(), 1e-14);
  EXPECT_LT((first_reading(longer, {8.0, -4.0}) - 1.25 * Vector2d(8.0, -4.0)).norm(), 1e-13);
  longer.assumed_arm = longer.arm;  // now he does, eq. E.3
  EXPECT_LT((first_reading(longer, {8.0, -4.0}) - Vector2d(8.0, -4.0)).norm(), 1e-13);
}

TEST(StrainGauge, WrongOffsetAddsTheSameToEveryForce) {
  StrainGaugeOptions options = plain();
  options.assumed_offset = options.offset + Vector2d(0.5, -0.3);
  for (const Vector2d& force : {Vector2d(0.0, 0.0), Vector2d(30.0, -10.0)}) {
    EXPECT_LT((first_reading(options, force) - force - Vector2d(0.5, -0.3)).norm(), 1e-13);
  }
}

TEST(StrainGauge, CrosstalkGivesEachAxisAPartOfTheOther) {
  StrainGaugeOptions options = plain();
  options.crosstalk = {0.025, -0.01};
  EXPECT_LT((first_reading(options, {20.0, 0.0}) - Vector2d(20.0, -0.2)).norm(), 1e-13);
  EXPECT_LT((first_reading(options, {0.0, 20.0}) - Vector2d(0.5, 20.0)).norm(), 1e-13);
}

/// Gain and phase of the chain for a sine, by correlation over whole periods once it has settled.
std::complex<double> response(const StrainGaugeOptions& options, double frequency) {
  StrainGauge gauge = StrainGauge::create(options, kTick, 1).value();
  const int settling = 2000, periods = 20;
  const int count = static_cast<int>(std::lround(periods / (frequency * kTick)));
  std::complex<double> sum = 0.0;
  for (int k = 0; k < settling + count; ++k) {
    const double angle = 2.0 * M_PI * frequency * k * kTick;
    const double reading = gauge.read({std::sin(angle), 0.0})[0];
    if (k >= settling) sum += reading * std::polar(1.0, -angle);
  }
  return sum * std::complex<double>(0.0, 2.0) / static_cast<double>(count);
}

TEST(StrainGauge, FilterHasHalfThePowerAtItsCutoffAndDelaysSlowForces) {
  StrainGaugeOptions options = plain();
  options.cutoff = Hertz(48.2);
  // 20 periods of 48.2 Hz are 414.94 samples: the missing 0.06 leave 2e-4
  EXPECT_NEAR(std::abs(response(options, 48.2)), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(std::abs(response(options, 2.0)), 1.0, 1e-6);
  const double delay = StrainGauge::create(options, kTick, 1)->delay();
  EXPECT_NEAR(delay, 8.56e-3, 5e-6);
  EXPECT_NEAR(-std::arg(response(options, 2.0)) / (2.0 * M_PI * 2.0), delay, 2e-5);  // grows with frequency
}

TEST(StrainGauge, IsSettledAtTheFirstReading) {
  StrainGaugeOptions options = plain();
  options.cutoff = Hertz(48.2);
  StrainGauge gauge = StrainGauge::create(options, kTick, 1).value();
  for (int k = 0; k < 100; ++k) ASSERT_NEAR(gauge.read({15.0, -5.0})[0], 15.0, 1e-10) << k;
}

TEST(StrainGauge, NoiseBehindTheFilterIsThatOfTheApparatusAtAnyRate) {
  // Noise bandwidth of a Butterworth filter of order n: f_c (π/2n)/sin(π/2n), 49.46 Hz; 1.66e-4 V/√Hz are 0.01 N
  for (const double rate : {1000.0, 4000.0}) {
    StrainGaugeOptions options;
    options.converter_bits = 0;
    StrainGauge gauge = StrainGauge::create(options, 1.0 / rate, 1).value();
    const int count = static_cast<int>(400.0 * rate);
    double square = 0.0;
    for (int k = 0; k < count; ++k) square += std::pow(gauge.read({0.0, 0.0})[0], 2) / count;
    const double expected = 1.66e-4 * 8.56 * std::sqrt(48.2 * (M_PI / 8.0) / std::sin(M_PI / 8.0));
    EXPECT_NEAR(expected, 0.01, 5e-5);
    EXPECT_NEAR(std::sqrt(square), expected, 0.02 * expected) << rate;  // 40000 free values: 0.4 %; the tick: 0.7 %
  }
}

TEST(StrainGauge, RefusesWhatHasNoMeaning) {
  const auto message = [](auto change) {
    StrainGaugeOptions options;
    change(options);
    const auto gauge = StrainGauge::create(options, kTick, 1);
    return gauge ? std::string() : gauge.error().message;
  };
  EXPECT_THAT(message([](auto& o) { o.slope[0] = 0.0; }), AllOf(HasSubstr("slope"), HasSubstr(" 0 N/V")));
  EXPECT_THAT(message([](auto& o) { o.arm = -0.05; }), AllOf(HasSubstr("arm"), HasSubstr("-0.05 m")));
  EXPECT_THAT(message([](auto& o) { o.crosstalk[1] = 1.5; }), AllOf(HasSubstr("crosstalk"), HasSubstr("1.5 N/N")));
  EXPECT_THAT(message([](auto& o) { o.converter_bits = 1; }), AllOf(HasSubstr("bits"), HasSubstr("24")));
  EXPECT_THAT(message([](auto& o) { o.cutoff = Hertz(600.0); }), AllOf(HasSubstr("600 Hz"), HasSubstr("500 Hz")));
  EXPECT_NE(message([](auto& o) { o.bridge_noise = std::numeric_limits<double>::quiet_NaN(); }), "");
  EXPECT_NE(message([](auto& o) { o.filter_order = 0; }), "");
}

}  // namespace strain_gauge_test
}  // namespace mbk::laboratory
