#include "mbk/simulate/laboratory/record_elbow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {
namespace record_elbow_test {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Without noise in position and torque.
const std::string kPerfect = "[sensors]\nposition_resolution_rad = 0\nreaction_noise_Nm = 0\n";

Scenario stretched(const std::string& participant, const std::string& sensors = kPerfect) {
  const std::string text =
      "[recording]\nrate_hz = 2000\n[robot]\nkind = \"joint\"\nhome_deg = 80\n[perturbation]\nkind = \"stretches\"\n"
      "amplitude_deg = 70\nspeeds_deg_per_s = [60, 180]\nrepetitions = 2\nhold_s = 0.5\nreturn_s = 1\n"
      "shortest_pause_s = 0.5\nlongest_pause_s = 0.6\nquiet_s = 0.5\n[participant]\nkind = \"elbow\"\n" +
      participant + sensors;
  const auto scenarios = read_scenarios(text, "mine.toml");
  EXPECT_TRUE(scenarios) << scenarios.error().line();
  return scenarios->front();
}

const std::string kSpastic =
    "[participant.biceps]\nthreshold_deg = 135\nvelocity_gain_ms = 100\ngain_Nm_per_rad = 10\n";

double rms(const Vector& v, double from, double to) {
  const auto begin = static_cast<Index>(from * 2000.0), count = static_cast<Index>((to - from) * 2000.0);
  return std::sqrt(v.segment(begin, count).squaredNorm() / static_cast<double>(count));
}

/// Of "[1, 2]".
std::vector<double> numbers_of(const std::string& array) {
  std::istringstream text(array);
  std::vector<double> numbers;
  double number = 0.0;
  for (char separator = 0; text >> separator >> number;) numbers.push_back(number);
  return numbers;
}

TEST(RecordElbow, HasTheChannelsInTheirUnits) {
  const Recording recording = simulate(stretched("")).value().recording;
  const std::pair<const char*, const char*> expected[] = {
      {"position", "rad"}, {"reaction", "N.m"}, {"reference", "rad"}, {"emg_biceps", "V"}, {"emg_triceps", "V"}};
  ASSERT_EQ(recording.channels.size(), std::size(expected));
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    EXPECT_EQ(recording.channels[i].name, expected[i].first);
    EXPECT_EQ(recording.channels[i].unit, expected[i].second);
    EXPECT_EQ(recording.channels[i].values.size(), recording.samples());
  }
  EXPECT_NEAR(recording.time[1] - recording.time[0], 5e-4, 1e-12);
  EXPECT_EQ(recording.find("position")->values, recording.find("reference")->values);
  EXPECT_EQ(recording.events.size(), 8U);
}

TEST(RecordElbow, WithoutReflexTheReactionIsThatOfTheTruth) {
  const Scenario scenario = stretched("rest_deg = 95\n");
  const Performance performance = simulate(scenario).value();
  const Recording& recording = performance.recording;
  const auto schedule = perturbation::make_schedule(scenario.perturbation, scenario.seed).value();
  const Vector& torque = recording.find("reaction")->values;
  const double I = performance.truth.M(0, 0), B = performance.truth.B(0, 0), K = performance.truth.K(0, 0);
  for (Index i = 0; i < recording.samples(); ++i) {
    const auto r = schedule.at(recording.time[i]);
    const double angle = 80.0 * kDegree + r.value[0];
    ASSERT_NEAR(torque[i], -(I * r.second[0] + B * r.first[0] + K * (angle - 95.0 * kDegree)), 1e-12) << i;
  }
  EXPECT_EQ(recording.metadata.at("truth_x0"), "[1.65806278939]");
  EXPECT_FALSE(recording.metadata.contains("truth_biceps_threshold_rad"));
}

TEST(RecordElbow, EmgRisesALatencyAfterTheDynamicThreshold) {
  const Scenario scenario =
      stretched("[participant.biceps]\nthreshold_deg = 135\nvelocity_gain_ms = 100\ngain_Nm_per_rad = 40\n", "");
  const Recording recording = simulate(scenario).value().recording;
  const auto schedule = perturbation::make_schedule(scenario.perturbation, scenario.seed).value();
  const Vector& biceps = recording.find("emg_biceps")->values;
  for (const auto& stretch : schedule.stretches()->stretches()) {
    const double threshold = 135.0 * kDegree - 0.1 * stretch.speed;
    // on the plateau the angle is that of a constant velocity, begun half a change of speed later
    const double onset = 0.5 * (stretch.onset + stretch.fast) + (threshold - 80.0 * kDegree) / stretch.speed + 0.03;
    ASSERT_GT(onset - 0.03, stretch.fast);
    EXPECT_LT(rms(biceps, onset - 0.1, onset - 0.001), 4e-6);
    EXPECT_GT(rms(biceps, onset + 0.02, onset + 0.06), 9e-6);  // 3 µV before
    EXPECT_LT(rms(recording.find("emg_triceps")->values, onset + 0.02, onset + 0.06), 5e-6);
  }
}

TEST(RecordElbow, TruthHasTheAnglesOfEverySpeed) {
  const auto metadata = simulate(stretched(kSpastic)).value().recording.metadata;
  const auto of = [&](const char* key) { return numbers_of(metadata.at(key)); };
  const auto speeds = of("truth_stretch_speed_rad_per_s"), thresholds = of("truth_stretch_threshold_rad");
  ASSERT_EQ(speeds.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const double v = speeds[k];
    EXPECT_NEAR(v, (k == 0 ? 60.0 : 180.0) * kDegree, 1e-9);
    EXPECT_NEAR(thresholds[k], 135.0 * kDegree - 0.1 * v, 1e-6);
    EXPECT_NEAR(of("truth_stretch_emg_rad")[k], 135.0 * kDegree - 0.1 * v + 0.03 * v, 1e-6);
    EXPECT_NEAR(of("truth_stretch_catch_rad")[k], 135.0 * kDegree - 0.1 * v + 0.06 * v, 1e-6);
  }
  EXPECT_EQ(metadata.at("truth_biceps_velocity_gain_s"), "0.1");
  EXPECT_EQ(metadata.at("truth_biceps_latency_s"), "0.03");
  EXPECT_EQ(metadata.at("truth_biceps_reflex_gain_Nm_per_rad"), "10");
  const std::string beyond = "[participant.biceps]\nthreshold_deg = 175\ngain_Nm_per_rad = 10\n";
  EXPECT_EQ(simulate(stretched(beyond)).value().recording.metadata.at("truth_stretch_catch_rad"), "[null, null]");
}

TEST(RecordElbow, ASeedRepeatsEveryBitAndNoiseOfTheEmgLeavesTheTorque) {
  Scenario scenario = stretched(kSpastic + "threshold_spread_deg = 3\n", "");
  const Recording first = simulate(scenario).value().recording, again = simulate(scenario).value().recording;
  std::get<ElbowTrial>(scenario.trial).emg.noise = 1e-5;
  const Recording noisy = simulate(scenario).value().recording;
  for (std::size_t c = 0; c < first.channels.size(); ++c) {
    EXPECT_EQ(first.channels[c].values, again.channels[c].values) << first.channels[c].name;
    const bool emg = first.channels[c].unit == "V";
    EXPECT_EQ(first.channels[c].values == noisy.channels[c].values, !emg) << first.channels[c].name;
  }
}

TEST(RecordElbow, RefusesABandBeyondHalfTheRate) {
  Scenario scenario = stretched("");
  scenario.rate = Hertz(800.0);
  const auto refused = simulate(scenario);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("rate_hz"), std::string::npos);
}

}  // namespace record_elbow_test
}  // namespace mbk::laboratory
