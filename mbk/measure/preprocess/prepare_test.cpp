#include "mbk/measure/preprocess/prepare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "mbk/base/core/nan.h"
#include "mbk/measure/preprocess/test_recordings.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/underdamped_pulse.h"

namespace mbk::preprocess {
namespace prepare_test {

using testing::HasSubstr;
using testing_support::even_recording;
using testing_support::facts_of;
using testing_support::values_of;

constexpr double kRate = 1000.0;

Result<PreparedTrial> prepared(const Recording& recording, const Options& options = {}) {
  return prepare(recording, facts_of(recording), options);
}

impedance::Model arm() {
  impedance::Model model;
  model.M = (Matrix(2, 2) << 1.2, -0.5, -0.4, 1.6).finished();
  model.B = (Matrix(2, 2) << 6.0, -3.0, -3.0, 12.0).finished();
  model.K = (Matrix(2, 2) << 90.0, -30.0, -40.0, 200.0).finished();
  model.x0 = (Vector(2) << 0.304, -0.053).finished();
  return model;
}

/// Noise in every channel: nothing of it is smooth, so that what one filter does to it shows.
Recording noise(Index samples, int axes = 2) {
  Recording recording = axes == 2 ? even_recording(samples, kRate,
                                                   {{"hand_x", {}},
                                                    {"hand_y", {}},
                                                    {"force_x", {}},
                                                    {"force_y", {}},
                                                    {"acceleration_x", {}},
                                                    {"acceleration_y", {}}})
                                  : even_recording(samples, kRate, {{"position", {}}, {"reaction", {}}});
  std::srand(3);  // Eigen's Random draws from it
  for (Channel& channel : recording.channels) channel.values = Vector::Random(samples);
  return recording;
}

/// Two axes in closed form: sines of 0.3 … 2.9 Hz with their exact derivatives and the arm's force.
struct Sines {
  Recording recording;
  Matrix velocity, acceleration;
};

Sines sines(Index samples) {
  const std::vector<int> harmonics = {3, 7, 13, 20, 29};
  Sines out{even_recording(samples, kRate,
                           {{"hand_x", Vector(samples)},
                            {"hand_y", Vector(samples)},
                            {"force_x", Vector(samples)},
                            {"force_y", Vector(samples)},
                            {"reference_x", Vector(samples)},
                            {"reference_y", Vector(samples)}}),
            Matrix(samples, 2), Matrix(samples, 2)};
  const impedance::Model model = arm();
  const std::vector<double> amplitudes(harmonics.size(), 0.002);
  const auto x = perturbation::Multisine::with_random_phases(10.0, harmonics, amplitudes, 1, 0).value();
  const auto y = perturbation::Multisine::with_random_phases(10.0, harmonics, amplitudes, 1, 1).value();
  for (Index i = 0; i < samples; ++i) {
    const auto jx = x.at(out.recording.time[i]), jy = y.at(out.recording.time[i]);
    const Vector position = (Vector(2) << 0.28 + jx.value, 0.02 + jy.value).finished();
    out.velocity.row(i) << jx.first, jy.first;
    out.acceleration.row(i) << jx.second, jy.second;
    const Vector force = -(model.M * out.acceleration.row(i).transpose() + model.B * out.velocity.row(i).transpose() +
                           model.K * (position - model.x0));
    const double values[] = {position[0], position[1], force[0], force[1], position[0], position[1]};
    for (std::size_t c = 0; c < 6; ++c) out.recording.channels[c].values[i] = values[c];
  }
  return out;
}

/// One axis with `count` underdamped pulses of 1700 samples, the first at sample 2000, one every 4000.
Recording pulses(int count) {
  const Index n = 2000 + 4000 * count;
  Recording recording = even_recording(
      n, kRate, {{"position", Vector::Zero(n)}, {"reaction", Vector::Zero(n)}, {"reference", Vector::Zero(n)}});
  const auto shape = perturbation::UnderdampedPulse::create(0.005).value();
  for (int k = 0; k < count; ++k) {
    for (Index i = 0; i < 1700; ++i) {
      const auto jet = shape.at(static_cast<double>(i) / kRate);
      const Index row = 2000 + 4000 * k + i;
      recording.channels[0].values[row] = jet.value;
      recording.channels[1].values[row] = -(1.3 * jet.second + 8.0 * jet.first + 120.0 * jet.value);
      recording.channels[2].values[row] = 0.005;
    }
  }
  return recording;
}

/// Acceleration, velocity and position of the recording turned into −F by the arm, channel by channel, so that the
/// relation holds exactly before any filter: with the sensor's acceleration.
Recording obeying(Recording recording, const impedance::Model& model) {
  for (Index i = 0; i < recording.samples(); ++i) {
    const Eigen::Vector2d a(values_of(recording, "acceleration_x")[i], values_of(recording, "acceleration_y")[i]);
    const Eigen::Vector2d x(values_of(recording, "hand_x")[i], values_of(recording, "hand_y")[i]);
    const Eigen::Vector2d force = -(model.M * a + model.K * (x - model.x0));
    values_of(recording, "force_x")[i] = force[0];
    values_of(recording, "force_y")[i] = force[1];
  }
  return recording;
}

bool warns(const PreparedTrial& trial, WarningCode code) {
  for (const Warning& warning : trial.warnings) {
    if (warning.code == code) return true;
  }
  return false;
}

// Derivatives and filters.

TEST(Prepare, APolynomialMotionGivesItsExactDerivatives) {
  const Index n = 3000;
  Recording recording = noise(n, 1);
  const auto p = [](double t) { return 0.3 + 0.02 * t - 0.01 * t * t + 0.003 * t * t * t; };
  for (Index i = 0; i < n; ++i) values_of(recording, "position")[i] = p(recording.time[i]);
  const PreparedTrial trial = prepared(recording, {.smoothing_window = 101, .no_lowpass = true}).value();
  // Rounding of 0.3 through the weights of the second derivative, whose sum of absolute values is below 5e5 s⁻²:
  const double kRounding = 0.3 * std::numeric_limits<double>::epsilon() * 5e5 * 8.0;
  for (Index i = 0; i < trial.time.size(); ++i) {
    const double t = trial.time[i];
    ASSERT_NEAR(trial.position(i, 0), p(t), kRounding) << t;
    ASSERT_NEAR(trial.velocity(i, 0), 0.02 - 0.02 * t + 0.009 * t * t, kRounding) << t;
    ASSERT_NEAR(trial.acceleration(i, 0), -0.02 + 0.018 * t, kRounding) << t;
  }
}

TEST(Prepare, EveryRowCarriesTheTimeOfItsSample) {
  Recording recording = noise(2000);
  recording.time.array() += 5.0;
  const PreparedTrial trial = prepared(recording, {.smoothing_window = 51, .no_lowpass = true}).value();
  ASSERT_EQ(trial.time.size(), 2000 - 50);
  EXPECT_NEAR(trial.time[0], 0.025, 1e-12);  // from the first sample, half a window in
  EXPECT_NEAR(trial.time[trial.time.size() - 1], 1.999 - 0.025, 1e-12);
}

TEST(Prepare, SinesKeepTheirVelocityAndAccelerationUpToTheFilters) {
  const Sines truth = sines(20000);
  const PreparedTrial trial = prepared(truth.recording).value();
  // In the top line the smoothing's first derivative falls short by less than 0.1 %, the low-pass by 0.6 %.
  const double kFilters = 0.01;
  const double largest_v = truth.velocity.cwiseAbs().maxCoeff(), largest_a = truth.acceleration.cwiseAbs().maxCoeff();
  EXPECT_GT(trial.preparation.every, 1);
  for (Index i = 0; i < trial.time.size(); ++i) {
    if (std::abs(trial.time[i] - 10.0) > 2.0) continue;  // away from the ends
    const Index sample = std::llround(trial.time[i] * kRate);
    EXPECT_NEAR((trial.velocity.row(i) - truth.velocity.row(sample)).norm(), 0.0, kFilters * largest_v);
    EXPECT_NEAR((trial.acceleration.row(i) - truth.acceleration.row(sample)).norm(), 0.0, kFilters * largest_a);
  }
}

class BothModes : public testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(All, BothModes, testing::Values(Mode::default_mode, Mode::reference),
                         [](const auto& mode) { return std::string(word_of(mode.param)); });

TEST_P(BothModes, ALinearRelationOfForceAndMotionSurvivesTheFilters) {
  const impedance::Model model = arm();
  const PreparedTrial trial =
      prepared(obeying(noise(6000), model), {.mode = GetParam(), .acceleration = AccelerationSource::sensor}).value();
  // Forces are below 400 N; the low-pass is a recursion of hundreds of samples, each adding a rounding.
  const double kRounding = 400.0 * 1000.0 * std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < trial.time.size(); ++i) {
    const Vector expected =
        -(model.M * trial.acceleration.row(i).transpose() + model.K * (trial.position.row(i).transpose() - model.x0));
    ASSERT_NEAR((trial.force_hand_on_robot.row(i).transpose() - expected).norm(), 0.0, kRounding) << "row " << i;
  }
}

TEST_P(BothModes, TheAccelerometerIsTakenWhenAskedFor) {
  Recording recording = noise(6000);
  Recording other = recording;
  values_of(other, "acceleration_y").array() += 3.0;
  const Options sensor{.mode = GetParam(), .acceleration = AccelerationSource::sensor};
  const PreparedTrial a = prepared(recording, sensor).value(), b = prepared(other, sensor).value();
  EXPECT_TRUE(a.preparation.acceleration_from_sensor);
  // A constant passes every filter with gain 1; five sections and 101 weights of it round.
  EXPECT_LE(((b.acceleration - a.acceleration).col(1).array() - 3.0).abs().maxCoeff(), 1e-10);
  EXPECT_EQ(a.acceleration.col(0), b.acceleration.col(0));
  EXPECT_EQ(a.velocity, b.velocity);
  const Options derivative{.mode = GetParam(), .acceleration = AccelerationSource::derivative};
  EXPECT_EQ(prepared(recording, derivative)->acceleration, prepared(other, derivative)->acceleration);
}

TEST(Prepare, Chapter5TakesTheAccelerometerAndItsOwnFilters) {
  const Preparation how =
      prepared(noise(6000), {.mode = Mode::reference, .procedure = Procedure::chapter5})->preparation;
  EXPECT_TRUE(how.acceleration_from_sensor);
  EXPECT_EQ(how.smoothing_window, 151);
  EXPECT_EQ(how.cutoff->value, 4.5);
}

TEST(Prepare, Chapter3DifferentiatesThePosition) {
  const Preparation how = prepared(noise(6000), {.mode = Mode::reference})->preparation;
  EXPECT_FALSE(how.acceleration_from_sensor);
  EXPECT_EQ(how.smoothing_window, 101);
  EXPECT_EQ(how.smoothing_order, 6);
  EXPECT_EQ(how.cutoff->value, 5.0);
  EXPECT_FALSE(how.cut_before_filter);
}

TEST(Prepare, DefaultCutoffIsTheTopOfTheExcitedBandOverSixTenths) {
  const Preparation how = prepared(sines(30000).recording)->preparation;
  EXPECT_NEAR(how.band_high.value, 2.9, 0.11);
  EXPECT_DOUBLE_EQ(how.cutoff->value, how.band_high.value / 0.6);
  EXPECT_THAT(how.cutoff_rule, HasSubstr("0.6"));
  EXPECT_TRUE(how.cut_before_filter);
}

// What the user chooses.

TEST_P(BothModes, SmoothingCutoffAndLackOfItAreUsedAndRecorded) {
  const Recording recording = sines(20000).recording;
  const Options base{.mode = GetParam(), .protocol = Protocol::free};
  Options options = base;
  options.smoothing_window = 61;
  options.smoothing_order = 4;
  options.cutoff = Hertz(8.0);
  const PreparedTrial chosen = prepared(recording, options).value();
  EXPECT_EQ(chosen.preparation.smoothing_window, 61);
  EXPECT_EQ(chosen.preparation.smoothing_order, 4);
  EXPECT_EQ(chosen.preparation.cutoff->value, 8.0);
  options.cutoff = Hertz(2.0);
  EXPECT_NE(prepared(recording, options)->position, chosen.position);
  options.cutoff.reset();
  options.no_lowpass = true;
  const PreparedTrial unfiltered = prepared(recording, options).value();
  EXPECT_FALSE(unfiltered.preparation.cutoff.has_value());
  EXPECT_NE(unfiltered.preparation.cutoff_rule, chosen.preparation.cutoff_rule);
  EXPECT_NE(unfiltered.position, chosen.position);
}

TEST_P(BothModes, PaddingAndExtensionAreUsed) {
  const Recording recording = sines(20000).recording;
  Options options{.mode = GetParam(), .protocol = Protocol::free};
  const Matrix odd = prepared(recording, options)->position;
  options.padding.samples = 300;
  const Matrix padded = prepared(recording, options)->position;
  options.padding.extension = dsp::Extension::even;
  const Matrix even = prepared(recording, options)->position;
  EXPECT_NE(odd, padded);
  EXPECT_NE(padded, even);
  const Index middle = odd.rows() / 2;  // 10 s away from the ends all are one
  EXPECT_NEAR((odd.row(middle) - even.row(middle)).norm(), 0.0, 1e-12);
}

TEST_P(BothModes, TheWindowIsRecordedInSeconds) {
  const PreparedTrial trial =
      prepared(noise(20000),
               {.mode = GetParam(), .smoothing_window = 101, .window = {.from_s = 2.0, .split_s = 10.0, .to_s = 18.0}})
          .value();
  const double lost = GetParam() == Mode::reference ? 0.051 : 0.050;
  EXPECT_NEAR(trial.preparation.from_s, 2.0 + lost, 1e-12);
  EXPECT_NEAR(trial.preparation.to_s, 17.999 - lost, 1e-12);
  EXPECT_EQ(trial.preparation.split_s, 10.0);
  ASSERT_EQ(trial.segments.size(), 2u);
  EXPECT_NEAR(trial.time[trial.segments[1].begin], 10.0, 1e-12);
  EXPECT_EQ(trial.segments[1].purpose, Purpose::validation);
}

TEST(Prepare, RefusesFiltersThatAreNone) {
  const Recording recording = sines(20000).recording;
  const auto refused = [&](const Options& options) { return !prepared(recording, options).has_value(); };
  for (const double cutoff : {0.0, -1.0, 500.001, 1e9, kNaN}) EXPECT_TRUE(refused({.cutoff = Hertz(cutoff)})) << cutoff;
  const int smallest = std::numeric_limits<int>::min(), largest = std::numeric_limits<int>::max();
  for (const int window : {0, -1, 100, 5, smallest, -2000000001, largest}) {
    EXPECT_TRUE(refused({.smoothing_window = window})) << window;
  }
  for (const int order : {-1, smallest, largest}) EXPECT_TRUE(refused({.smoothing_order = order})) << order;
}

// Cut before filter.

TEST(Prepare, DefaultModeSeesNothingOfWhatLiesJustOutsideAPulse) {
  const Recording quiet = pulses(4);
  Recording disturbed = quiet;
  for (const Index edge : {1999, 3700, 5999, 7700}) {  // the samples beside the first two pulses
    disturbed.channels[0].values[edge] += 10.0;
    disturbed.channels[1].values[edge] -= 1000.0;
  }
  const PreparedTrial a = prepared(quiet).value(), b = prepared(disturbed).value();
  ASSERT_EQ(a.segments.size(), 4u);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.acceleration, b.acceleration);
  EXPECT_EQ(a.force_hand_on_robot, b.force_hand_on_robot);
}

TEST(Prepare, ReferenceModeSmearsWhatLiesOutsideIntoThePulse) {
  const Recording quiet = pulses(12);
  Recording disturbed = quiet;
  for (Index k = 0; k < 12; ++k) disturbed.channels[1].values[2000 + 4000 * k - 1] += 100.0;
  const Options reference{.mode = Mode::reference};
  const PreparedTrial a = prepared(quiet, reference).value(), b = prepared(disturbed, reference).value();
  const Segment first = a.segments[2];
  EXPECT_GT((a.force_hand_on_robot - b.force_hand_on_robot).middleRows(first.begin, 100).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Prepare, EveryPulseIsASegmentWithItsPurpose) {
  const PreparedTrial trial = prepared(pulses(4)).value();
  EXPECT_EQ(trial.preparation.protocol, Protocol::underdamped);
  EXPECT_EQ(trial.preparation.perturbations, 4);
  ASSERT_EQ(trial.segments.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(trial.segments[k].purpose, k < 2 ? Purpose::identification : Purpose::validation);
    EXPECT_EQ(trial.segments[k].size(), 1700 - trial.preparation.smoothing_window + 1);
  }
}

TEST(Prepare, AShortPulseKeepsThreeQuartersOfItsSamples) {
  const PreparedTrial trial = prepared(pulses(4), {.cutoff = Hertz(0.5)}).value();
  EXPECT_GE(trial.segments[0].size(), 1700 * 3 / 4 - 1);
}

// What it refuses.

TEST(Prepare, AMissingChannelIsNamedWithThoseThatAreThere) {
  Recording recording = noise(2000);
  recording.channels.erase(recording.channels.begin() + 3);  // force_y
  const auto trial = prepared(recording);
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message,
              AllOf(HasSubstr("'force_y'"), HasSubstr("hand_x, hand_y, force_x, acceleration_x, acceleration_y")));
}

TEST(Prepare, AMissingAccelerometerIsNamed) {
  const auto trial = prepared(pulses(12), {.acceleration = AccelerationSource::sensor});
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, HasSubstr("'acceleration'"));
}

TEST(Prepare, AProtocolThatNeedsTheReferenceSaysSo) {
  const auto trial = prepared(noise(20000), {.protocol = Protocol::underdamped});
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, HasSubstr("reference"));
}

TEST(Prepare, NaNInsideTheWindowIsRefusedWithChannelSampleAndTime) {
  Recording recording = noise(5000);
  values_of(recording, "force_y")[3000] = kNaN;
  const auto trial = prepared(recording);
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, AllOf(HasSubstr("'force_y'"), HasSubstr("sample 3001"), HasSubstr("3.000")));
}

TEST(Prepare, NaNOutsideTheWindowDoesNotMatter) {
  Recording recording = noise(5000);
  values_of(recording, "force_y")[3000] = kNaN;
  EXPECT_TRUE(prepared(recording, {.window = {.to_s = 3.0}}));
  EXPECT_TRUE(prepared(recording, {.window = {.from_s = 3.001}}));
  EXPECT_FALSE(prepared(recording, {.window = {.to_s = 3.001}}));
}

TEST(Prepare, SamplesThatASessionLostAreRefusedUnlessTheWindowLeavesThemOut) {
  Recording recording = noise(5000);
  for (Channel& channel : recording.channels) channel.values.segment(3000, 50).setConstant(kNaN);
  Inspection facts = facts_of(recording);
  facts.missing = {{3000, 50}};
  const auto within = [&](const WindowLimits& window) { return prepare(recording, facts, {.window = window}); };
  const auto trial = within({});
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message,
              AllOf(HasSubstr("50 samples"), HasSubstr("sample 3001"), HasSubstr("3.000"), HasSubstr("3.049")));
  EXPECT_TRUE(within({.to_s = 3.0}));
  EXPECT_TRUE(within({.from_s = 3.05}));
}

TEST(Prepare, NaNInAChannelThatIsNotUsedDoesNotMatter) {
  Recording recording = noise(5000);
  values_of(recording, "acceleration_x")[3000] = kNaN;
  EXPECT_TRUE(prepared(recording));
  EXPECT_FALSE(prepared(recording, {.acceleration = AccelerationSource::sensor}));
}

TEST(Prepare, NaNInTheReferenceIsRefusedByName) {
  Recording recording = sines(20000).recording;
  values_of(recording, "reference_x")[9000] = kNaN;
  for (const Mode mode : {Mode::default_mode, Mode::reference}) {
    const auto trial = prepared(recording, {.mode = mode, .window = {.from_s = 0.0}});
    ASSERT_FALSE(trial);
    EXPECT_THAT(trial.error().message, AllOf(HasSubstr("'reference_x'"), HasSubstr("sample 9001")));
  }
}

TEST(Prepare, NaNInTheReferenceBetweenPulsesIsRefusedByName) {
  Recording recording = pulses(4);
  values_of(recording, "reference")[500] = kNaN;
  const auto trial = prepared(recording);
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, AllOf(HasSubstr("'reference'"), HasSubstr("sample 501")));
}

struct ClockFault {
  const char* name;
  double shift;  ///< [s] of the samples from 3000 on
  const char* fact;
};

class BadClock : public testing::TestWithParam<ClockFault> {
 protected:
  static Recording faulty() {
    Recording recording = noise(6000);
    recording.time.tail(3000).array() += GetParam().shift;
    return recording;
  }
};
INSTANTIATE_TEST_SUITE_P(All, BadClock,
                         testing::Values(ClockFault{"Gap", 1.5, "1.501 s"}, ClockFault{"Backward", -0.5, "time"},
                                         ClockFault{"Duplicate", -0.001, "time"}),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_P(BadClock, IsRefusedInsideTheWindowAndNamesTheSample) {
  Recording recording = faulty();
  if (GetParam().shift == -0.001) recording.time[3000] = recording.time[2999];  // to the last bit
  const auto trial = prepared(recording);
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, AllOf(HasSubstr("sample 3001"), HasSubstr(GetParam().fact)));
  EXPECT_THAT(trial.error().remedy, HasSubstr("--from"));
}

TEST_P(BadClock, DoesNotMatterBehindTheWindow) {
  const auto trial = prepared(faulty(), {.window = {.to_s = 2.9}});
  ASSERT_TRUE(trial) << trial.error().line();
  EXPECT_NEAR(trial->sample_time, 0.001, 1e-9);
}

TEST(Prepare, AWindowBehindAGapIsInSecondsOfTheClock) {
  Recording recording = noise(6000);
  recording.time.tail(3000).array() += 1.5;  // sample 3000 is at 4.5 s
  const auto trial = prepared(recording, {.smoothing_window = 101, .window = {.from_s = 5.0}});
  ASSERT_TRUE(trial) << trial.error().line();
  EXPECT_NEAR(trial->preparation.from_s, 5.0 + 0.05, 1e-9);
  ASSERT_TRUE(trial->preparation.split_s);
  EXPECT_NEAR(*trial->preparation.split_s, 5.0 + 0.8 * 2.5, 2e-3);
}

TEST(Prepare, AGapBetweenPulsesDoesNotMatter) {
  Recording recording = pulses(4);
  recording.time.tail(recording.samples() - 5000).array() += 2.0;
  EXPECT_TRUE(prepared(recording));
}

TEST(Prepare, JitterIsWarnedOfAndASteadyClockIsNot) {
  Recording recording = noise(5000);
  EXPECT_FALSE(warns(*prepared(recording), WarningCode::clock_jitter));
  for (Index i = 0; i < 5000; ++i) recording.time[i] += 0.0001 * std::sin(static_cast<double>(i) * 1.7);
  EXPECT_TRUE(warns(*prepared(recording), WarningCode::clock_jitter));
}

TEST(Prepare, TimeStampsRoundedToMillisecondsAreNoJitter) {
  Recording recording = noise(5000);
  for (double& t : recording.time) t = std::round(t * 1000.0) / 1000.0;
  EXPECT_FALSE(warns(*prepared(recording), WarningCode::clock_jitter));
}

TEST(Prepare, RefusesNoneAndOneSample) {
  EXPECT_THAT(prepared(noise(0)).error().message, HasSubstr("0 samples"));
  EXPECT_THAT(prepared(noise(1)).error().message, HasSubstr("1 sample"));
}

TEST(Prepare, RefusesATimeThatIsNotANumber) {
  Recording recording = noise(6000);
  recording.time[3000] = kNaN;
  EXPECT_THAT(prepared(recording).error().message, AllOf(HasSubstr("time"), HasSubstr("sample 3001")));
  recording.time.tail(3000).setConstant(kNaN);
  EXPECT_THAT(prepared(recording).error().message, HasSubstr("time"));
}

TEST(Prepare, RefusesATimeThatDoesNotRise) {
  Recording recording = noise(500);
  recording.time.reverseInPlace();
  EXPECT_THAT(prepared(recording).error().message, HasSubstr("time"));
  recording.time.setZero();
  EXPECT_THAT(prepared(recording).error().message, HasSubstr("time"));
}

TEST(Prepare, RefusesAWindowTooShortForTheFilters) {
  const auto trial = prepared(noise(110), {.mode = Mode::reference});
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, HasSubstr("110 samples"));
  EXPECT_FALSE(prepared(noise(9)));
}

// What moves.

TEST(Prepare, UnitsThatDoNotBelongTogetherAreRefused) {
  Recording recording = noise(5000, 1);
  recording.channels[0].unit = "m";
  recording.channels[1].unit = "N.m";
  const auto trial = prepared(recording);
  ASSERT_FALSE(trial);
  EXPECT_THAT(trial.error().message, AllOf(HasSubstr("position"), HasSubstr("reaction"), HasSubstr("N.m")));
}

TEST(Prepare, UnitsSayWhatMoves) {
  const auto motion = [](const char* position, const char* reaction) {
    Recording recording = noise(5000, 1);
    recording.channels[0].unit = position;
    recording.channels[1].unit = reaction;
    return prepared(recording)->motion;
  };
  EXPECT_EQ(motion("m", "N"), Motion::translation);
  EXPECT_EQ(motion("rad", "N.m"), Motion::rotation);
  EXPECT_EQ(motion("rad", ""), Motion::rotation);
  EXPECT_EQ(motion("", "N"), Motion::translation);
  EXPECT_EQ(motion("", ""), Motion::unknown);
}

TEST(Prepare, AxesFollowTheChannelsOrTheUser) {
  EXPECT_EQ(prepared(noise(5000))->axes, 2);
  EXPECT_EQ(prepared(noise(5000, 1))->axes, 1);
  EXPECT_FALSE(prepared(noise(5000, 1), {.axes = 2}));
  for (const int axes : {3, -1}) EXPECT_FALSE(prepared(noise(5000), {.axes = axes})) << axes;
}

TEST(Prepare, CarriesSourcesNotesAndDuration) {
  Recording recording = noise(5000);
  recording.sources.push_back({"a.csv", "CSV", "00"});
  recording.notes.push_back("column 9 was ignored");
  const PreparedTrial trial = prepared(recording).value();
  EXPECT_EQ(trial.sources[0].path, "a.csv");
  EXPECT_EQ(trial.notes, recording.notes);
  EXPECT_NEAR(trial.recording_duration, 5.0, 1e-9);
}

/// 30 s of sines whose force is `share` of what it was from one time to another.
Recording with_hand_away(double from, double to, double share) {
  Recording recording = sines(30000).recording;
  for (const char* const name : {"force_x", "force_y"}) {
    Vector& force = values_of(recording, name);
    for (Index i = 0; i < force.size(); ++i) {
      if (recording.time[i] >= from && recording.time[i] < to) force[i] *= share;
    }
  }
  return recording;
}

/// Message and advice of a lost contact; "" if there is no such warning.
std::string said_of_contact(const Recording& recording) {
  const auto trial = prepared(recording);
  EXPECT_TRUE(trial) << trial.error().line();
  if (!trial) return "";
  const auto found = std::ranges::find(trial->warnings, WarningCode::contact_lost, &Warning::code);
  return found == trial->warnings.end() ? "" : found->message + " | " + found->remedy;
}

TEST(LostContact, IsToldWithItsTimeWhereverItIs) {
  EXPECT_THAT(said_of_contact(with_hand_away(20.0, 31.0, 0.05)), HasSubstr("from 20 s on"));
  EXPECT_THAT(said_of_contact(with_hand_away(20.0, 31.0, 0.05)), HasSubstr("--to 19"));
  EXPECT_THAT(said_of_contact(with_hand_away(0.0, 8.0, 0.05)), HasSubstr("--from"));
  EXPECT_THAT(said_of_contact(with_hand_away(9.0, 14.0, 0.05)), HasSubstr("--from 15"));  // the longer part is after it
  EXPECT_THAT(said_of_contact(with_hand_away(20.0, 24.0, 0.05)), HasSubstr("--to 19"));
}

TEST(LostContact, IsNotToldOfWhatAHandDoes) {
  EXPECT_EQ(said_of_contact(with_hand_away(0.0, 0.0, 1.0)), "");
  EXPECT_EQ(said_of_contact(with_hand_away(15.0, 31.0, 0.3)), "");  // it relaxes
  Recording moved = with_hand_away(15.0, 20.0, 0.05);               // another movement, without the robot's force
  for (const char* const name : {"hand_x", "hand_y"}) {
    Vector& place = values_of(moved, name);
    for (Index i = 15000; i < 20000; ++i) place[i] += 0.05 * std::sin(2.0 * std::numbers::pi * moved.time[i]);
  }
  EXPECT_EQ(said_of_contact(moved), "");
}

}  // namespace prepare_test
}  // namespace mbk::preprocess
