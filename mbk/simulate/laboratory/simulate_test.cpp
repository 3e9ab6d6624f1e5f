#include <gtest/gtest.h>

#include <cmath>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {
namespace simulate_test {

std::vector<Scenario> ready(const char* name) {
  const ReadyScenario* found = find_ready_scenario(name);
  EXPECT_NE(found, nullptr) << name;
  return read_scenarios(found->text, std::string(name) + ".toml").value();
}

/// The same trial, over sooner.
void shorten(Scenario& scenario) {
  auto& kind = scenario.perturbation.kind;
  if (auto* sines = std::get_if<perturbation::MultisinePlan>(&kind)) sines->duration = 8.0;
  if (auto* binary = std::get_if<perturbation::RandomBinaryPlan>(&kind)) binary->duration = 8.0;
  if (auto* pulses = std::get_if<perturbation::PulsePlan>(&kind)) {
    pulses->pulses.quiet = 0.5;
    pulses->pulses.repetitions = 1;
    pulses->pulses.longest_pause = 2.5;
  }
  if (auto* ramps = std::get_if<perturbation::RampPlan>(&kind)) ramps->ramps.repetitions = 1;
}

TEST(Simulate, RunsEveryReadyScenario) {
  EXPECT_GE(ready_scenarios().size(), 14u);
  for (const ReadyScenario& one : ready_scenarios()) {
    Scenario scenario = read_scenarios(one.text, std::string(one.name) + ".toml").value().front();
    shorten(scenario);
    const auto performance = simulate(scenario);
    ASSERT_TRUE(performance) << one.name << ": " << performance.error().line();
    for (const Channel& channel : performance->recording.channels) {
      EXPECT_TRUE(channel.values.allFinite()) << one.name << ' ' << channel.name;
    }
    EXPECT_EQ(performance->recording.metadata.at("truth_scenario"), one.name);
  }
}

TEST(Simulate, SameSeedGivesTheSameBitsAndAnotherSeedOthers) {
  Scenario scenario = ready("rigid_underdamped_2N").front();
  shorten(scenario);
  const Recording first = simulate(scenario)->recording, again = simulate(scenario)->recording;
  scenario.seed = 2;
  const Recording other = simulate(scenario)->recording;
  for (std::size_t c = 0; c < first.channels.size(); ++c) {
    EXPECT_EQ(first.channels[c].values, again.channels[c].values) << first.channels[c].name;
    const Index both = std::min(first.samples(), other.samples()) - 4000;
    EXPECT_NE(first.channels[c].values.segment(4000, both), other.channels[c].values.segment(4000, both));
  }
  EXPECT_EQ(first.metadata, again.metadata);
}

TEST(Simulate, AmplitudeAloneDecidesWhetherTheSameArmIsActive) {
  Scenario scenario = ready("rigid_underdamped_2N").front();
  const double at_two = simulate(scenario)->energy_absorbed;
  std::get<perturbation::PulsePlan>(scenario.perturbation.kind).pulses.amplitude = 8.0;
  const double at_eight = simulate(scenario)->energy_absorbed;
  EXPECT_LT(at_two, -0.2);
  EXPECT_GT(at_eight, 0.5);
}

TEST(Simulate, TwoAndEightNewtonFilesDifferInTheAmplitudeAlone) {
  std::string two(find_ready_scenario("rigid_underdamped_2N")->text);
  const std::string eight(find_ready_scenario("rigid_underdamped_8N")->text);
  const auto change = [&](const std::string& from, const std::string& to) {
    const auto at = two.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    two.replace(at, from.size(), to);
  };
  change("pulses of 2 N", "pulses of 8 N");
  change("amplitude_N = 2\n", "amplitude_N = 8\n");
  EXPECT_EQ(two, eight);
}

TEST(Simulate, WithoutTruthNothingElseIsLost) {
  Scenario scenario = ready("relaxed_sinusoidal").front();
  shorten(scenario);
  const Recording whole = simulate(scenario)->recording, blind = without_truth(whole);
  for (const auto& [key, value] : whole.metadata) {
    EXPECT_EQ(blind.metadata.contains(key), !key.starts_with("truth_")) << key;
  }
  EXPECT_EQ(blind.metadata.at("handle_mass_kg"), "0.194");
  ASSERT_EQ(blind.channels.size(), whole.channels.size());
  for (std::size_t c = 0; c < whole.channels.size(); ++c) {
    EXPECT_EQ(blind.channels[c].values, whole.channels[c].values);
  }
}

TEST(Simulate, AnArmOfTwoLinksTellsItsLengthsAndWhereItsShoulderIs) {
  Scenario scenario = ready("relaxed_sinusoidal").front();
  shorten(scenario);
  const auto metadata = simulate(scenario)->recording.metadata;
  EXPECT_EQ(metadata.at("shoulder_x_m"), "0.3");
  EXPECT_EQ(metadata.at("shoulder_y_m"), "-0.57");
  EXPECT_EQ(metadata.at("upper_arm_m"), "0.31");
  EXPECT_EQ(metadata.at("forearm_m"), "0.34");
  EXPECT_EQ(metadata.at("elbow"), "right");
  Scenario rig = ready("rig_table_3_1").front();
  shorten(rig);
  EXPECT_FALSE(simulate(rig)->recording.metadata.contains("upper_arm_m"));
}

TEST(Simulate, ArmsThatAreToldSomethingCarryTheNoteOnTheirGains) {
  for (const auto& [name, noted] : {std::pair{"relaxed_sinusoidal", false}, {"rigid_underdamped_2N", true}}) {
    Scenario scenario = ready(name).front();
    shorten(scenario);
    EXPECT_EQ(simulate(scenario)->recording.metadata.contains("truth_note"), noted) << name;
  }
}

}  // namespace simulate_test
}  // namespace mbk::laboratory
