#include "mbk/analyse/energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mbk/laboratory/scenario.h"
#include "mbk/preprocess/prepare.h"
#include "mbk/recording/inspection.h"
#include "mbk/recording/read.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace {

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

struct Real {
  const char* file;
  const char* channels;
  Verdict verdict;
  double absorbed;
};

void PrintTo(const Real& one, std::ostream* out) {
  *out << one.file;
}

class RealLimb : public testing::TestWithParam<Real> {};
constexpr const char* kAnkle = "x=position_rad,F=torque_Nm";
INSTANTIATE_TEST_SUITE_P(All, RealLimb,
                         testing::Values(Real{"ankle/z_df.csv", kAnkle, Verdict::passive, 9.98},
                                         Real{"ankle/z_pf.csv", kAnkle, Verdict::passive, 4.14},
                                         Real{"ankle/z_df2.csv", kAnkle, Verdict::passive, 7.18},
                                         Real{"c3d/Sample35_isokinetic_EMG_angle_torque.c3d", "x=Angle,F=Torque",
                                              Verdict::active, -1454.0}));

TEST_P(RealLimb, HasItsVerdict) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  recording::ReadOptions reading;
  reading.axes = 1;
  reading.channels = recording::parse_channel_map(GetParam().channels).value();
  const Recording recording = recording::read(*folder / GetParam().file, reading).value();
  const Energy energy = absorbed_energy(recording, prepared(recording)).value();
  EXPECT_EQ(energy.account.verdict, GetParam().verdict) << energy.account.reason;
  EXPECT_NEAR(energy.curve.end, GetParam().absorbed, 1e-3 * std::abs(GetParam().absorbed));
}

}  // namespace
}  // namespace mbk::pipeline
