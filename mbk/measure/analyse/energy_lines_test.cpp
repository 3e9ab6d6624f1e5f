#include "mbk/measure/analyse/energy_lines.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

constexpr double kRate = 500.0, kPeriod = 4.0, kAmplitude = 0.01, kNoise = 0.3;
constexpr std::array kHarmonics = {1, 3, 8};
constexpr std::array kDampers = {6.0, -4.0, 9.0};  ///< [N·s/m] at each harmonic: the second line delivers
constexpr Index kSamples = 10'100;                 ///< five periods and a bit

double omega_of(std::size_t line) {
  return 2.0 * std::numbers::pi * kHarmonics[line] / kPeriod;
}

/// A mass of 1 kg on a spring of 80 N/m, with a damper of its own at each frequency; x and y have other phases.
Recording recording_of(std::uint64_t seed) {
  Recording recording;
  recording.time = Vector::LinSpaced(kSamples, 0.0, (kSamples - 1) / kRate);
  for (const char* name : {"hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y"}) {
    recording.channels.push_back({name, "", "base", Vector::Zero(kSamples)});
  }
  numeric::Random random(seed);
  for (Index i = 0; i < kSamples; ++i) {
    const double t = recording.time[i];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double x = 0.0, force = 0.0;
      for (std::size_t line = 0; line < kHarmonics.size(); ++line) {
        const double w = omega_of(line), phase = w * t + 1.3 * static_cast<double>(axis * (line + 1));
        x += kAmplitude * std::sin(phase);
        force -= kAmplitude * ((80.0 - w * w) * std::sin(phase) + kDampers[line] * w * std::cos(phase));
      }
      recording.channels[axis].values[i] = x;
      recording.channels[2 + axis].values[i] = force + kNoise * random.normal();
      recording.channels[4 + axis].values[i] = x;
    }
  }
  return recording;
}

PreparedTrial trial_of(const Recording& recording) {
  PreparedTrial trial;
  trial.recording_rate = kRate;
  trial.sample_time = 1.0 / kRate;
  trial.time = recording.time;
  trial.segments = {{0, recording.samples(), Purpose::identification, 0}};
  trial.preparation.protocol = Protocol::sinusoidal;
  return trial;
}

std::vector<EnergyLine> lines_of(const Recording& recording, Protocol protocol = Protocol::sinusoidal) {
  const Recording* const one = &recording;
  PreparedTrial trial = trial_of(recording);
  trial.preparation.protocol = protocol;
  return energy_lines(line_spectra({&one, 1}, {&trial, 1}));
}

TEST(EnergyLines, AreThoseOfTheDamperAtEachFrequency) {
  const std::vector<EnergyLine> lines = lines_of(recording_of(1));
  ASSERT_EQ(lines.size(), kHarmonics.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double w = omega_of(k), truth = 5.0 * kPeriod * kDampers[k] * kAmplitude * kAmplitude * w * w;  // two axes
    EXPECT_NEAR(lines[k].frequency.value, kHarmonics[k] / kPeriod, 1e-12);
    EXPECT_LT(lines[k].absorbed95.first, truth);
    EXPECT_GT(lines[k].absorbed95.second, truth);
    EXPECT_GT(kDampers[k] * lines[k].absorbed95.first, 0.0) << "the sign is sure";
    EXPECT_GT(kDampers[k] * lines[k].absorbed95.second, 0.0);
  }
}

// The first period is not one where the perturbation grows from rest.
TEST(EnergyLines, LeaveOutWhereThePerturbationGrowsFromRest) {
  Recording growing = recording_of(1);
  for (Channel& channel : growing.channels) {
    for (Index i = 0; i < 1500; ++i) channel.values[i] *= static_cast<double>(i) / 1500.0;
  }
  const std::vector<EnergyLine> lines = lines_of(growing), all = lines_of(recording_of(1));
  ASSERT_EQ(lines.size(), all.size());
  EXPECT_DOUBLE_EQ(all[0].duration, 5.0 * kPeriod);
  EXPECT_DOUBLE_EQ(lines[0].duration, 4.0 * kPeriod);
  for (std::size_t k = 0; k < lines.size(); ++k) EXPECT_NEAR(lines[k].frequency.value, kHarmonics[k] / kPeriod, 1e-12);
  const double w = omega_of(2), truth = 4.0 * kPeriod * kDampers[2] * kAmplitude * kAmplitude * w * w;
  EXPECT_LT(lines[2].absorbed95.first, truth);
  EXPECT_GT(lines[2].absorbed95.second, truth);
}

TEST(EnergyLines, HaveIntervalsThatHoldAllOfThemTogetherAsOftenAsTheySay) {
  int held = 0;
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    bool all = true;
    const std::vector<EnergyLine> lines = lines_of(recording_of(100 + static_cast<std::uint64_t>(run)));
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const double w = omega_of(k), truth = 5.0 * kPeriod * kDampers[k] * kAmplitude * kAmplitude * w * w;
      all = all && lines[k].absorbed95.first <= truth && truth <= lines[k].absorbed95.second;
    }
    held += all ? 1 : 0;
  }
  EXPECT_GE(held, 277);  // 95 % of 300, less two and a half standard deviations
}

TEST(EnergyLines, OfSeveralRecordingsAddUp) {
  const Recording a = recording_of(1), b = recording_of(2);
  const std::array<const Recording*, 2> both = {&a, &b};
  const std::vector<PreparedTrial> trials = {trial_of(a), trial_of(b)};
  const auto one = lines_of(a), two = lines_of(b), together = energy_lines(line_spectra(both, trials));
  ASSERT_EQ(together.size(), one.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_NEAR(together[k].absorbed, one[k].absorbed + two[k].absorbed, 1e-12);
  }
}

TEST(EnergyLines, AreNotThereWhereThereIsNoneToSpeakOf) {
  const Recording good = recording_of(1);
  EXPECT_TRUE(lines_of(good, Protocol::underdamped).empty());
  Recording without = good;
  without.channels.resize(4);
  EXPECT_TRUE(lines_of(without).empty());
  Recording gap = good;
  gap.time.tail(1000).array() += 0.5;
  EXPECT_TRUE(lines_of(gap).empty());
  Recording broken = good;
  broken.channels[2].values[700] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(lines_of(broken).empty());
  Recording noise = good;
  numeric::Random random(5);
  for (const std::size_t axis : {4U, 5U}) {
    double level = 0.0;
    for (double& value : noise.channels[axis].values) value = level += 0.05 * random.normal() - 0.02 * level;
  }
  EXPECT_TRUE(lines_of(noise).empty());
  Recording once = good;  // less than three periods
  once.time.conservativeResize(5900);
  for (Channel& channel : once.channels) channel.values.conservativeResize(5900);
  EXPECT_TRUE(lines_of(once).empty());
}

/// M, B and K for both axes alike.
Identification model_of(double damping) {
  Identification id;
  id.axes = 2;
  id.model = {Matrix::Identity(2, 2), damping * Matrix::Identity(2, 2), 80.0 * Matrix::Identity(2, 2), Vector::Zero(2)};
  return id;
}

std::optional<AssumptionTest> test_of(Recording recording, double damping, std::array<double, 3> dampers) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (Index i = 0; i < kSamples; ++i) {
      for (std::size_t line = 0; line < kHarmonics.size(); ++line) {
        const double w = omega_of(line), phase = w * recording.time[i] + 1.3 * static_cast<double>(axis * (line + 1));
        recording.channels[2 + axis].values[i] -= kAmplitude * (dampers[line] - kDampers[line]) * w * std::cos(phase);
      }
    }
  }
  const Recording* const one = &recording;
  PreparedTrial trial = trial_of(recording);
  trial.preparation.band_high = Hertz(10.0);
  return test_lines(line_spectra({&one, 1}, {&trial, 1}), {&trial, 1}, model_of(damping));
}

TEST(Lines, AreNotExplainedByOneDamperWhereEachHasItsOwn) {
  const auto found = test_of(recording_of(1), 8.0, {6.0, -4.0, 9.0});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->contradicted);
  EXPECT_LT(found->p_value, 1e-6);
  Identification id = model_of(8.0);
  warn_of_lines(*found, id);
  ASSERT_EQ(id.warnings.size(), 1U);
  EXPECT_EQ(id.warnings[0].code, WarningCode::lack_of_fit);
}

TEST(Lines, AreExplainedByTheTruthAsOftenAsTheLevelSays) {
  int below = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    const auto found = test_of(recording_of(100 + static_cast<std::uint64_t>(run)), 6.0, {6.0, 6.0, 6.0});
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->contradicted);
    below += found->p_value < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(below, 0.05 * kRuns, 8.0);  // two and a half standard deviations
}

}  // namespace
}  // namespace mbk::analyse
