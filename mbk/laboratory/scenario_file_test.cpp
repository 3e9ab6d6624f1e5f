#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/laboratory/scenario.h"

namespace mbk::laboratory {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A scenario that is as short as can be, with more lines behind it.
std::string with(const std::string& more, const std::string& control = "kind = \"position\"",
                 const std::string& perturbation = "kind = \"multisine\"") {
  return "[control]\n" + control + "\n[perturbation]\n" + perturbation + "\n" + more;
}

std::vector<Scenario> read(const std::string& text) {
  auto scenarios = read_scenarios(text, "folder/mine.toml");
  EXPECT_TRUE(scenarios) << scenarios.error().line();
  return scenarios ? *scenarios : std::vector<Scenario>(1);
}

std::string refusal(const std::string& text) {
  const auto scenarios = read_scenarios(text, "mine.toml");
  EXPECT_FALSE(scenarios) << text;
  if (scenarios) return "";
  EXPECT_EQ(scenarios.error().kind, ErrorKind::data);
  return scenarios.error().line();
}

PlanarTrial planar(const Scenario& scenario) {
  return std::get<PlanarTrial>(scenario.trial);
}

TEST(ScenarioFile, TheShortestOneHasTheApparatusOfTheThesis) {
  const Scenario scenario = read(with("")).front();
  EXPECT_EQ(scenario.file_name, "mine");
  EXPECT_EQ(scenario.trial_name, "");
  const PlanarTrial trial = planar(scenario);
  EXPECT_EQ(trial.robot.robot.inertia.alpha2, 0.04217);
  EXPECT_EQ(trial.robot.robot.friction[1].viscous, 0.07389);
  EXPECT_TRUE(std::holds_alternative<NoLoad>(trial.load));
  const auto& sines = std::get<MultisinePlan>(scenario.perturbation.kind);
  EXPECT_NEAR(sines.peak, 2.0 * kDegree, 1e-15);
  EXPECT_EQ(sines.harmonics.size(), 10u);
}

TEST(ScenarioFile, UnitsOfKeysBecomeSi) {
  const Scenario scenario = read(with("peak_mm = 7\n"
                                      "[recording]\nrate_hz = 500\nseed = 9\n"
                                      "[robot]\nhome_mm = [310, -40]\nhandle_mass_kg = 0.2\ncoulomb_Nm = [0.1, 0.2]\n"
                                      "[robot.capstan]\nstiffness_Nm_per_rad = [300, 500]\n"
                                      "[participant]\nkind = \"arm\"\nshoulder_mm = [300, -560]\nrotation_deg = 10\n"
                                      "[participant.correction]\ndelay_ms = 120\nrandom_error_percent = 15\n"
                                      "[sensors.clock]\njitter_us = 20\n"
                                      "[sensors.force]\nkind = \"strain_gauge\"\narm_mm = 70\n"))
                                .front();
  EXPECT_EQ(scenario.rate.value, 500.0);
  EXPECT_EQ(scenario.seed, 9u);
  const PlanarTrial trial = planar(scenario);
  EXPECT_EQ(trial.home, Vector2d(0.31, -0.04));
  EXPECT_EQ(trial.robot.robot.friction[1].coulomb, 0.2);
  EXPECT_EQ(trial.robot.capstan->stiffness[1], 500.0);
  const auto& arm = std::get<participant::ArmOptions>(trial.load);
  EXPECT_EQ(arm.controller.delay, 0.12);
  EXPECT_EQ(arm.controller.random_error, 0.15);
  EXPECT_EQ(arm.controller.position, trial.home);
  const auto& limb = std::get<participant::TwoLinkArm::Options>(arm.limb);
  EXPECT_EQ(limb.geometry.shoulder, Vector2d(0.3, -0.56));
  EXPECT_NEAR(limb.geometry.rotation, 10.0 * kDegree, 1e-15);
  EXPECT_NEAR(trial.sensors.clock.jitter, 20e-6, 1e-18);
  EXPECT_EQ(std::get<StrainGaugeOptions>(trial.sensors.force).arm, 0.07);
  const auto& sines = std::get<MultisinePlan>(scenario.perturbation.kind);
  EXPECT_EQ(sines.peak, 0.007);
  EXPECT_EQ(sines.space, perturbation::Space::hand);
}

TEST(ScenarioFile, TheSizeOfAPerturbationSaysWhatIsCommanded) {
  const auto quantity = [](const std::string& size) {
    const std::string kind = "kind = \"pulses\"\n" + size;
    return std::get<PulsePlan>(read(with("", "kind = \"force\"", kind)).front().perturbation.kind).quantity;
  };
  EXPECT_EQ(quantity("amplitude_N = 3"), perturbation::Quantity::force);
  EXPECT_EQ(quantity("amplitude_mm = 3"), perturbation::Quantity::position);
  EXPECT_NE(refusal(with("peak_deg = 1\npeak_mm = 2\n")).find("given twice"), std::string::npos);
}

TEST(ScenarioFile, TrialsChangeWhatTheySay) {
  const auto scenarios =
      read(with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[100, 0], [0, 200]]\n"
                "[[trial]]\nname = \"light\"\nrig.mass_kg = 0.5\n"
                "[[trial]]\nname = \"heavy\"\nrig.mass_kg = 2\nrecording.seed = 5\n"));
  ASSERT_EQ(scenarios.size(), 2u);
  EXPECT_EQ(scenarios[0].trial_name, "light");
  EXPECT_EQ(std::get<RigPlan>(planar(scenarios[0]).load).mass, 0.5);
  EXPECT_EQ(std::get<RigPlan>(planar(scenarios[1]).load).mass, 2.0);
  EXPECT_EQ(std::get<RigPlan>(planar(scenarios[1]).load).stiffness(1, 1), 200.0);
  EXPECT_EQ(scenarios[1].seed, 5u);
}

TEST(ScenarioFile, OneAxisMachinesMoveToAndFro) {
  const Scenario scenario =
      read(with("amplitude_deg = 1\n[robot]\nkind = \"one_axis\"\n[participant]\nkind = \"joint\"\n"
                "stiffness_Nm_per_rad = 30\n",
                "kind = \"position\"", "kind = \"random_binary\""))
          .front();
  EXPECT_EQ(std::get<OneAxisTrial>(scenario.trial).joint.stiffness, 30.0);
  EXPECT_EQ(std::get<RandomBinaryPlan>(scenario.perturbation.kind).angle, 0.0);
}

TEST(ScenarioFile, MistakesNameFileLineKeyValueAndWhatIsAllowed) {
  const std::pair<std::string, std::vector<std::string>> mistakes[] = {
      {with("peak_degg = 2\n"), {"mine.toml", "line 5", "'peak_degg'", "'peak_deg'"}},
      {with("[robot]\nhandle_mass_kg = -0.1\n"), {"line 6", "robot.handle_mass_kg", "-0.1", "0"}},
      {with("", "kind = \"positron\""), {"control.kind", "'positron'", "position, force, line"}},
      {with("", ""), {"control", "kind"}},
      {"[control]\nkind = \"force\"\n", {"perturbation", "kind"}},
      {with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[1, 0], [0, 1]]\n[participant]\nkind = \"arm\"\n"),
       {"a participant and a rig cannot both hold the handle"}},
      {with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[1, 0], [0, 1]]\n"
            "[[rig.spring]]\nstiffness_N_per_m = 100\nrest_length_mm = 90\nanchor_mm = [1, 2]\n"),
       {"rig.stiffness_N_per_m", "the springs decide it"}},
      {with("[participant]\nkind = \"arm\"\nnumber = 7\n"), {"participant.number", "7", "6"}},
      {with("harmonics = [1, 2.5]\n"), {"perturbation.harmonics", "2.5", "whole number"}},
      {with("", "kind = \"position\"", "kind = \"pulses\"\namplitude_deg = 1"), {"amplitude_deg", "amplitude_mm"}},
      {with("[trial]\nname = \"a\"\n"), {"trial"}},
      {"[control\n", {"mine.toml", "line 1"}},
  };
  for (const auto& [text, words] : mistakes) {
    const std::string said = refusal(text);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << said << "\nlacks " << word;
  }
}

}  // namespace
}  // namespace mbk::laboratory
