#include "mbk/measure/measurement/identify_transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::measurement {
namespace {

Recording part(const Recording& whole, Index begin, Index count) {
  Recording cut = whole;
  cut.time = whole.time.segment(begin, count);
  for (std::size_t k = 0; k < cut.channels.size(); ++k) {
    cut.channels[k].values = whole.channels[k].values.segment(begin, count);
  }
  return cut;
}

/// A real flexible robot arm, torque to acceleration, periods of 4096 samples (Kollár, Pintelon & Schoukens 1994).
constexpr Index kPeriod = 4096;
Result<Recording> flexible_arm(const char* folder) {
  recording::ReadOptions reading;
  reading.channels = recording::parse_channel_map("input=Input,output=Output").value();
  reading.rate = Hertz(500.0);
  return recording::read(std::string(folder) + "/flexible_arm/contsid_robotarm.mat", reading);
}

TEST(TransferFunction, OfARealFlexibleArmIsReachedByEachStartAlone) {
  const char* const folder = std::getenv("MBK_DATA_DIR");
  if (folder == nullptr) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const auto whole = flexible_arm(folder);
  ASSERT_TRUE(whole.has_value()) << whole.error().line();
  const auto period = [&](Index number) {
    SignalPair pair;
    pair.step = 1.0 / 500.0;
    const Index begin = (number - 1) * kPeriod;
    pair.time = whole->time.segment(begin, kPeriod);
    pair.input = whole->channels[0].values.segment(begin, kPeriod);
    pair.output = whole->channels[1].values.segment(begin, kPeriod);
    return pair;
  };
  const SignalPair held_out = period(8);
  const double power = (held_out.output.array() - held_out.output.mean()).square().sum();
  constexpr int kStarts = 40;
  for (int k = 0; k < kStarts; ++k) {
    identify::ContinuousFitOptions options;
    options.poles = 6;
    options.zeros = 5;
    options.start_poles = {0.1 * std::pow(15000.0, static_cast<double>(k) / (kStarts - 1))};  // to 1500 rad/s
    options.only_given_starts = true;
    const auto fit = identify::fit_continuous({period(3)}, options);
    ASSERT_TRUE(fit.has_value() && fit->converged) << options.start_poles[0];
    const Vector error = held_out.output - identify::simulate_continuous(fit->a, fit->b, held_out);
    const double left = identify::without_free_motion(fit->a, held_out, error).squaredNorm();
    EXPECT_GE(1.0 - left / power, 0.975) << options.start_poles[0];
  }
}

class FlexibleArm : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("MBK_DATA_DIR");
    if (folder == nullptr) GTEST_SKIP() << "MBK_DATA_DIR is not set";
    const auto whole = flexible_arm(folder);
    ASSERT_TRUE(whole.has_value()) << whole.error().line();
    third_ = part(*whole, 2 * kPeriod, kPeriod);
    eighth_ = part(*whole, 7 * kPeriod, kPeriod);
    options_.fit.poles = 6;
    options_.fit.zeros = 5;
  }

  [[nodiscard]] Result<TransferFunctionIdentification> identified() const {
    return identify_transfer_function({&third_, 1}, {&eighth_, 1}, options_);
  }

  Recording third_, eighth_;
  TransferFunctionMeasurement options_;
};

void expect_modes(const TransferFunctionIdentification& found) {
  ASSERT_EQ(found.poles.size(), 3U);
  EXPECT_NEAR(found.poles[0].frequency, 7.29, 0.01 * 7.29);
  EXPECT_NEAR(found.poles[1].frequency, 15.84, 0.01 * 15.84);
  EXPECT_NEAR(found.poles[2].frequency, 42.45, 0.02 * 42.45);
  EXPECT_FALSE(found.poles[1].outside_band);
  EXPECT_TRUE(found.poles[2].outside_band);
}

TEST_F(FlexibleArm, HoldsFromAnyStart) {
  for (const double start : {0.1, 2.0, 30.0, 400.0, 1500.0}) {  // rad/s
    options_.fit.start_poles = {start};
    const auto found = identified();
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_GE(found->held_out_fit.value(), 0.975) << start;
    expect_modes(*found);
    EXPECT_EQ(found->recorded_rate_hz, 0.0);
  }
}

TEST_F(FlexibleArm, HoldsAsOutputErrorAtAHundredHertz) {
  options_.fit.method = TransferFunctionMethod::output_error;
  const auto found = identified();
  ASSERT_TRUE(found.has_value()) << found.error().line();
  EXPECT_NEAR(found->recorded_rate_hz, 500.0, 1e-9);
  EXPECT_NEAR(found->model.sample_time, 0.01, 1e-9);
  EXPECT_GE(found->held_out_fit.value(), 0.975);
  expect_modes(*found);
}

Recording ramp(Index samples) {
  Recording recording;
  recording.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) * 0.01;
  recording.channels = {{"input", "N", "", recording.time.array().sin()},
                        {"output", "m", "", recording.time.array().cos()}};
  return recording;
}

/// 2/(s + 1) behind a random binary force, at 400 Hz.
Recording slow_lag() {
  Recording recording;
  constexpr Index kSamples = 24000;
  constexpr double kStep = 0.0025;
  recording.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * kStep;
  Vector u(kSamples), y = Vector::Zero(kSamples);
  numeric::Random random(1);
  for (Index i = 0; i < kSamples; ++i) {
    u[i] = i % 200 == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : u[i - 1];
    if (i > 0) y[i] = std::exp(-kStep) * y[i - 1] + 2.0 * (1.0 - std::exp(-kStep)) * u[i - 1];
  }
  recording.channels = {{"input", "N", "", u}, {"output", "m", "", y}};
  return recording;
}

TEST(TransferFunction, InDiscreteTimeIsOfAHundredHertzUnlessAskedOtherwise) {
  const Recording recording = slow_lag();
  TransferFunctionMeasurement options;
  options.fit.poles = options.fit.zeros = 1;
  options.fit.method = TransferFunctionMethod::output_error;
  const auto step = [&](std::optional<double> rate) {
    options.sample_rate_hz = rate;
    const auto found = identify_transfer_function({&recording, 1}, {}, options);
    EXPECT_TRUE(found.has_value());
    if (!found) return 0.0;
    EXPECT_NEAR(found->poles[0].frequency, 1.0 / (2.0 * std::numbers::pi), 1e-3);
    EXPECT_NEAR(found->gain, 2.0, 0.01);
    EXPECT_EQ(found->recorded_rate_hz > 0.0, found->model.sample_time > 0.003);
    return found->model.sample_time;
  };
  EXPECT_NEAR(step(std::nullopt), 0.01, 1e-9);
  EXPECT_NEAR(step(50.0), 0.02, 1e-9);
  EXPECT_NEAR(step(0.0), 0.0025, 1e-9);
  options.sample_rate_hz = 500.0;
  const auto faster = identify_transfer_function({&recording, 1}, {}, options);
  ASSERT_FALSE(faster.has_value());
  EXPECT_EQ(faster.error().kind, ErrorKind::usage);
}

/// s²/(s² + 2 ζ w s + w²), 120 Hz, behind random steps every 4 ms, at 500 Hz: an acceleration, all of it fast.
Recording fast_resonance(double noise) {
  constexpr Index kSamples = 4096;
  constexpr double kStep = 0.002;
  const double w = 2.0 * std::numbers::pi * 120.0;
  SignalPair pair;
  pair.step = kStep;
  pair.held = 1.0;
  pair.time = Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1)) * kStep;
  pair.input.resize(kSamples);
  numeric::Random random(3);
  for (Index i = 0; i < kSamples; ++i) pair.input[i] = i % 2 == 0 ? random.normal() : pair.input[i - 1];
  pair.output = identify::simulate_continuous(Vector{{w * w, 0.04 * w}}, Vector{{0.0, 0.0, 1.0}}, pair);
  for (double& y : pair.output) y += noise * random.normal();
  Recording recording;
  recording.time = pair.time;
  recording.channels = {{"input", "N", "", pair.input}, {"output", "m/s^2", "", pair.output}};
  return recording;
}

TEST(TransferFunction, InDiscreteTimeKeepsTheRateAtWhichTheOutputAnswers) {
  TransferFunctionMeasurement options;
  options.fit.poles = options.fit.zeros = 2;
  options.fit.method = TransferFunctionMethod::output_error;
  const Recording fast = fast_resonance(0.1);
  const auto found = identify_transfer_function({&fast, 1}, {}, options);
  ASSERT_TRUE(found.has_value()) << found.error().line();
  EXPECT_EQ(found->recorded_rate_hz, 0.0);  // every sample
  EXPECT_NEAR(found->poles[0].frequency, 120.0, 0.2);
  ASSERT_EQ(found->notes.size(), 1U);
  EXPECT_NE(found->notes[0].find("100 Hz"), std::string::npos) << found->notes[0];
}

TEST(TransferFunction, InDiscreteTimeNoiseDoesNotDecideTheRate) {
  Recording slow = slow_lag();
  numeric::Random random(5);
  for (double& y : slow.channels[1].values) y += 2.0 * random.normal();  // most of the output's power, up to 200 Hz
  TransferFunctionMeasurement options;
  options.fit.poles = options.fit.zeros = 1;
  options.fit.method = TransferFunctionMethod::output_error;
  const auto found = identify_transfer_function({&slow, 1}, {}, options);
  ASSERT_TRUE(found.has_value()) << found.error().line();
  EXPECT_NEAR(found->model.sample_time, 0.01, 1e-9);
}

TEST_F(FlexibleArm, SettlesInDiscreteTimeAtHighAndLowOrders) {
  for (const auto method : {TransferFunctionMethod::output_error, TransferFunctionMethod::box_jenkins}) {
    options_.fit.method = method;
    options_.fit.orders = {{1, 1}, {2, 2}, {3, 3}, {4, 1}, {4, 4}, {5, 0}, {5, 5}, {6, 1}, {6, 5}, {6, 6}};
    const auto found = identified();
    ASSERT_TRUE(found.has_value()) << found.error().line();
    for (const OrderChoice& one : found->orders) {
      EXPECT_TRUE(one.usable) << word_of(method) << " " << one.poles << "/" << one.zeros;
      const bool whole = one.poles == 6 && one.zeros >= 5;
      EXPECT_GE(one.fit, whole ? 0.985 : 0.0) << word_of(method) << " " << one.poles << "/" << one.zeros;
    }
    EXPECT_GE(found->held_out_fit.value(), 0.975);
  }
}

TEST(TransferFunction, KeepsTheSamplesOfADelayWhenItLeavesSomeOut) {
  Recording recording = slow_lag();
  const Index late = 40;  // 0.1 s
  Vector& y = recording.channels[1].values;
  const Vector prompt = y;
  y.tail(y.size() - late) = prompt.head(y.size() - late);
  y.head(late).setZero();
  TransferFunctionMeasurement options;
  options.window.from_s = 1.0;
  options.fit.poles = options.fit.zeros = 1;
  options.fit.method = TransferFunctionMethod::output_error;
  options.fit.delay = 0.1;
  const auto found = identify_transfer_function({&recording, 1}, {}, options);
  ASSERT_TRUE(found.has_value()) << found.error().line();
  EXPECT_GT(found->held_out_fit.value(), 0.99999);
}

/// A pair of poles of ζ = 0.1 behind this input, `delay` samples late, at 100 Hz; its first `skip` samples are cut off.
Recording resonance(const Vector& input, double hertz, Index delay, double noise, Index skip = 0) {
  const double w = 2.0 * std::numbers::pi * hertz;
  SignalPair pair;
  pair.step = 0.01;
  pair.time = Vector::LinSpaced(input.size(), 0.0, 0.01 * static_cast<double>(input.size() - 1));
  pair.input = Vector::Constant(input.size(), input[0]);
  pair.input.tail(input.size() - delay) = input.head(input.size() - delay);
  pair.output = identify::simulate_continuous(Vector{{w * w, 0.2 * w}}, Vector{{w * w}}, pair);
  const double scale = std::sqrt(pair.output.squaredNorm() / static_cast<double>(input.size()));
  numeric::Random random(8);
  for (double& y : pair.output) y += noise * scale * random.normal();
  Recording recording;
  recording.time = pair.time;
  recording.channels = {{"input", "N", "", input}, {"output", "m", "", pair.output}};
  return skip > 0 ? part(recording, skip, input.size() - skip) : recording;
}

/// cos of a phase whose frequency [Hz] at each sample is given, at 100 Hz.
template <class Frequency>
Vector sweep(Index samples, Frequency&& frequency) {
  Vector u(samples);
  double turns = 0.0;
  for (Index i = 0; i < samples; ++i) {
    u[i] = std::sin(2.0 * std::numbers::pi * turns);
    turns += 0.01 * frequency(static_cast<double>(i) / static_cast<double>(samples));
  }
  return u;
}

Vector coloured(Index samples, std::uint64_t seed) {
  Vector u(samples);
  numeric::Random random(seed);
  double last = 0.0;
  for (double& value : u) value = last = 0.8 * last + random.normal();
  return u;
}

TransferFunctionMeasurement two_poles() {
  TransferFunctionMeasurement options;
  options.fit.poles = 2;
  options.fit.zeros = 0;
  return options;
}

TEST(TransferFunction, HoldsOutBlocksWhereTheInputIsAnotherAtTheEnd) {
  constexpr Index kSamples = 6000;
  constexpr double kSteps[] = {4.0, 1.0, 8.0, 0.5, 2.0};
  const auto rising = [](double share) { return 0.1 + 19.9 * share; };
  const auto by_octaves = [](double share) { return 0.1 * std::pow(200.0, share); };
  const auto falling = [&](double share) { return by_octaves(1.0 - share); };
  const auto steps = [&](double share) { return kSteps[static_cast<int>(5.0 * share)]; };
  for (const auto& [input, top] : {std::pair{sweep(kSamples, rising), 18.0},
                                   {sweep(kSamples, by_octaves), 13.0},
                                   {sweep(kSamples, falling), 13.0},
                                   {sweep(kSamples, steps), 7.5}}) {
    const Recording recording = resonance(input, 6.0, 0, 0.01);
    const auto found = identify_transfer_function({&recording, 1}, {}, two_poles());
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_GT(found->band_high, top);
    EXPECT_LT(found->band_low, 2.0);
    EXPECT_EQ(found->simulated.size(), 3U);
    EXPECT_EQ(found->notes.size(), 1U);
    EXPECT_NEAR(found->poles[0].frequency, 6.0, 0.05);
    EXPECT_GT(found->held_out_fit.value(), 0.9);
    EXPECT_FALSE(found->poles[0].outside_band);
  }
}

TEST(TransferFunction, HoldsOutTheLastFifthWhereTheInputGoesOnAsBefore) {
  constexpr Index kSamples = 3000;
  const auto up_and_down = [](double share) { return 0.1 + 10.0 * std::abs(std::remainder(8.0 * share, 2.0)); };
  Vector lines = Vector::Zero(kSamples), binary = lines, pulses = lines;
  numeric::Random random(2);
  for (Index i = 0; i < kSamples; ++i) {
    for (const double f : {0.25, 0.75, 1.75, 3.25, 5.25})
      lines[i] += std::sin(0.02 * std::numbers::pi * f * static_cast<double>(i) + f * f);
    binary[i] = i % 40 == 0 ? (random.uniform() < 0.5 ? -1.0 : 1.0) : binary[i - 1];
    pulses[i] = i % 500 < 30 ? 1.0 : 0.0;
  }
  int k = 0;
  for (const Vector& input : {sweep(kSamples, up_and_down), lines, binary, pulses, coloured(kSamples, 4)}) {
    SCOPED_TRACE(k++);
    const Recording recording = resonance(input, 2.0, 0, 0.01);
    const auto found = identify_transfer_function({&recording, 1}, {}, two_poles());
    ASSERT_TRUE(found.has_value()) << found.error().line();
    ASSERT_EQ(found->simulated.size(), 1U);
    EXPECT_NEAR(found->simulated[0].time[0], 24.0, 0.011);
    EXPECT_TRUE(found->notes.empty());
  }
}

TEST(TransferFunction, FindsTheDelayOfAPersonOrSaysThatItMayBeLonger) {
  TransferFunctionMeasurement options = two_poles();
  options.fit.find_delay = true;
  for (const Index late : {5, 15, 30, 45}) {
    const Recording recording = resonance(coloured(6000, 3), 2.0, late, 0.02);
    const auto found = identify_transfer_function({&recording, 1}, {}, options);
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_TRUE(found->delay_found);
    EXPECT_NEAR(found->model.delay, 0.01 * static_cast<double>(late), 0.001);
    EXPECT_TRUE(found->residuals.independent());
  }
  const Recording recording = resonance(coloured(6000, 3), 2.0, 60, 0.02);
  const auto short_of_it = identify_transfer_function({&recording, 1}, {}, options);
  ASSERT_TRUE(short_of_it.has_value()) << short_of_it.error().line();
  EXPECT_FALSE(short_of_it->delay_found);
  EXPECT_FALSE(short_of_it->delay_standard_error.has_value());
  const auto said = std::ranges::find(short_of_it->warnings, WarningCode::delay_at_limit, &Warning::code);
  ASSERT_NE(said, short_of_it->warnings.end());
  EXPECT_NE(said->remedy.find("--max-delay 1"), std::string::npos) << said->remedy;
  options.max_delay = 1.0;
  const auto found = identify_transfer_function({&recording, 1}, {}, options);
  ASSERT_TRUE(found.has_value()) << found.error().line();
  EXPECT_TRUE(found->delay_found);
  EXPECT_NEAR(found->model.delay, 0.6, 0.001);
}

TEST(TransferFunction, LosesNoPrecisionWhereADelayedRecordingBeginsInMotion) {
  constexpr double kNoise = 1e-3;
  const Recording recording = resonance(coloured(4000, 3), 2.0, 15, kNoise, 1000);
  for (const bool find : {false, true}) {
    for (const auto method : {TransferFunctionMethod::srivc, TransferFunctionMethod::output_error}) {
      TransferFunctionMeasurement options = two_poles();
      options.fit.method = method;
      options.fit.delay = 0.15;
      options.fit.find_delay = find;
      if (method == TransferFunctionMethod::output_error) options.fit.zeros = 2;
      const auto found = identify_transfer_function({&recording, 1}, {}, options);
      ASSERT_TRUE(found.has_value()) << found.error().line();
      const Vector& y = recording.channels[1].values;
      const double scale = std::sqrt(y.squaredNorm() / static_cast<double>(y.size()));
      EXPECT_NEAR(found->noise_standard_deviation, kNoise * scale, 0.2 * kNoise * scale) << word_of(method) << find;
      ASSERT_EQ(found->notes.size(), 1U);
      EXPECT_NE(found->notes[0].find("input"), std::string::npos);
    }
  }
}

TEST(TransferFunction, SaysWhichChannelIsMissing) {
  const Recording recording = ramp(100);
  TransferFunctionMeasurement options;
  options.output = "position";
  const auto found = identify_transfer_function({&recording, 1}, {}, options);
  ASSERT_FALSE(found.has_value());
  for (const char* const names : {"'position'", "input, output"})
    EXPECT_NE(found.error().line().find(names), std::string::npos) << found.error().line();
}

TEST(TransferFunction, RefusesTimeThatStandsStillAndWindowsOutside) {
  Recording recording = ramp(100);
  recording.time[50] = recording.time[49];
  EXPECT_FALSE(identify_transfer_function({&recording, 1}, {}, {}).has_value());
  recording = ramp(100);
  TransferFunctionMeasurement options;
  options.window.from_s = 5.0;
  EXPECT_FALSE(identify_transfer_function({&recording, 1}, {}, options).has_value());
}

}  // namespace
}  // namespace mbk::measurement
