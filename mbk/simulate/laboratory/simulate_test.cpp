#include <gtest/gtest.h>

#include <cmath>

#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/simulate/participant/spatial_arm.h"

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
  if (auto* stretches = std::get_if<perturbation::StretchPlan>(&kind)) {
    stretches->stretches.speeds = {1.0, 3.0};
    stretches->stretches.repetitions = 1;
  }
}

TEST(Simulate, RunsEveryReadyScenario) {
  EXPECT_GE(ready_scenarios().size(), 15u);
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

/// A hand in space with perfect sensors.
std::string in_space(const std::string& participant, double peak_mm) {
  return "[robot]\nkind = \"space\"\nhome_mm = [300, 400, -200]\n[perturbation]\nkind = \"multisine\"\npeak_mm = " +
         std::to_string(peak_mm) + "\naxes = \"interleaved\"\nduration_s = 12\n[participant]\n" + participant +
         "[sensors]\nposition_resolution_mm = 0\nforce_noise_N = 0\nacceleration_noise_m_per_s2 = 0\n";
}

Matrix three(const Recording& recording, const std::string& name) {
  Matrix values(recording.samples(), 3);
  Index found = 0;
  for (const char* axis : {"_x", "_y", "_z"}) {
    for (const Channel& channel : recording.channels) {
      if (channel.name == name + axis) values.col(found++) = channel.values;
    }
  }
  EXPECT_EQ(found, 3) << name;
  return values;
}

/// Largest difference between the recorded force and −(M ẍ + B ẋ + K (x − x₀)), as a share of the largest force.
double departure(const Performance& performance) {
  const Matrix x = three(performance.recording, "hand"), force = three(performance.recording, "force");
  const Matrix acceleration = three(performance.recording, "acceleration");
  const impedance::Model& truth = performance.truth;
  double largest = 0.0;
  for (Index i = 1; i + 1 < x.rows(); ++i) {
    const Vector velocity = (x.row(i + 1) - x.row(i - 1)).transpose() * 500.0;  // at 1 kHz
    const Vector expected =
        -(truth.M * acceleration.row(i).transpose() + truth.B * velocity + truth.K * (x.row(i).transpose() - truth.x0));
    largest = std::max(largest, (force.row(i).transpose() - expected).cwiseAbs().maxCoeff());
  }
  return largest / force.cwiseAbs().maxCoeff();
}

/// Central differences of 3 Hz at 1 kHz: (ωh)²/6 of the velocity.
constexpr double kDifferences = 1e-4;

TEST(SimulateInSpace, AConstantImpedanceGivesExactlyItsForce) {
  const std::string limb =
      "kind = \"linear\"\nequilibrium_mm = [302, 399, -203]\n"
      "mass_kg = [[1.3, -0.9, 0.2], [-0.9, 1.9, 0.1], [0.2, 0.1, 1.1]]\n"
      "damping_Ns_per_m = [[5.8, -2.1, 1], [-2.1, 10.6, 0.5], [1, 0.5, 7]]\n"
      "stiffness_N_per_m = [[42, -21, 10], [-36, 125, 5], [-10, 8, 80]]\n";
  const Scenario scenario = read_scenarios(in_space(limb, 8.0), "mine.toml").value().front();
  const Performance performance = simulate(scenario).value();
  EXPECT_LT(departure(performance), kDifferences);
  EXPECT_EQ(performance.recording.metadata.at("truth_K"), "[[42, -21, 10], [-36, 125, 5], [-10, 8, 80]]");
  EXPECT_EQ(performance.recording.metadata.at("truth_x0"), "[0.302, 0.399, -0.203]");
  EXPECT_GT(performance.energy_exchanged, std::abs(performance.energy_absorbed));
}

TEST(SimulateInSpace, AnArmsForceIsThatOfItsTruthWhereTheMotionIsSmall) {
  const Scenario scenario = read_scenarios(in_space("kind = \"arm\"\n", 0.1), "mine.toml").value().front();
  const Performance performance = simulate(scenario).value();
  const double posture = 0.01;  // 0.1 mm turns the joints by about 0.3 mrad
  EXPECT_LT(departure(performance), posture);
  EXPECT_GT(performance.energy_absorbed, 0.0);
}

TEST(SimulateInSpace, RefusesAMotionThatTheArmCannotFollow) {
  const Scenario scenario = read_scenarios(in_space("kind = \"arm\"\n", 500.0), "mine.toml").value().front();
  const auto performance = simulate(scenario);
  ASSERT_FALSE(performance);
  EXPECT_EQ(performance.error().kind, ErrorKind::data);
}

TEST(SimulateInSpace, RefusesAnInertiaThatIsNotSymmetric) {
  const std::string limb =
      "kind = \"linear\"\nmass_kg = [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]\n"
      "damping_Ns_per_m = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nstiffness_N_per_m = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n";
  EXPECT_FALSE(simulate(read_scenarios(in_space(limb, 8.0), "mine.toml").value().front()));
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
