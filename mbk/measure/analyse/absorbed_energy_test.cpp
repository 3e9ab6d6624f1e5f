#include "mbk/measure/analyse/absorbed_energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/random.h"

namespace mbk::analyse {
namespace absorbed_energy_test {

constexpr double kPi = std::numbers::pi, kRate = 1000.0, kStep = 1.0 / kRate;

using Path = std::function<Vector(double)>;

/// Position, velocity and force of the hand on the robot as functions of time, n of each, recorded at kRate.
Recording record(Index samples, const Path& position, const Path& force) {
  Recording recording;
  recording.time.resize(samples);
  const auto axes = static_cast<std::size_t>(position(0.0).size());
  const std::vector<std::string> names = axes == 1 ? std::vector<std::string>{"position", "reaction"}
                                                   : std::vector<std::string>{"hand_x", "hand_y", "force_x", "force_y"};
  for (const std::string& name : names) recording.channels.push_back({name, "", "base", Vector(samples)});
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * kStep;
    recording.time[i] = 3.0 + t;
    const Vector x = position(t), f = force(t);
    for (std::size_t k = 0; k < axes; ++k) {
      recording.channels[k].values[i] = x[static_cast<Index>(k)];
      recording.channels[axes + k].values[i] = f[static_cast<Index>(k)];
    }
  }
  return recording;
}

Vector& values_of(Recording& recording, const std::string& name) {
  for (Channel& channel : recording.channels) {
    if (channel.name == name) return channel.values;
  }
  return recording.time;
}

/// A trial of which samples [first, last] count, with one segment; only what energy asks is filled in.
PreparedTrial trial_of(const Recording& recording, Index first, Index last, int axes) {
  PreparedTrial trial;
  trial.axes = axes;
  trial.recording_rate = kRate;
  trial.sample_time = kStep;
  trial.time = recording.time.segment(first, last - first + 1).array() - recording.time[0];
  trial.segments = {{0, last - first + 1, Purpose::identification, first}};
  trial.preparation.smoothing_order = 4;
  trial.preparation.smoothing_window = 21;
  trial.preparation.from_s = trial.time[0];
  trial.preparation.to_s = trial.time[last - first];
  return trial;
}

// One axis on a mass, damper and spring, x = A sin ωt: the damper alone absorbs, b A² ω²/2 a second.
constexpr double kAmplitude = 0.01, kOmega = 2.0 * kPi * 2.0;
constexpr double kMass = 1.5, kDamping = 8.0, kStiffness = 120.0;
constexpr double kPower = kDamping * kAmplitude * kAmplitude * kOmega * kOmega / 2.0;
constexpr Index kBegin = 500, kEnd = 20500;  // 40 periods

Vector sine(double t) {
  return Vector::Constant(1, kAmplitude * std::sin(kOmega * t));
}

Vector force_on_sine(double t) {
  const double x = kAmplitude * std::sin(kOmega * t), v = kAmplitude * kOmega * std::cos(kOmega * t);
  return Vector::Constant(1, -((kStiffness - kMass * kOmega * kOmega) * x + kDamping * v) + 7.0);  // and an offset
}

Recording sine_recording() {
  return record(21001, sine, force_on_sine);
}

PreparedTrial sine_trial(const Recording& recording) {
  return trial_of(recording, kBegin, kEnd, 1);
}

TEST(AbsorbedEnergy, OfASineIsThatOfItsDamperUpToTheTrapezoids) {
  const Recording recording = sine_recording();
  const Energy energy = absorbed_energy(recording, sine_trial(recording)).value();
  // Each step of the sum is sin(ωT)/(ωT) of the integral; mass, spring and offset do no work over whole periods.
  const double expected = kPower * 20.0, sum = std::sin(kOmega * kStep) / (kOmega * kStep);
  EXPECT_NEAR(energy.account.absorbed, expected * sum, 1e-12);
  EXPECT_NEAR(energy.account.absorbed, expected, expected * std::pow(kOmega * kStep, 2) / 6.0);
  EXPECT_NEAR(energy.account.duration, 20.0, 1e-9);
  EXPECT_NEAR(energy.account.mean_power, kPower * sum, 1e-12);
  EXPECT_NEAR(energy.curve.end, kPower * 21.0 * sum, 1e-12);  // 42 periods
  EXPECT_NEAR(energy.from_s, 0.5, 1e-12);
  EXPECT_NEAR(energy.to_s, 20.5, 1e-12);
  EXPECT_NEAR(energy.left_out_s, 0.0, 1e-9);
  EXPECT_EQ(energy.account.verdict, Verdict::passive);
  EXPECT_FALSE(energy.curl);
}

TEST(AbsorbedEnergy, OfALongRecordingIsThatOfItsParts) {
  // More than the velocities and the sums of blocks that are in memory at once; whole periods, a gap in between.
  constexpr Index kSamples = 1'200'001, kGap = 700'000;
  Recording recording = record(kSamples, sine, force_on_sine);
  recording.time.tail(kSamples - kGap).array() += 1.0;
  const PreparedTrial trial = trial_of(recording, kBegin, kSamples - 501, 1);
  const Energy energy = absorbed_energy(recording, trial).value();
  const double seconds = static_cast<double>(kSamples - 1001) * kStep;
  const double sum = std::sin(kOmega * kStep) / (kOmega * kStep);
  constexpr double kLost = 0.05;  // [s] about the gap: the smoothing does not reach across it
  constexpr double kLostWork = (2.0 * kPower + 7.0 * kAmplitude * kOmega) * kLost;  // the offset's too, there
  EXPECT_NEAR(energy.account.duration, seconds, kLost);
  EXPECT_GT(energy.left_out_s, 1.0);
  EXPECT_NEAR(energy.account.absorbed, kPower * seconds * sum, kLostWork);
  EXPECT_NEAR(energy.account.shortage_at_end, -kDamping, 1e-3 * kDamping);
  EXPECT_NEAR(energy.curve.end, kPower * static_cast<double>(kSamples - 1) * kStep * sum, kLostWork);
  EXPECT_EQ(energy.account.blocks, std::ssize(energy.parts));
  double together = 0.0, squared = 0.0;
  for (const EnergyPart& part : energy.parts) {
    together += part.absorbed;
    squared += part.squared_velocity;
  }
  EXPECT_NEAR(together, energy.account.absorbed, 1e-9 * together);
  EXPECT_NEAR(squared, energy.account.squared_velocity, 1e-9 * squared);
  EXPECT_LT(energy.account.shortage_largest95.first, energy.account.shortage_largest95.second);
  EXPECT_NEAR(energy.account.shortage_largest95.first, -kDamping, 0.1 * kDamping);
}

TEST(AbsorbedEnergy, OfADamperIsAnExcessOfItsDamping) {
  const Recording recording = sine_recording();
  const Energy energy = absorbed_energy(recording, sine_trial(recording)).value();
  constexpr double kSmoothing = 1e-4;  // relative: of the sum above, and of a fourth-order window of 21 ms at 2 Hz
  EXPECT_NEAR(energy.account.shortage_at_end, -kDamping, kSmoothing * kDamping);
  EXPECT_NEAR(energy.account.squared_velocity, kPower / kDamping * 20.0, kSmoothing * energy.account.squared_velocity);
  // Within a period mass, spring and offset make λ(t) go about −b, the less the longer.
  EXPECT_GE(energy.account.shortage_largest, energy.account.shortage_at_end);
  EXPECT_LT(energy.shortage_largest_at_s, 3.0);
  ASSERT_EQ(energy.parts.size(), 8U);
  for (const EnergyPart& part : energy.parts) {
    EXPECT_NEAR(part.to_s - part.from_s, 2.5, 1e-9);
    EXPECT_NEAR(part.absorbed, 2.5 * kPower, 1e-4 * kPower);
    EXPECT_NEAR(part.path_length, 4.0 * kAmplitude * 5.0, 1e-3 * part.path_length);  // five periods
    EXPECT_NEAR(part.largest_displacement, kAmplitude, 1e-6);                        // each begins in the middle
    EXPECT_NEAR(part.shortage, -kDamping, kSmoothing * kDamping);
  }
  EXPECT_FALSE(energy.parts_are_perturbations);
}

TEST(AbsorbedEnergy, ChangesItsSignWithTheForce) {
  Recording recording = sine_recording();
  const PreparedTrial trial = sine_trial(recording);
  const Energy passive = absorbed_energy(recording, trial).value();
  values_of(recording, "reaction") *= -1.0;
  const Energy active = absorbed_energy(recording, trial).value();
  EXPECT_DOUBLE_EQ(active.account.absorbed, -passive.account.absorbed);
  EXPECT_DOUBLE_EQ(active.account.shortage_at_end, -passive.account.shortage_at_end);
  EXPECT_EQ(active.account.verdict, Verdict::active);
  EXPECT_GT(active.account.shortage_largest, 0.0);
}

TEST(AbsorbedEnergy, IsTheSumOverTheAxesWhateverTheirDirection) {
  // A circle on a damper: F = −b v. The same turned by 30° absorbs the same.
  const auto circle = [](double angle) {
    return [angle](double t) {
      return Vector((Vector(2) << std::cos(kOmega * t + angle), std::sin(kOmega * t + angle)).finished() * kAmplitude);
    };
  };
  const auto force = [](double angle) {
    return [angle](double t) {
      return Vector((Vector(2) << std::sin(kOmega * t + angle), -std::cos(kOmega * t + angle)).finished() * kDamping *
                    kAmplitude * kOmega);
    };
  };
  const Recording straight = record(6001, circle(0.0), force(0.0)), turned = record(6001, circle(0.5), force(0.5));
  const double expected = 2.0 * kPower * 5.0 * std::sin(kOmega * kStep) / (kOmega * kStep);
  for (const Recording& recording : {straight, turned}) {
    EXPECT_NEAR(absorbed_energy(recording, trial_of(recording, 500, 5500, 2)).value().account.absorbed, expected,
                1e-12);
  }
}

TEST(AbsorbedEnergy, IsNotBiasedByNoiseThatForceAndPositionShare) {
  // Each sample of both carries the same white noise. A sum with the force at one end of each step would be off by
  // σ_F σ_x for each of 20,000 samples: 2 J here.
  constexpr double kForceNoise = 1.0, kPositionNoise = 1e-4;
  const Recording clean = sine_recording();
  const PreparedTrial trial = sine_trial(clean);
  const double truth = absorbed_energy(clean, trial).value().account.absorbed;
  constexpr int kDraws = 20;
  double mean = 0.0, left = 0.0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    numeric::Random random(draw);
    Recording noisy = clean;
    Vector &x = values_of(noisy, "position"), &f = values_of(noisy, "reaction");
    for (Index i = 0; i < x.size(); ++i) {
      const double noise = random.normal();
      x[i] += kPositionNoise * noise;
      f[i] += kForceNoise * noise;
    }
    mean += (absorbed_energy(noisy, trial).value().account.absorbed - truth) / kDraws;
    for (Index i = kBegin; i < kEnd; ++i) left -= f[i] * (x[i + 1] - x[i]) / kDraws;
  }
  // Σ ηᵢ vᵢ T of the force's noise has a deviation of σ_F √(T ∫v²) = 0.013 J, a fifth of that in the mean of 20; the
  // noise times itself cancels but at both ends.
  EXPECT_NEAR(mean, 0.0, 4.0 * 0.013 / std::sqrt(kDraws));
  EXPECT_NEAR(left - truth, 2.0, 0.1);
}

TEST(AbsorbedEnergy, OfALateForceIsOffByTheDelayTimesTheStiffnessAtTheSensor) {
  // F(t − τ): a spring k − m ω² turns by ωτ and generates what a damper of −τ (k − m ω²) would.
  constexpr double kDelay = 0.002;
  const Recording late = record(21001, sine, [](double t) { return force_on_sine(t - kDelay); });
  const double expected = kDamping * std::cos(kOmega * kDelay) -
                          (kStiffness - kMass * kOmega * kOmega) * std::sin(kOmega * kDelay) / kOmega;
  EXPECT_NEAR(absorbed_energy(late, sine_trial(late)).value().account.shortage_at_end, -expected, 1e-3);
  // To first order in the delay that is what the recording itself foretells.
  const Recording prompt = sine_recording();
  const Energy energy = absorbed_energy(prompt, sine_trial(prompt)).value();
  const double at_sensor = kStiffness - kMass * kOmega * kOmega;  // F = −at_sensor x − b v
  EXPECT_NEAR(energy.added_per_delay, -at_sensor * energy.account.squared_velocity,
              1e-4 * std::abs(energy.added_per_delay));
  EXPECT_NEAR(energy.delay_that_makes_it_up, -kDamping / at_sensor, 2e-4 * std::abs(energy.delay_that_makes_it_up));
}

// Breaks

TEST(AbsorbedEnergy, DoesNotCrossAGapOfTheClock) {
  // Behind the gap the hand has jumped by 10 m: no sum may see it. Pulses allow for a gap between them.
  Recording recording = sine_recording();
  recording.time.tail(11000).array() += 4.0;
  values_of(recording, "position").tail(11000).array() += 10.0;
  const PreparedTrial trial = sine_trial(recording);
  const Energy energy = absorbed_energy(recording, trial).value();
  const double lost = 0.021;  // the step, and half a window on both sides
  EXPECT_NEAR(energy.account.duration, 20.0 - lost, 1e-9);
  EXPECT_NEAR(energy.left_out_s, 4.0 + lost, 1e-9);
  // The window loses 21 ms about a turn at which the limb gives back at most its stiffness and damping times the speed.
  const double worst = (kDamping * kAmplitude * kOmega + kStiffness * kAmplitude + 7.0) * kAmplitude * kOmega * lost;
  EXPECT_NEAR(energy.account.absorbed, kPower * 20.0, worst);
  EXPECT_NEAR(energy.curve.end, kPower * 21.0, worst);
  EXPECT_EQ(energy.curve.time.array().isNaN().count(), 1);
  EXPECT_LT(energy.parts.back().path_length, 1.0);
}

TEST(AbsorbedEnergy, LeavesOutValuesThatAreNoNumbers) {
  Recording recording = sine_recording();
  values_of(recording, "reaction")[100] = kNaN;                                       // outside the window
  values_of(recording, "position")[20800] = std::numeric_limits<double>::infinity();  // and on its other side
  const Energy energy = absorbed_energy(recording, sine_trial(recording)).value();
  EXPECT_NEAR(energy.account.absorbed, kPower * 20.0, 1e-3);
  EXPECT_TRUE(std::isfinite(energy.curve.end));
  EXPECT_TRUE(energy.curve.absorbed.allFinite());
}

TEST(AbsorbedEnergy, KeepsTheExtremesOfItsCurve) {
  // 21,001 samples are drawn as some 2000 points, and one brief exchange of 1 J stands out of them.
  Recording recording = sine_recording();
  values_of(recording, "position")[7000] += 0.5;
  const Energy energy = absorbed_energy(recording, sine_trial(recording)).value();
  EXPECT_LT(energy.curve.time.size(), 2500);
  const double swing = energy.curve.absorbed.maxCoeff() - energy.curve.absorbed.minCoeff();
  EXPECT_GT(swing, 3.0);  // the offset of 7 N over 0.5 m, there and back
  EXPECT_NEAR(energy.curve.end, kPower * 21.0, 0.1);
}

// Pulses

/// Pulses of 600 samples from 400 on, every 1000 samples; the filters took 10 samples at each end.
PreparedTrial pulses_of(Recording& recording, int count) {
  Vector reference = Vector::Zero(recording.samples());
  PreparedTrial trial = trial_of(recording, 0, recording.samples() - 1, 1);
  trial.preparation.protocol = Protocol::underdamped;
  trial.segments.clear();
  std::vector<Index> kept;
  for (Index k = 0; k < count; ++k) {
    const Index onset = 400 + 1000 * k;
    reference.segment(onset, 600).setConstant(0.005);
    const auto row = static_cast<Index>(kept.size());
    for (Index i = onset + 10; i < onset + 590; ++i) kept.push_back(i);
    trial.segments.push_back({row, row + 580, Purpose::identification, onset + 10});
  }
  trial.time = recording.time(kept).array() - recording.time[0];
  recording.channels.push_back({"reference", "", "base", reference});
  return trial;
}

TEST(Perturbations, AreListedFromOnsetToOffsetAndFillTheWindowFromOnsetToOnset) {
  Recording recording = sine_recording();
  const PreparedTrial trial = pulses_of(recording, 16);
  const Energy energy = absorbed_energy(recording, trial).value();
  EXPECT_TRUE(energy.parts_are_perturbations);
  ASSERT_EQ(energy.parts.size(), 16U);
  EXPECT_NEAR(energy.parts[2].from_s, 2.4, 1e-9);
  EXPECT_NEAR(energy.parts[2].to_s, 2.999, 1e-9);  // the last sample at which the reference is displaced
  EXPECT_EQ(energy.account.blocks, 16);
  // The window runs on through the pauses, from 10 samples after the first onset to 10 before the last offset.
  EXPECT_NEAR(energy.from_s, 0.410, 1e-9);
  EXPECT_NEAR(energy.to_s, 15.989, 1e-9);
  EXPECT_NEAR(energy.account.duration, energy.to_s - energy.from_s, 1e-9);
  double largest = 0.0;
  for (Index i = 2400; i < 3000; ++i) {
    largest = std::max(largest, std::abs(recording.channels[0].values[i] - recording.channels[0].values[2400]));
  }
  EXPECT_DOUBLE_EQ(energy.parts[2].largest_displacement, largest);
  // The sine has the same phase at each onset, so that the first and the last, which reach beyond the window, are as
  // the others are.
  for (const EnergyPart& part : energy.parts) {
    EXPECT_NEAR(part.absorbed, energy.parts[7].absorbed, 1e-12);
    EXPECT_NEAR(part.squared_velocity, energy.parts[7].squared_velocity, 1e-12);
  }
}

TEST(Perturbations, WithoutAReferenceAreTheSegmentsThemselves) {
  Recording recording = sine_recording();
  const PreparedTrial trial = pulses_of(recording, 16);
  recording.channels.pop_back();
  const Energy energy = absorbed_energy(recording, trial).value();
  EXPECT_NEAR(energy.parts[2].from_s, 2.410, 1e-9);
  EXPECT_NEAR(energy.parts[2].to_s, 2.989, 1e-9);
}

TEST(Perturbations, OfFewerRowsCoverTheSameSamples) {
  Recording recording = sine_recording();
  PreparedTrial trial = pulses_of(recording, 16);
  const Energy every = absorbed_energy(recording, trial).value();
  // Every fourth row: 145 of 580, the last of them three samples before the end.
  trial.preparation.every = 4;
  trial.sample_time = 4.0 * kStep;
  std::vector<Index> kept;
  for (Segment& segment : trial.segments) {
    const auto row = static_cast<Index>(kept.size());
    for (Index i = segment.begin; i < segment.end; i += 4) kept.push_back(i);
    segment.begin = row;
    segment.end = row + 145;
  }
  trial.time = Vector(trial.time(kept));
  const Energy fewer = absorbed_energy(recording, trial).value();
  for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(fewer.parts[k].absorbed, every.parts[k].absorbed);
  EXPECT_NEAR(fewer.to_s, every.to_s - 3.0 * kStep, 1e-9);
}

// The antisymmetric part

TEST(CurlWork, OnAnEllipseIsTwiceItsAreaTimesTheAntisymmetricStiffness) {
  // x = a cos ωt, y = b sin ωt: ∮(x dy − y dx) = 2 π a b, so that a turn to the left absorbs −2 π a b k_a.
  constexpr double kA = 0.02, kB = 0.01;
  const Vector centre = (Vector(2) << 0.3, -0.05).finished();
  impedance::Model model{Matrix::Zero(2, 2), Matrix::Zero(2, 2), (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished(),
                         centre};
  const double k_a = (-20.9 + 36.3) / 2.0;
  const Path ellipse = [&](double t) {
    return Vector(centre + (Vector(2) << kA * std::cos(kOmega * t), kB * std::sin(kOmega * t)).finished());
  };
  // The force of that stiffness alone: its potential part does no work over whole turns, so that all of E is curl.
  const Path force = [&](double t) { return Vector(-model.K * (ellipse(t) - centre)); };
  const Recording recording = record(16001, ellipse, force);
  const PreparedTrial trial = trial_of(recording, 500, 15500, 2);
  const Energy energy = absorbed_energy(recording, trial, {}, &model).value();
  ASSERT_TRUE(energy.curl);
  EXPECT_DOUBLE_EQ(energy.curl->k_a, k_a);
  const double expected = -2.0 * kPi * kA * kB * k_a * 30.0;  // thirty turns; polygons of 500 corners are 3e-5 smaller
  EXPECT_NEAR(energy.curl->absorbed, expected, 3e-5 * std::abs(expected));
  EXPECT_NEAR(energy.curl->share, 1.0, 1e-12);
  EXPECT_NEAR(energy.account.absorbed, energy.curl->absorbed, 1e-12);
  EXPECT_NEAR(energy.curve.curl[energy.curve.curl.size() - 1], 16.0 / 15.0 * expected, 1e-4 * std::abs(expected));
  EXPECT_EQ(energy.account.verdict, Verdict::active);
  // Where the equilibrium is not known the middle of the path stands for it.
  model.x0.setConstant(kNaN);
  EXPECT_NEAR(absorbed_energy(recording, trial, {}, &model).value().curl->absorbed, expected,
              3e-5 * std::abs(expected));
  model.K = (Matrix(2, 2) << 42.4, -28.6, -28.6, 125.3).finished();
  EXPECT_EQ(absorbed_energy(recording, trial, {}, &model).value().curl->absorbed, 0.0);
}

// What cannot be

std::string error_of(const Recording& recording, const PreparedTrial& trial, const EnergyOptions& options = {}) {
  const auto energy = absorbed_energy(recording, trial, options);
  return energy ? "none" : energy.error().line();
}

TEST(AbsorbedEnergy, NamesWhatIsMissing) {
  Recording recording = sine_recording();
  const PreparedTrial trial = sine_trial(recording);
  Recording no_force = recording;
  no_force.channels.pop_back();
  EXPECT_NE(error_of(no_force, trial).find("force"), std::string::npos);
  Recording no_position = recording;
  no_position.channels.erase(no_position.channels.begin());
  EXPECT_NE(error_of(no_position, trial).find("position"), std::string::npos);
  Recording still = recording;
  values_of(still, "position").setConstant(0.3);
  EXPECT_NE(error_of(still, trial).find("window"), std::string::npos);
  Recording one = recording;
  one.time.conservativeResize(1);
  for (Channel& channel : one.channels) channel.values.conservativeResize(1);
  EXPECT_NE(error_of(one, trial).find("1 sample"), std::string::npos);
  EXPECT_NE(error_of({}, trial).find("0 samples"), std::string::npos);
}

TEST(AbsorbedEnergy, RefusesATrialOfAnotherRecording) {
  const Recording recording = sine_recording();
  const PreparedTrial trial = sine_trial(recording);
  Recording shorter = recording;
  shorter.time.conservativeResize(kEnd);
  for (Channel& channel : shorter.channels) channel.values.conservativeResize(kEnd);
  EXPECT_NE(error_of(shorter, trial).find("recording"), std::string::npos);
  Recording slower = recording;
  slower.time *= 2.0;
  EXPECT_NE(error_of(slower, trial).find("recording"), std::string::npos);
  PreparedTrial nothing = trial;
  nothing.segments.clear();
  EXPECT_NE(error_of(recording, nothing).find("row"), std::string::npos);
  EXPECT_NE(error_of(recording, trial_of(recording, 700, 700, 1)).find("sample"), std::string::npos);
}

TEST(AbsorbedEnergy, RefusesOptionsOutOfRange) {
  const Recording recording = sine_recording();
  const PreparedTrial trial = sine_trial(recording);
  for (const EnergyOptions& options :
       {EnergyOptions{.block_s = 0.0}, EnergyOptions{.block_s = kNaN}, EnergyOptions{.first_share = 0.0},
        EnergyOptions{.first_share = 1.0}, EnergyOptions{.replicates = 99}}) {
    const auto energy = absorbed_energy(recording, trial, options);
    ASSERT_FALSE(energy);
    EXPECT_EQ(energy.error().kind, ErrorKind::usage);
  }
}

TEST(PooledEnergy, AddsEnergiesAndBlocks) {
  const std::vector<Recording> both = {sine_recording(), sine_recording()};
  const std::vector<PreparedTrial> trials = {sine_trial(both[0]), sine_trial(both[1])};
  const EnergyAccount one = absorbed_energy(both[0], trials[0]).value().account;
  const EnergyAccount pooled = pooled_energy(std::vector{&both[0], &both[1]}, trials).value();
  EXPECT_DOUBLE_EQ(pooled.absorbed, 2.0 * one.absorbed);
  EXPECT_DOUBLE_EQ(pooled.duration, 2.0 * one.duration);
  EXPECT_DOUBLE_EQ(pooled.mean_power, one.mean_power);
  EXPECT_DOUBLE_EQ(pooled.shortage_at_end, one.shortage_at_end);
  EXPECT_EQ(pooled.blocks, 2 * one.blocks);
  EXPECT_EQ(pooled_energy(std::vector{&both[0]}, {trials.data(), 1}).value().absorbed95, one.absorbed95);
}

TEST(PooledEnergy, RefusesWhatDoesNotBelongTogether) {
  const std::vector<Recording> both = {sine_recording(), sine_recording()};
  std::vector<PreparedTrial> trials = {sine_trial(both[0]), sine_trial(both[1])};
  EXPECT_FALSE(pooled_energy({}, {}));
  EXPECT_FALSE(pooled_energy(std::vector{&both[0], &both[1]}, {trials.data(), 1}));
  trials[1].motion = Motion::rotation;
  EXPECT_FALSE(pooled_energy(std::vector{&both[0], &both[1]}, trials));
}

}  // namespace absorbed_energy_test
}  // namespace mbk::analyse
