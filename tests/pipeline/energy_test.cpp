#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/analyse/absorbed_energy.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace energy_test {

using analyse::absorbed_energy;

PreparedTrial prepared(const Recording& recording, const preprocess::Options& options = {}) {
  return preprocess::prepare(recording, recording::inspect(recording), options).value();
}

laboratory::Scenario ready(const std::string& name, std::uint64_t seed) {
  auto scenario =
      laboratory::read_scenarios(laboratory::find_ready_scenario(name)->text, name + ".toml").value().front();
  scenario.seed = seed;
  return scenario;
}

struct Condition {
  const char* scenario;
  Verdict verdict;
};

void PrintTo(const Condition& one, std::ostream* out) {
  *out << one.scenario;
}

class ReadyScenario : public testing::TestWithParam<Condition> {};
INSTANTIATE_TEST_SUITE_P(All, ReadyScenario,
                         testing::Values(Condition{"relaxed_sinusoidal", Verdict::passive},
                                         Condition{"relaxed_underdamped", Verdict::passive},
                                         Condition{"rigid_underdamped_2N", Verdict::active},
                                         Condition{"rigid_underdamped_8N", Verdict::passive},
                                         Condition{"rigid_sinusoidal_6N", Verdict::passive}),
                         [](const auto& one) { return std::string(one.param.scenario); });

// The findings of Dyck 2013, figs. 3.15, 3.17, 4.3 and 4.4: simulated, by a participant whose gains are tuned to them.
TEST_P(ReadyScenario, HasTheVerdictOfTheThesisWithEverySeed) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto performance = laboratory::simulate(ready(GetParam().scenario, seed)).value();
    const Energy energy = absorbed_energy(performance.recording, prepared(performance.recording)).value();
    EXPECT_EQ(energy.account.verdict, GetParam().verdict) << energy.account.reason;
  }
}

/// A simulated trial and what no sensor sees of it.
struct Watched {
  Recording recording;
  std::vector<double> absorbed;  ///< at each sample, past the sensor: with what the handle keeps [J]
  double exchanged = 0;          ///< ∫ |F_h·v| dt [J]

  /// Between two samples, by their times [s] from the first.
  [[nodiscard]] double between(double from, double to) const {
    const auto at = [&](double seconds) {
      Index i = 0;
      while (recording.time[i] - recording.time[0] < seconds) ++i;
      return absorbed[static_cast<std::size_t>(i)];
    };
    return at(to) - at(from);
  }
};

Watched watched(const laboratory::Scenario& scenario) {
  Watched trial;
  laboratory::SimulateOptions options;
  options.watch = [&](const laboratory::TrueState<2>& state) { trial.absorbed.push_back(state.energy.absorbed); };
  auto performance = laboratory::simulate(scenario, options).value();
  trial.recording = std::move(performance.recording);
  trial.exchanged = performance.energy_exchanged;
  return trial;
}

/// Error of E over the whole recording by more than the noise of the force, relative to what was exchanged: trapezoids
/// err by (ωT)²/6 of what a damper absorbs, 6e-5 at 3 Hz.
constexpr double kTrapezoids = 1e-4;

class PlanarScenario : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, PlanarScenario,
                         testing::Values("relaxed_sinusoidal", "relaxed_underdamped", "rigid_underdamped_2N",
                                         "rigid_underdamped_8N", "rigid_sinusoidal_6N"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(PlanarScenario, HasTheEnergyThatTheLaboratoryIntegrated) {
  laboratory::Scenario scenario = ready(GetParam(), 7);
  std::get<laboratory::PlanarTrial>(scenario.trial).sensors = laboratory::SensorOptions<2>::perfect();
  const Watched trial = watched(scenario);
  const Energy energy = absorbed_energy(trial.recording, prepared(trial.recording)).value();
  EXPECT_NEAR(energy.curve.end, trial.absorbed.back(), kTrapezoids * trial.exchanged);
}

TEST_P(PlanarScenario, HasItThroughSensorsUpToTheNoiseOfTheForce) {
  const Watched trial = watched(ready(GetParam(), 7));
  const PreparedTrial rows = prepared(trial.recording);
  const Energy energy = absorbed_energy(trial.recording, rows).value();
  const double truth = trial.between(energy.from_s, energy.to_s);
  // White noise w of the load cell adds Σ w·(x_{i+1} − x_{i−1})/2, of deviation σ √(T ∫ v·v dt).
  const double deviation =
      laboratory::LoadCellOptions<2>{}.white_noise * std::sqrt(energy.account.squared_velocity / rows.recording_rate);
  EXPECT_NEAR(energy.account.absorbed, truth, 4.0 * deviation + kTrapezoids * trial.exchanged);
  // Through the filters of the fit, which take some of the motion, it errs by more than a hundredth of a joule where
  // the perturbation lasts, so that the same samples are used.
  if (rows.preparation.protocol != Protocol::sinusoidal) return;
  double filtered = 0.0;
  for (Index i = 0; i + 1 < rows.time.size(); ++i) {
    filtered -= 0.5 * rows.sample_time *
                (rows.force_hand_on_robot.row(i).dot(rows.velocity.row(i)) +
                 rows.force_hand_on_robot.row(i + 1).dot(rows.velocity.row(i + 1)));
  }
  EXPECT_GT(std::abs(filtered - truth), 10.0 * std::abs(energy.account.absorbed - truth));
}

TEST(OneAxisScenario, HasTheEnergyThatTheLaboratoryIntegrated) {
  laboratory::Scenario scenario = ready("ankle_reflex", 7);
  const auto performance = laboratory::simulate(scenario).value();
  const Energy energy = absorbed_energy(performance.recording, prepared(performance.recording)).value();
  // (ωT)²/6 at 10 Hz, where the servo moves the joint, is 7e-4.
  EXPECT_NEAR(energy.curve.end, performance.energy_absorbed, 1e-3 * performance.energy_exchanged);
}

TEST(PooledEnergy, OfTrialsIsTheirSumAndSurerThanOneOfThem) {
  std::vector<Recording> recordings;
  std::vector<PreparedTrial> trials;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    recordings.push_back(laboratory::simulate(ready("rigid_underdamped_2N", seed)).value().recording);
    trials.push_back(prepared(recordings.back()));
    sum += absorbed_energy(recordings.back(), trials.back()).value().account.absorbed;
  }
  const EnergyAccount one = absorbed_energy(recordings[0], trials[0]).value().account;
  const EnergyAccount all =
      analyse::pooled_energy(std::vector{&recordings[0], &recordings[1], &recordings[2]}, trials).value();
  EXPECT_NEAR(all.absorbed, sum, 1e-12);
  EXPECT_EQ(all.blocks, 48);
  EXPECT_EQ(all.verdict, Verdict::active);
  const auto width = [](const Interval& interval) { return interval.second - interval.first; };
  EXPECT_LT(width(all.shortage_at_end95), width(one.shortage_at_end95));
  EXPECT_LT(width(all.mean_power95), width(one.mean_power95));
}

TEST(Perturbations, AreListedFromTheirOnsetToTheirOffset) {
  const Recording recording = laboratory::simulate(ready("rigid_underdamped_2N", 3)).value().recording;
  const Energy energy = absorbed_energy(recording, prepared(recording)).value();
  ASSERT_TRUE(energy.parts_are_perturbations);
  ASSERT_EQ(energy.parts.size(), 16U);
  std::vector<double> onsets, offsets;
  for (const Event& event : recording.events) {
    if (event.name == "onset") onsets.push_back(event.time);
    if (event.name == "offset") offsets.push_back(event.time);
  }
  ASSERT_EQ(onsets.size(), 16U);
  ASSERT_EQ(offsets.size(), 16U);
  for (std::size_t k = 0; k < 16; ++k) {
    // Events have times of their own; a sample is 1 ms, and the recording's first sample comes within it.
    EXPECT_NEAR(energy.parts[k].from_s, onsets[k] - recording.time[0], 2e-3);
    EXPECT_NEAR(energy.parts[k].to_s, offsets[k] - recording.time[0], 2e-3);
    EXPECT_GT(energy.parts[k].largest_displacement, 1e-3);  // of 2 N against a stiffness of some 100 N/m and more
    EXPECT_GE(energy.parts[k].path_length, 0.9 * energy.parts[k].largest_displacement);
  }
}

TEST(AbsorbedEnergy, HasTheSameVerdictInReferenceMode) {
  const Recording recording = laboratory::simulate(ready("rigid_underdamped_2N", 5)).value().recording;
  preprocess::Options published;
  published.mode = Mode::reference;
  const Energy own = absorbed_energy(recording, prepared(recording)).value(),
               theirs = absorbed_energy(recording, prepared(recording, published)).value();
  EXPECT_EQ(theirs.account.verdict, Verdict::active);
  ASSERT_EQ(theirs.parts.size(), own.parts.size());
  for (std::size_t k = 0; k < own.parts.size(); ++k) {
    EXPECT_EQ(theirs.parts[k].from_s, own.parts[k].from_s);
    EXPECT_EQ(theirs.parts[k].absorbed, own.parts[k].absorbed);
  }
}

constexpr const char* kAnkle = "x=position_rad,F=torque_Nm";
constexpr const char* kKnee = "c3d/Sample35_isokinetic_EMG_angle_torque.c3d";

Recording read_outside(const std::filesystem::path& file, const char* channels) {
  recording::ReadOptions reading;
  reading.axes = 1;
  reading.channels = recording::parse_channel_map(channels).value();
  return recording::read(file, reading).value();
}

struct Real {
  const char* file;
  const char* channels;
  Verdict verdict;
  double absorbed;
};

void PrintTo(const Real& one, std::ostream* out) {
  *out << one.file;
}

class RealLimb : public testing::TestWithParam<Real> {
 protected:
  static Recording read() { return read_outside(*data_folder() / GetParam().file, GetParam().channels); }
};
INSTANTIATE_TEST_SUITE_P(All, RealLimb,
                         testing::Values(Real{"ankle/z_df.csv", kAnkle, Verdict::passive, 9.98},
                                         Real{"ankle/z_pf.csv", kAnkle, Verdict::passive, 4.14},
                                         Real{"ankle/z_df2.csv", kAnkle, Verdict::passive, 7.18},
                                         Real{kKnee, "x=Angle,F=Torque", Verdict::active, -1454.0}),
                         [](const auto& one) {
                           return std::filesystem::path(one.param.file).stem().string().substr(0, 8);
                         });

TEST_P(RealLimb, HasItsVerdict) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const Recording recording = read();
  const Energy energy = absorbed_energy(recording, prepared(recording)).value();
  EXPECT_EQ(energy.account.verdict, GetParam().verdict) << energy.account.reason;
  EXPECT_NEAR(energy.curve.end, GetParam().absorbed, 1e-3 * std::abs(GetParam().absorbed));
}

// Torque and angle of the knee share noise: each end of the steps by itself is off by hundreds of joules, and what is
// off cancels in the mean of both. The angle's noise also drowns the velocity, unless the smoothing is long enough.
TEST(RealKnee, NeedsBothEndsOfEachStepAndALongSmoothing) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const Recording recording = read_outside(*folder / kKnee, "x=Angle,F=Torque");
  preprocess::Options smooth;
  smooth.smoothing_window = 201;
  smooth.cutoff = Hertz(5.0);
  const PreparedTrial trial = prepared(recording, smooth);
  const Energy energy = absorbed_energy(recording, trial).value(),
               noisy = absorbed_energy(recording, prepared(recording)).value();
  const Vector &x = recording.find("position")->values, &f = recording.find("reaction")->values;
  const Index steps = x.size() - 1;
  const Vector moved = x.tail(steps) - x.head(steps);
  const double left = -f.head(steps).dot(moved), right = -f.tail(steps).dot(moved);
  EXPECT_GT(std::abs(right - left), 500.0);
  // What was low-passed is free of the noise, and of what little energy is above 5 Hz.
  double slow = 0.0;
  for (Index i = 0; i + 1 < trial.time.size(); ++i) {
    slow -= 0.5 * trial.sample_time *
            (trial.force_hand_on_robot(i, 0) * trial.velocity(i, 0) +
             trial.force_hand_on_robot(i + 1, 0) * trial.velocity(i + 1, 0));
  }
  EXPECT_NEAR(energy.account.absorbed, slow, 0.03 * std::abs(slow));
  EXPECT_GT(energy.account.shortage_at_end, 10.0);
  EXPECT_LT(noisy.account.shortage_at_end, 1.0);
  EXPECT_EQ(noisy.account.verdict, energy.account.verdict);  // which asks for no velocity
}

// Below 5 Hz the ankle z_pf generates, by its reflexes; over the band in which it was moved it absorbs.
TEST(RealAnkle, IsActiveBelowFiveHertzAndPassiveOverTheBand) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const Recording recording = read_outside(*folder / "ankle/z_pf.csv", kAnkle);
  preprocess::Options slow;
  slow.smoothing_window = 101;
  slow.cutoff = Hertz(5.0);
  const PreparedTrial trial = prepared(recording, slow);
  const double power = -trial.force_hand_on_robot.col(0).dot(trial.velocity.col(0)) * trial.sample_time;
  EXPECT_LT(power, -2.0);
  EXPECT_GT(absorbed_energy(recording, trial).value().account.lower95, 2.0);
}

// Of an ankle that is moved up to 50 Hz, inertia makes up most of the torque, so that E wants force and position to be
// simultaneous: one sample more or less changes it by some joules.
TEST_P(RealLimb, ForetellsWhatADelayOfTheForceDoes) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  Recording recording = read();
  const PreparedTrial trial = prepared(recording);
  const Energy energy = absorbed_energy(recording, trial).value();
  for (Channel& channel : recording.channels) {
    if (channel.name != "reaction") continue;
    const Vector recorded = channel.values;
    channel.values.tail(recorded.size() - 1) = recorded.head(recorded.size() - 1);
  }
  const double added = absorbed_energy(recording, trial).value().account.absorbed - energy.account.absorbed;
  EXPECT_NEAR(added * trial.recording_rate, energy.added_per_delay, 0.15 * std::abs(energy.added_per_delay));
}

}  // namespace energy_test
}  // namespace mbk::pipeline
