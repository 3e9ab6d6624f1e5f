#include "mbk/measure/identify/input_hold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::identify {
namespace input_hold_test {

constexpr Index kSamples = 2000;

InputHold hold_of(const Vector& input) {
  SignalPair pair;
  pair.input = input;
  return input_hold({pair});
}

Vector sine(double samples_per_period) {
  return Vector::LinSpaced(kSamples, 0.0, 2.0 * std::numbers::pi * kSamples / samples_per_period).array().sin();
}

Vector every_value_kept(const Vector& of, Index samples) {
  Vector held(of.size());
  for (Index i = 0; i < held.size(); ++i) held[i] = of[i - i % samples];
  return held;
}

Vector random_binary(Index samples) {
  Vector u(kSamples);
  numeric::Random random(1);
  for (Index i = 0; i < kSamples; ++i) u[i] = i % samples == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : u[i - 1];
  return u;
}

Vector noise(double deviation, std::uint64_t seed = 2) {
  Vector e(kSamples);
  numeric::Random random(seed);
  for (double& value : e) value = deviation * random.normal();
  return e;
}

TEST(InputHold, OfARandomBinaryInputIsZeroAlsoWhereItIsMeasured) {
  for (const Index samples : {1, 2, 7}) EXPECT_EQ(hold_of(random_binary(samples)), InputHold::zero) << samples;
  EXPECT_EQ(hold_of(random_binary(7) + noise(0.01)), InputHold::zero);
}

TEST(InputHold, OfAReferenceWithASlowerClockIsZero) {
  EXPECT_EQ(hold_of(every_value_kept(sine(400.0), 10)), InputHold::zero);
  EXPECT_EQ(hold_of(every_value_kept(noise(1.0), 4)), InputHold::zero);
}

TEST(InputHold, OfWhatMovesAtEverySampleIsFirst) {
  EXPECT_EQ(hold_of(sine(400.0)), InputHold::first);
  EXPECT_EQ(hold_of(noise(1.0)), InputHold::first);
  EXPECT_EQ(hold_of(sine(40.0) + noise(0.1)), InputHold::first);
}

TEST(InputHold, OfStepsBehindALowPassIsFirst) {
  Vector u = random_binary(20);
  for (Index i = 1; i < kSamples; ++i) u[i] = 0.5 * u[i - 1] + 0.5 * u[i];
  EXPECT_EQ(hold_of(u), InputHold::first);
}

TEST(InputHold, OfACoarseSensorIsFirst) {
  for (const double step : {0.01, 0.1, 0.2}) {
    EXPECT_EQ(hold_of((sine(2000.0).array() / step).round() * step), InputHold::first) << step;
  }
}

TEST(InputHold, IsZeroOnlyIfEachExperimentIsHeld) {
  SignalPair held, smooth;
  held.input = random_binary(5);
  smooth.input = sine(100.0);
  EXPECT_EQ(input_hold({held, held}), InputHold::zero);
  EXPECT_EQ(input_hold({held, smooth}), InputHold::first);
  SignalPair still;
  still.input = Vector::Ones(100);
  EXPECT_EQ(input_hold({held, still}), InputHold::zero);
  EXPECT_EQ(input_hold({still}), InputHold::first);
  EXPECT_EQ(input_hold({}), InputHold::first);
}

}  // namespace input_hold_test
}  // namespace mbk::identify
