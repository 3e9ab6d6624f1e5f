#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {
namespace scenario_file_test {

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
  EXPECT_EQ(scenario.protocol, "mine");
  EXPECT_EQ(scenario.name, "");
  const PlanarTrial trial = planar(scenario);
  EXPECT_EQ(trial.robot.robot.inertia.alpha2, 0.04217);
  EXPECT_EQ(trial.robot.robot.friction[1].viscous, 0.07389);
  EXPECT_TRUE(std::holds_alternative<NoLoad>(trial.load));
  const auto& sines = std::get<perturbation::MultisinePlan>(scenario.perturbation.kind);
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
  const auto& sines = std::get<perturbation::MultisinePlan>(scenario.perturbation.kind);
  EXPECT_EQ(sines.peak, 0.007);
  EXPECT_EQ(sines.space, perturbation::Space::hand);
}

TEST(ScenarioFile, TheSizeOfAPerturbationSaysWhatIsCommanded) {
  const auto quantity = [](const std::string& size) {
    const std::string kind = "kind = \"pulses\"\n" + size;
    return std::get<perturbation::PulsePlan>(read(with("", "kind = \"force\"", kind)).front().perturbation.kind)
        .quantity;
  };
  EXPECT_EQ(quantity("amplitude_N = 3"), perturbation::Quantity::force);
  EXPECT_EQ(quantity("amplitude_mm = 3"), perturbation::Quantity::position);
  EXPECT_NE(refusal(with("peak_deg = 1\npeak_mm = 2\n")).find("peak_mm"), std::string::npos);
}

TEST(ScenarioFile, TrialsChangeWhatTheySay) {
  const auto scenarios =
      read(with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[100, 0], [0, 200]]\n"
                "[[trial]]\nname = \"light\"\nrig.mass_kg = 0.5\n"
                "[[trial]]\nname = \"heavy\"\nrig.mass_kg = 2\nrecording.seed = 5\n"));
  ASSERT_EQ(scenarios.size(), 2u);
  EXPECT_EQ(scenarios[0].name, "light");
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
  EXPECT_EQ(std::get<participant::OneAxisJoint::Options>(std::get<OneAxisTrial>(scenario.trial).load).stiffness, 30.0);
  EXPECT_EQ(std::get<perturbation::RandomBinaryPlan>(scenario.perturbation.kind).angle, 0.0);
}

/// Keys convert by one multiplication or division.
constexpr double kRounding = 1e-15;

Matrix2d matrix(double a, double b, double c, double d) {
  return (Matrix2d() << a, b, c, d).finished();
}

TEST(ScenarioFile, EveryKeyOfThePlanarRobotBecomesItsOption) {
  const Scenario scenario =
      read(
          "[recording]\nrate_hz = 2000\nseed = 12\ncondition = \"words\"\n"
          "[robot]\nkind = \"planar\"\nd1_mm = 260\nd2_mm = 330\nalpha_kg_m2 = [0.07, 0.043, 0.045]\n"
          "home_mm = [290, -45]\nhandle_mass_kg = 0.21\nsteps_per_tick = 3\nviscous_Nms_per_rad = [0.01, 0.02]\n"
          "coulomb_Nm = [0.03, 0.04]\nbreakaway_Nm = [0.05, 0.06]\nstribeck_velocity_rad_per_s = [0.07, 0.08]\n"
          "smoothing_rad_per_s = [0.09, 0.11]\n"
          "[robot.capstan]\nstiffness_Nm_per_rad = [310, 320]\ndamping_Nms_per_rad = [0.12, 0.13]\n"
          "motor_inertia_kg_m2 = [0.014, 0.016]\n"
          "[control]\nkind = \"position\"\nproportional_Nm_per_rad = [70, 80]\nderivative_Nms_per_rad = [1.7, 1.8]\n"
          "velocity_cutoff_hz = 90\n[perturbation]\nkind = \"none\"\nduration_s = 4\n")
          .front();
  EXPECT_EQ(scenario.rate.value, 2000.0);
  EXPECT_EQ(scenario.seed, 12u);
  EXPECT_EQ(scenario.condition, "words");
  EXPECT_EQ(std::get<perturbation::RestPlan>(scenario.perturbation.kind).duration, 4.0);
  const PlanarTrial trial = planar(scenario);
  EXPECT_NEAR((trial.home - Vector2d(0.29, -0.045)).norm(), 0.0, kRounding);
  EXPECT_EQ(trial.robot.handle_mass, 0.21);
  EXPECT_EQ(trial.robot.steps_per_tick, 3);
  const robot::PlanarRobot& robot = trial.robot.robot;
  EXPECT_NEAR(robot.geometry.d1, 0.26, kRounding);
  EXPECT_NEAR(robot.geometry.d2, 0.33, kRounding);
  EXPECT_EQ(Eigen::Vector3d(robot.inertia.alpha1, robot.inertia.alpha2, robot.inertia.alpha3),
            Eigen::Vector3d(0.07, 0.043, 0.045));
  const auto both = [&](double robot::JointFriction::*part) {
    return Vector2d(robot.friction[0].*part, robot.friction[1].*part);
  };
  EXPECT_EQ(both(&robot::JointFriction::viscous), Vector2d(0.01, 0.02));
  EXPECT_EQ(both(&robot::JointFriction::coulomb), Vector2d(0.03, 0.04));
  EXPECT_EQ(both(&robot::JointFriction::breakaway), Vector2d(0.05, 0.06));
  EXPECT_EQ(both(&robot::JointFriction::stribeck_velocity), Vector2d(0.07, 0.08));
  EXPECT_EQ(both(&robot::JointFriction::smoothing), Vector2d(0.09, 0.11));
  EXPECT_EQ(trial.robot.capstan->stiffness, Vector2d(310.0, 320.0));
  EXPECT_EQ(trial.robot.capstan->damping, Vector2d(0.12, 0.13));
  EXPECT_EQ(trial.robot.capstan->motor_inertia, Vector2d(0.014, 0.016));
  const auto& gains = std::get<PositionMode>(trial.control).gains;
  EXPECT_EQ(gains.proportional, Vector2d(70.0, 80.0));
  EXPECT_EQ(gains.derivative, Vector2d(1.7, 1.8));
  EXPECT_EQ(gains.velocity_cutoff.value, 90.0);
}

TEST(ScenarioFile, EveryKeyOfALineBecomesItsOption) {
  const Scenario scenario =
      read(with("",
                "kind = \"line\"\nangle_deg = 30\nstiffness_N_per_m = 5000\ndamping_Ns_per_m = 70\n"
                "velocity_cutoff_hz = 80",
                "kind = \"random_binary\"\namplitude_N = 3\nswitching_time_s = 0.4\nzero_mean = true\n"
                "damping_ratio = 0.2\nnatural_frequency_rad_per_s = 20\nangle_deg = 45\nduration_s = 33\n"
                "limits.peak_N = 5\nlimits.speed_N_per_s = 90\nlimits.bandwidth_hz = 6"))
          .front();
  const auto& line = std::get<LineMode>(planar(scenario).control).line;
  EXPECT_NEAR(line.angle, 30.0 * kDegree, kRounding);
  EXPECT_EQ(line.stiffness, 5000.0);
  EXPECT_EQ(line.damping, 70.0);
  EXPECT_EQ(line.velocity_cutoff.value, 80.0);
  const auto& plan = std::get<perturbation::RandomBinaryPlan>(scenario.perturbation.kind);
  EXPECT_EQ(plan.sequence.amplitude, 3.0);
  EXPECT_EQ(plan.sequence.switching_time, 0.4);
  EXPECT_TRUE(plan.sequence.zero_mean);
  EXPECT_EQ(plan.sequence.damping_ratio, 0.2);
  EXPECT_EQ(plan.sequence.natural_frequency.value, 20.0);
  EXPECT_NEAR(plan.angle, 45.0 * kDegree, kRounding);
  EXPECT_EQ(plan.duration, 33.0);
  EXPECT_EQ(scenario.perturbation.limits.peak, 5.0);
  EXPECT_EQ(scenario.perturbation.limits.speed, 90.0);
  EXPECT_EQ(scenario.perturbation.limits.bandwidth->value, 6.0);
}

TEST(ScenarioFile, EveryKeyOfSinesAndPulsesBecomesItsOption) {
  const Scenario sines =
      read(with("peak_N = 4\nperiod_s = 5\nharmonics = [1, 3, 5, 7, 9]\nphases = \"low_crest\"\n"
                "axes = \"interleaved\"\npower = \"d_optimal\"\npower_limited_by = \"force\"\n"
                "power_floor_percent = 3\nduration_s = 40\nmoving_in_s = 2\n"
                "[perturbation.nominal]\nmass_kg = 1.5\ndamping_Ns_per_m = 8\nstiffness_N_per_m = 90\n",
                "kind = \"force\""))
          .front();
  const auto& plan = std::get<perturbation::MultisinePlan>(sines.perturbation.kind);
  EXPECT_EQ(plan.quantity, perturbation::Quantity::force);
  EXPECT_EQ(plan.space, perturbation::Space::hand);
  EXPECT_EQ(plan.peak, 4.0);
  EXPECT_EQ(plan.period, 5.0);
  EXPECT_EQ(plan.harmonics, (std::vector<int>{1, 3, 5, 7, 9}));
  EXPECT_EQ(plan.phases, perturbation::MultisinePlan::Phases::low_crest);
  EXPECT_EQ(plan.axes, perturbation::MultisinePlan::Axes::interleaved);
  ASSERT_TRUE(plan.optimal_power);
  EXPECT_EQ(plan.optimal_power->limited, perturbation::LimitedSignal::force);
  EXPECT_NEAR(plan.optimal_power->floor, 0.03, kRounding);
  ASSERT_TRUE(plan.optimal_power->nominal);
  EXPECT_EQ(plan.optimal_power->nominal->M, 1.5);
  EXPECT_EQ(plan.optimal_power->nominal->B, 8.0);
  EXPECT_EQ(plan.optimal_power->nominal->K, 90.0);
  EXPECT_EQ(plan.duration, 40.0);
  EXPECT_EQ(plan.moving_in, 2.0);

  const Scenario scenario =
      read(with("amplitude_mm = 6\ndamping_ratio = 0.3\nnatural_frequency_rad_per_s = 12\ndirections = 6\n"
                "repetitions = 3\nshortest_duration_s = 1.1\nlongest_duration_s = 1.2\nshortest_pause_s = 1.3\n"
                "longest_pause_s = 1.4\nreturn_s = 0.9\nquiet_s = 4\ntail_s = 2\n"
                "limits.peak_mm = 9\nlimits.speed_mm_per_s = 300\n",
                "kind = \"position\"", "kind = \"pulses\""))
          .front();
  const auto& pulses = std::get<perturbation::PulsePlan>(scenario.perturbation.kind);
  EXPECT_EQ(pulses.quantity, perturbation::Quantity::position);
  EXPECT_EQ(pulses.tail, 2.0);
  const perturbation::PulseSchedule::Options& p = pulses.pulses;
  EXPECT_NEAR(p.amplitude, 0.006, kRounding);
  EXPECT_EQ(p.damping_ratio, 0.3);
  EXPECT_EQ(p.natural_frequency.value, 12.0);
  EXPECT_EQ(p.directions, 6);
  EXPECT_EQ(p.repetitions, 3);
  EXPECT_EQ(p.shortest_duration, 1.1);
  EXPECT_EQ(p.longest_duration, 1.2);
  EXPECT_EQ(p.shortest_pause, 1.3);
  EXPECT_EQ(p.longest_pause, 1.4);
  EXPECT_EQ(p.return_duration, 0.9);
  EXPECT_EQ(p.quiet, 4.0);
  EXPECT_NEAR(*scenario.perturbation.limits.peak, 0.009, kRounding);
  EXPECT_NEAR(*scenario.perturbation.limits.speed, 0.3, kRounding);
}

TEST(ScenarioFile, EveryKeyOfAnArmBecomesItsOption) {
  const Scenario scenario =
      read(with("[participant]\nkind = \"arm\"\nupper_arm_mm = 300\nforearm_mm = 330\nshoulder_mm = [305, -560]\n"
                "rotation_deg = 5\nequilibrium_mm = [301, -51]\ninertia_kg_m2 = [[0.4, 0.1], [0.1, 0.08]]\n"
                "inertia_elbow_deg = 70\ndamping_Nms_per_rad = [[1.5, 0.4], [0.4, 0.6]]\n"
                "stiffness_Nm_per_rad = [[12, 3], [3, 5]]\n"
                "[participant.correction]\ntarget_mm = [302, -52]\nposition_gain = 1.1\nthreshold_mm = 2\n"
                "target_N = [1, -2]\nforce_gain = 0.6\nthreshold_N = 0.3\ninterval_ms = 300\ndelay_ms = 140\n"
                "random_error_percent = 25\nlargest_increment_N = 3\nramp_ms = 210\nleak_s = 7\n"
                "[participant.cocontraction]\nrest = 0.2\nslope = 0.7\nspeed_mm_per_s = 40\ntime_constant_s = 2\n"
                "stiffness_gain = 5\ndamping_gain = 4\nvoluntary_damping = 0.5\n"
                "[participant.remnant]\nfloor_N = 0.1\nper_force = 0.05\ncutoff_hz = 2\n"))
          .front();
  const auto arm = std::get<participant::ArmOptions>(planar(scenario).load);
  const auto& limb = std::get<participant::TwoLinkArm::Options>(arm.limb);
  EXPECT_NEAR(limb.geometry.upper_arm, 0.3, kRounding);
  EXPECT_NEAR(limb.geometry.forearm, 0.33, kRounding);
  EXPECT_NEAR((limb.geometry.shoulder - Vector2d(0.305, -0.56)).norm(), 0.0, kRounding);
  EXPECT_NEAR(limb.geometry.rotation, 5.0 * kDegree, kRounding);
  EXPECT_NEAR((limb.equilibrium - Vector2d(0.301, -0.051)).norm(), 0.0, kRounding);
  EXPECT_EQ(limb.joints.inertia, matrix(0.4, 0.1, 0.1, 0.08));
  EXPECT_NEAR(limb.joints.elbow_angle, 70.0 * kDegree, kRounding);
  EXPECT_EQ(limb.joints.damping, matrix(1.5, 0.4, 0.4, 0.6));
  EXPECT_EQ(limb.joints.stiffness, matrix(12.0, 3.0, 3.0, 5.0));
  const participant::IntermittentController::Options& voluntary = arm.controller;
  EXPECT_NEAR((voluntary.position - Vector2d(0.302, -0.052)).norm(), 0.0, kRounding);
  EXPECT_EQ(voluntary.position_gain, 1.1);
  EXPECT_NEAR(voluntary.position_threshold, 0.002, kRounding);
  EXPECT_EQ(voluntary.force, Vector2d(1.0, -2.0));
  EXPECT_EQ(voluntary.force_gain, 0.6);
  EXPECT_EQ(voluntary.force_threshold, 0.3);
  EXPECT_NEAR(voluntary.interval, 0.3, kRounding);
  EXPECT_NEAR(voluntary.delay, 0.14, kRounding);
  EXPECT_EQ(voluntary.random_error, 0.25);
  EXPECT_EQ(voluntary.largest_increment, 3.0);
  EXPECT_NEAR(voluntary.ramp, 0.21, kRounding);
  EXPECT_EQ(voluntary.leak, 7.0);
  EXPECT_EQ(arm.cocontraction.rest, 0.2);
  EXPECT_EQ(arm.cocontraction.slope, 0.7);
  EXPECT_NEAR(arm.cocontraction.speed, 0.04, kRounding);
  EXPECT_EQ(arm.cocontraction.time_constant, 2.0);
  EXPECT_EQ(arm.cocontraction.stiffness_gain, 5.0);
  EXPECT_EQ(arm.cocontraction.damping_gain, 4.0);
  EXPECT_EQ(arm.cocontraction.voluntary_damping, 0.5);
  EXPECT_EQ(arm.remnant.floor, 0.1);
  EXPECT_EQ(arm.remnant.per_force, 0.05);
  EXPECT_EQ(arm.remnant.cutoff.value, 2.0);
}

TEST(ScenarioFile, NumberOfAParticipantGivesItsJointsAndKeysBesideItReplaceThem) {
  const Scenario scenario = read(with("[participant]\nkind = \"arm\"\nnumber = 3\n"
                                      "stiffness_Nm_per_rad = [[12, 3], [3, 5]]\n"))
                                .front();
  const auto arm = std::get<participant::ArmOptions>(planar(scenario).load);
  const auto& joints = std::get<participant::TwoLinkArm::Options>(arm.limb).joints;
  EXPECT_EQ(joints.inertia, participant::participant_limb(3)->joints.inertia);
  EXPECT_EQ(joints.stiffness, matrix(12.0, 3.0, 3.0, 5.0));
}

TEST(ScenarioFile, EveryKeyOfOtherLoadsBecomesItsOption) {
  const auto load = [](const std::string& text) { return planar(read(with(text)).front()).load; };
  const auto linear = std::get<participant::ArmOptions>(
      load("[participant]\nkind = \"linear\"\nmass_kg = [[1, 2], [2, 5]]\ndamping_Ns_per_m = [[5, 6], [7, 8]]\n"
           "stiffness_N_per_m = [[9, 10], [11, 12]]\nequilibrium_mm = [299, -49]\n"));
  const auto& model = std::get<impedance::Model>(linear.limb);
  EXPECT_EQ(model.M, Matrix(matrix(1, 2, 2, 5)));
  EXPECT_EQ(model.B, Matrix(matrix(5, 6, 7, 8)));
  EXPECT_EQ(model.K, Matrix(matrix(9, 10, 11, 12)));
  EXPECT_NEAR((model.x0 - Vector(Vector2d(0.299, -0.049))).norm(), 0.0, kRounding);

  const auto tone = std::get<participant::ToneRobot::Options>(
      load("[participant]\nkind = \"tone\"\nmass_kg = 0.4\nstiffness_N_per_m = [[1, 2], [3, 4]]\n"
           "damping_Ns_per_m = [[5, 6], [7, 8]]\nrest_mm = [298, -48]\nrigidity_N = 1.5\n"
           "rigidity_speed_mm_per_s = 6\ncatch_gain_Ns_per_m = 15\ncatch_speed_mm_per_s = 60\n"
           "stretch_angle_deg = 90\nrelease_force_N = 8\nmotor_lag_ms = 3\nlargest_force_N = 25\n"));
  EXPECT_EQ(tone.inertia, 0.4);
  EXPECT_EQ(tone.stiffness, matrix(1, 2, 3, 4));
  EXPECT_EQ(tone.damping, matrix(5, 6, 7, 8));
  EXPECT_NEAR((tone.rest - Vector2d(0.298, -0.048)).norm(), 0.0, kRounding);
  EXPECT_EQ(tone.rigidity, 1.5);
  EXPECT_NEAR(tone.rigidity_speed, 0.006, kRounding);
  EXPECT_EQ(tone.catch_gain, 15.0);
  EXPECT_NEAR(tone.catch_speed, 0.06, kRounding);
  EXPECT_NEAR(tone.stretch_angle, 90.0 * kDegree, kRounding);
  EXPECT_EQ(tone.release_force, 8.0);
  EXPECT_NEAR(tone.motor_lag, 0.003, kRounding);
  EXPECT_EQ(tone.largest_force, 25.0);

  const auto rig =
      std::get<RigPlan>(load("[rig]\nmass_kg = 2\ndamping_matrix_Ns_per_m = [[1, 2], [3, 4]]\n"
                             "stiffness_N_per_m = [[5, 6], [7, 8]]\nequilibrium_mm = [297, -47]\n"));
  EXPECT_EQ(rig.mass, 2.0);
  EXPECT_EQ(rig.damping, matrix(1, 2, 3, 4));
  EXPECT_EQ(rig.stiffness, matrix(5, 6, 7, 8));
  EXPECT_NEAR((rig.equilibrium - Vector2d(0.297, -0.047)).norm(), 0.0, kRounding);

  const auto springs = std::get<RigPlan>(
      load("[rig]\ndamping_Ns_per_m = 3\n[[rig.spring]]\nstiffness_N_per_m = 100\nrest_length_mm = 90\n"
           "anchor_mm = [200, 10]\nhole_mm = [5, -6]\n"));
  EXPECT_EQ(springs.damping, matrix(3, 0, 0, 3));
  ASSERT_EQ(springs.springs.size(), 1u);
  EXPECT_EQ(springs.springs[0].stiffness, 100.0);
  EXPECT_NEAR(springs.springs[0].rest_length, 0.09, kRounding);
  EXPECT_NEAR((springs.springs[0].anchor - Vector2d(0.2, 0.01)).norm(), 0.0, kRounding);
  EXPECT_NEAR((springs.springs[0].hole - Vector2d(0.005, -0.006)).norm(), 0.0, kRounding);
}

TEST(ScenarioFile, EveryKeyOfTheSensorsBecomesItsOption) {
  const auto sensors = [](const std::string& text) { return planar(read(with(text)).front()).sensors; };
  const SensorOptions<2> first = sensors(
      "[sensors]\nencoder_resolution_rad = 1e-5\n"
      "[sensors.force]\nkind = \"load_cell\"\nwhite_noise_N = 0.03\ncoloured_noise_N = 0.04\n"
      "coloured_bandwidth_hz = 2\ngain = [[1.01, 0.02], [0.03, 0.99]]\noffset_N = [0.1, 0.2]\n"
      "drift_walk_N_per_sqrt_s = 0.005\ndrift_rate_N_per_s = [0.006, 0.007]\n"
      "[sensors.acceleration]\nkind = \"accelerometer\"\nnoise_m_per_s2 = 0.05\nbias_m_per_s2 = [0.1, 0.2]\n"
      "gain_error_percent = [1, 2]\nmisalignment_deg = 3\nbandwidth_hz = 100\n"
      "[sensors.motor_current]\ntorque_constant_Nm_per_A = [0.2, 0.3]\n"
      "torque_constant_error_percent = [4, 5]\nnoise_A = 0.06\n"
      "[sensors.clock]\njitter_us = 30\ntimestamps = \"nominal\"\n");
  EXPECT_EQ(first.encoder_resolution, 1e-5);
  const auto& cell = std::get<LoadCellOptions<2>>(first.force);
  EXPECT_EQ(cell.white_noise, 0.03);
  EXPECT_EQ(cell.coloured_noise, 0.04);
  EXPECT_EQ(cell.coloured_bandwidth.value, 2.0);
  EXPECT_EQ(cell.gain, matrix(1.01, 0.02, 0.03, 0.99));
  EXPECT_EQ(cell.offset, Vector2d(0.1, 0.2));
  EXPECT_EQ(cell.drift_walk, 0.005);
  EXPECT_EQ(cell.drift_rate, Vector2d(0.006, 0.007));
  const auto& meter = std::get<AccelerometerOptions<2>>(first.acceleration);
  EXPECT_EQ(meter.noise, 0.05);
  EXPECT_EQ(meter.bias, Vector2d(0.1, 0.2));
  EXPECT_EQ(meter.gain_error, Vector2d(0.01, 0.02));
  EXPECT_NEAR(meter.misalignment, 3.0 * kDegree, kRounding);
  EXPECT_EQ(meter.bandwidth.value, 100.0);
  const auto& current = std::get<MotorCurrentOptions<2>>(first.torque);
  EXPECT_EQ(current.torque_constant, Vector2d(0.2, 0.3));
  EXPECT_EQ(current.torque_constant_error, Vector2d(0.04, 0.05));
  EXPECT_EQ(current.noise, 0.06);
  EXPECT_NEAR(first.clock.jitter, 30e-6, kRounding);
  EXPECT_EQ(first.clock.timestamps, ClockOptions::Timestamps::nominal);

  const SensorOptions<2> second = sensors(
      "[sensors.force]\nkind = \"strain_gauge\"\nslope_N_per_V = [-8, -9]\noffset_N = [0.5, 2]\n"
      "calibration_arm_mm = 60\narm_mm = 61\ncrosstalk_percent = [1, 2]\n"
      "bridge_noise_V_per_sqrt_hz = 1e-4\ncutoff_hz = 50\nfilter_order = 2\nconverter_bits = 16\n"
      "converter_range_V = 5\nassumed_arm_mm = 62\nassumed_offset_N = [0.4, 3]\n"
      "[sensors.acceleration]\nkind = \"perfect\"\n");
  const auto& gauge = std::get<StrainGaugeOptions>(second.force);
  EXPECT_EQ(gauge.slope, Vector2d(-8.0, -9.0));
  EXPECT_EQ(gauge.offset, Vector2d(0.5, 2.0));
  EXPECT_NEAR(gauge.calibration_arm, 0.06, kRounding);
  EXPECT_NEAR(gauge.arm, 0.061, kRounding);
  EXPECT_EQ(gauge.crosstalk, Vector2d(0.01, 0.02));
  EXPECT_EQ(gauge.bridge_noise, 1e-4);
  EXPECT_EQ(gauge.cutoff.value, 50.0);
  EXPECT_EQ(gauge.filter_order, 2);
  EXPECT_EQ(gauge.converter_bits, 16);
  EXPECT_EQ(gauge.converter_range, 5.0);
  EXPECT_NEAR(gauge.assumed_arm, 0.062, kRounding);
  EXPECT_EQ(gauge.assumed_offset, Vector2d(0.4, 3.0));
  EXPECT_TRUE(std::holds_alternative<PerfectSensor>(second.acceleration));
  EXPECT_TRUE(std::holds_alternative<CommandedTorque>(second.torque));
  EXPECT_TRUE(std::holds_alternative<PerfectSensor>(sensors("[sensors.force]\nkind = \"perfect\"\n").force));
}

TEST(ScenarioFile, EveryKeyOfAOneAxisMachineBecomesItsOption) {
  const Scenario scenario =
      read(with("amplitude_deg = 2\n[robot]\nkind = \"one_axis\"\ninertia_kg_m2 = 0.03\nviscous_Nms_per_rad = 0.2\n"
                "coulomb_Nm = 0.1\nsmoothing_rad_per_s = 0.03\nsteps_per_tick = 2\n"
                "[participant]\nkind = \"joint\"\ninertia_kg_m2 = 0.016\nviscosity_Nms_per_rad = 0.9\n"
                "stiffness_Nm_per_rad = 46\nrest_deg = 1\n"
                "[participant.reflex]\ngain_Nms_per_rad = 4\ndelay_ms = 45\nnatural_frequency_hz = 6\n"
                "damping_ratio = 0.8\nstretched_by_positive_velocity = false\n"
                "[participant.remnant]\nfloor_Nm = 0.06\ncutoff_hz = 2\n"
                "[sensors]\nposition_resolution_rad = 1e-6\nreaction_noise_Nm = 0.01\ncoloured_noise_Nm = 0.02\n"
                "coloured_bandwidth_hz = 3\ndrift_walk_Nm_per_sqrt_s = 0.04\ndrift_rate_Nm_per_s = 0.05\n"
                "acceleration_noise_rad_per_s2 = 0.06\n",
                "kind = \"position\"\nproportional_Nm_per_rad = 700\nderivative_Nms_per_rad = 11\n"
                "velocity_cutoff_hz = 150",
                "kind = \"random_binary\""))
          .front();
  const auto trial = std::get<OneAxisTrial>(scenario.trial);
  EXPECT_EQ(trial.robot.robot.inertia.mass, 0.03);
  EXPECT_EQ(trial.robot.robot.friction[0].viscous, 0.2);
  EXPECT_EQ(trial.robot.robot.friction[0].coulomb, 0.1);
  EXPECT_EQ(trial.robot.robot.friction[0].smoothing, 0.03);
  EXPECT_EQ(trial.robot.steps_per_tick, 2);
  const auto& servo = std::get<ServoMode>(trial.control);
  EXPECT_EQ(servo.proportional, 700.0);
  EXPECT_EQ(servo.derivative, 11.0);
  EXPECT_EQ(servo.velocity_cutoff.value, 150.0);
  const auto& joint = std::get<participant::OneAxisJoint::Options>(trial.load);
  EXPECT_EQ(joint.inertia, 0.016);
  EXPECT_EQ(joint.viscosity, 0.9);
  EXPECT_EQ(joint.stiffness, 46.0);
  EXPECT_NEAR(joint.rest, kDegree, kRounding);
  EXPECT_EQ(joint.reflex.gain, 4.0);
  EXPECT_NEAR(joint.reflex.delay, 0.045, kRounding);
  EXPECT_NEAR(Hertz(joint.reflex.natural_frequency).value, 6.0, 8 * kRounding);
  EXPECT_EQ(joint.reflex.damping_ratio, 0.8);
  EXPECT_FALSE(joint.reflex.stretched_by_positive_velocity);
  EXPECT_EQ(joint.remnant.floor, 0.06);
  EXPECT_EQ(joint.remnant.cutoff.value, 2.0);
  EXPECT_EQ(trial.sensors.encoder_resolution, 1e-6);
  const auto& cell = std::get<LoadCellOptions<1>>(trial.sensors.force);
  EXPECT_EQ(cell.white_noise, 0.01);
  EXPECT_EQ(cell.coloured_noise, 0.02);
  EXPECT_EQ(cell.coloured_bandwidth.value, 3.0);
  EXPECT_EQ(cell.drift_walk, 0.04);
  EXPECT_EQ(cell.drift_rate[0], 0.05);
  EXPECT_EQ(std::get<AccelerometerOptions<1>>(trial.sensors.acceleration).noise, 0.06);
}

TEST(ScenarioFile, EveryReadyScenarioReadsAndSaysItsCondition) {
  for (const ReadyScenario& one : ready_scenarios()) {
    const auto scenarios = read(std::string(one.text));
    EXPECT_FALSE(scenarios.front().condition.empty()) << one.name;
    for (const Scenario& scenario : scenarios) EXPECT_EQ(scenario.name.empty(), scenarios.size() == 1) << one.name;
  }
}

/// A hand in space with a perturbation.
std::string in_space(const std::string& perturbation, const std::string& more = "[participant]\nkind = \"arm\"\n") {
  return "[robot]\nkind = \"space\"\n[perturbation]\n" + perturbation + "\n" + more;
}

TEST(ScenarioFile, EveryKeyOfAHandInSpaceBecomesItsOption) {
  const Scenario scenario =
      read(in_space("kind = \"multisine\"\npeak_mm = 7\n",
                    "[participant]\nkind = \"arm\"\nbody_mass_kg = 80\nupper_arm_mm = 290\nforearm_mm = 350\n"
                    "posture_deg = [180, 60, 90]\naxial_rotation_deg = 90\nequilibrium_mm = [310, -40, 20]\n"
                    "damping_Nms_per_rad = [[1, 2, 3], [4, 5, 6], [7, 8, 9]]\n"
                    "stiffness_Nm_per_rad = [[9, 8, 7], [6, 5, 4], [3, 2, 1]]\n"
                    "[sensors]\nposition_resolution_mm = 0.01\nforce_noise_N = 0.3\ncoloured_noise_N = 0.1\n"
                    "coloured_bandwidth_hz = 2\nacceleration_noise_m_per_s2 = 0.4\n"))
          .front();
  EXPECT_EQ(scenario.perturbation.axes, 3);
  const auto& trial = std::get<SpaceTrial>(scenario.trial);
  EXPECT_NEAR((trial.home - Eigen::Vector3d(0.3, -0.05, 0.0)).norm(), 0.0, kRounding);
  const auto& arm = std::get<participant::SpatialArm::Options>(trial.limb);
  EXPECT_EQ(arm.body_mass, 80.0);
  EXPECT_NEAR(arm.upper_arm, 0.29, kRounding);
  EXPECT_NEAR(arm.forearm, 0.35, kRounding);
  EXPECT_NEAR((arm.posture - kDegree * Eigen::Vector3d(180, 60, 90)).norm(), 0.0, 8 * kRounding);
  EXPECT_NEAR(arm.axial_rotation, 90 * kDegree, kRounding);
  EXPECT_EQ(arm.damping(1, 2), 6.0);
  EXPECT_EQ(arm.stiffness(2, 0), 3.0);
  EXPECT_NEAR((arm.equilibrium.value() - Eigen::Vector3d(0.31, -0.04, 0.02)).norm(), 0.0, kRounding);
  EXPECT_NEAR(trial.sensors.position_quantum, 1e-5, kRounding);
  EXPECT_EQ(trial.sensors.force_noise, 0.3);
  EXPECT_EQ(trial.sensors.coloured_force_noise, 0.1);
  EXPECT_EQ(trial.sensors.coloured_force_bandwidth.value, 2.0);
  EXPECT_EQ(trial.sensors.acceleration_noise, 0.4);
}

TEST(ScenarioFile, AHandInSpaceHasMillimetresAndNoPlanarPerturbation) {
  for (const char* key : {"peak_deg", "peak_N"}) {
    const std::string said = refusal(in_space("kind = \"multisine\"\n" + std::string(key) + " = 2"));
    EXPECT_NE(said.find(key), std::string::npos) << said;
    EXPECT_NE(said.find("peak_mm"), std::string::npos) << said;
  }
  for (const char* kind : {"random_binary", "ramp_and_hold", "servo_displacement", "none"}) {
    EXPECT_NE(refusal(in_space("kind = \"" + std::string(kind) + "\"")).find("multisine"), std::string::npos) << kind;
  }
  EXPECT_NE(refusal(in_space("kind = \"multisine\"\npeak_mm = 5", "")).find("kind"), std::string::npos);
}

/// A one-axis machine with a perturbation.
std::string one_axis(const std::string& perturbation, const std::string& control = "kind = \"position\"") {
  return with("[robot]\nkind = \"one_axis\"\n[participant]\nkind = \"joint\"\n", control, perturbation);
}

TEST(ScenarioFile, EachMachineHasItsUnits) {
  for (const char* const key : {"peak_Nm", "peak_deg", "peak_mm"})
    EXPECT_NE(refusal(with("peak_Nm = 2\n", "kind = \"force\"")).find(key), std::string::npos) << key;
  for (const char* key : {"amplitude_mm", "amplitude_N"}) {
    const std::string said = refusal(one_axis("kind = \"pulses\"\n" + std::string(key) + " = 2"));
    EXPECT_NE(said.find(key), std::string::npos) << said;
    EXPECT_NE(said.find("amplitude_deg"), std::string::npos) << said;
    EXPECT_NE(said.find("amplitude_Nm"), std::string::npos) << said;
  }
  // Millimetres and newtons are what the fallbacks of pulses and sequences are in
  for (const char* kind : {"kind = \"pulses\"", "kind = \"random_binary\""}) {
    EXPECT_NE(refusal(one_axis(kind)).find("amplitude_deg"), std::string::npos);
  }
  EXPECT_NE(refusal(with("limits.peak_mm = 5\n")).find("peak_deg"), std::string::npos);
  EXPECT_NE(refusal(with("limits.speed_N_per_s = 5\n")).find("speed_deg_per_s"), std::string::npos);
  const auto torque = read(one_axis("kind = \"multisine\"\npeak_Nm = 3\nlimits.peak_Nm = 4", "kind = \"force\""));
  const auto schedule = perturbation::make_schedule(torque.front().perturbation, 1);
  EXPECT_EQ(perturbation::unit(schedule->quantity(), schedule->space()), "N·m");
  const auto angle =
      perturbation::make_schedule(read(one_axis("kind = \"pulses\"\namplitude_deg = 1")).front().perturbation, 1);
  EXPECT_EQ(perturbation::unit(angle->quantity(), angle->space()), "rad");
  EXPECT_EQ(torque.front().perturbation.limits.peak, 4.0);
}

TEST(ScenarioFile, OneAxisPulsesAreAsManyToAndFroAsThereWouldBeAllAround) {
  for (const auto& [directions, repetitions, pulses] :
       std::vector<std::array<int, 3>>{{8, 2, 16}, {2, 5, 10}, {1, 4, 4}, {1, 1, 2}}) {
    const auto scenarios = read(one_axis(fmt::format(
        "kind = \"pulses\"\namplitude_deg = 1\ndirections = {}\nrepetitions = {}", directions, repetitions)));
    const auto& p = std::get<perturbation::PulsePlan>(scenarios.front().perturbation.kind).pulses;
    EXPECT_EQ(p.directions, 2);
    EXPECT_EQ(p.directions * p.repetitions, pulses) << directions << " directions";
  }
}

TEST(ScenarioFile, ReadsRampsAndHolds) {
  const std::string kind =
      "kind = \"ramp_and_hold\"\namplitude_mm = 8\nramp_s = 0.1\nhold_s = 0.4\nreturn_s = 0.2\ndirections = 4\n"
      "repetitions = 3\nshortest_pause_s = 0.5\nlongest_pause_s = 0.6\nquiet_s = 1\ntail_s = 0.5\n";
  const auto plan = read(with("", "kind = \"position\"", kind)).front().perturbation;
  const auto& ramps = std::get<perturbation::RampPlan>(plan.kind);
  EXPECT_EQ(ramps.ramps.amplitude, 0.008);
  EXPECT_EQ(ramps.ramps.ramp, 0.1);
  EXPECT_EQ(ramps.ramps.hold, 0.4);
  EXPECT_EQ(ramps.ramps.way_back, 0.2);
  EXPECT_EQ(ramps.ramps.directions * ramps.ramps.repetitions, 12);
  EXPECT_EQ(ramps.ramps.shortest_pause, 0.5);
  EXPECT_EQ(ramps.ramps.longest_pause, 0.6);
  EXPECT_EQ(ramps.ramps.quiet, 1.0);
  EXPECT_EQ(ramps.tail, 0.5);
  const auto schedule = perturbation::make_schedule(plan, 3);
  ASSERT_TRUE(schedule) << schedule.error().line();
  EXPECT_EQ(schedule->events().size(), 24U);
  EXPECT_NE(refusal(with("", "kind = \"position\"", "kind = \"ramp_and_hold\"\namplitude_N = 2")).find("amplitude_mm"),
            std::string::npos);
  EXPECT_NE(refusal(one_axis("kind = \"ramp_and_hold\"")).find("amplitude_deg"), std::string::npos);
  const auto along = read(one_axis("kind = \"ramp_and_hold\"\namplitude_deg = 2")).front().perturbation;
  EXPECT_EQ(std::get<perturbation::RampPlan>(along.kind).ramps.directions, 2);
  EXPECT_EQ(std::get<perturbation::RampPlan>(along.kind).ramps.repetitions, 40);
}

/// A machine that moves an elbow, with more lines in [participant] or behind it.
std::string elbow(const std::string& perturbation, const std::string& more = "") {
  return "[robot]\nkind = \"joint\"\nhome_deg = 80\n[perturbation]\n" + perturbation +
         "\n[participant]\nkind = \"elbow\"\n" + more;
}

TEST(ScenarioFile, ReadsAnElbowAndItsStretches) {
  const auto scenario = read(elbow("kind = \"stretches\"\namplitude_deg = -70\nspeeds_deg_per_s = [10, 90]\n"
                                   "repetitions = 3\norder = \"listed\"\nacceleration_deg_per_s2 = 1800\n",
                                   "inertia_kg_m2 = 0.07\nweight_Nm = 2\nhorizontal_deg = 90\n"
                                   "[participant.triceps]\nthreshold_deg = 45\nvelocity_gain_ms = 80\n"
                                   "gain_Nm_per_rad = 9\nlatency_ms = 28\nbackground_percent = 2\n"
                                   "[[participant.triceps.response]]\nlatency_ms = 55\nactivation_percent = 6\n"
                                   "trigger_deg_per_s = 30\n[sensors.emg]\nlargest_uV = 800\nhum_uV = 5\n"))
                            .front();
  const auto& stretches = std::get<perturbation::StretchPlan>(scenario.perturbation.kind).stretches;
  EXPECT_DOUBLE_EQ(stretches.amplitude, -70.0 * kDegree);
  ASSERT_EQ(stretches.speeds.size(), 2U);
  EXPECT_DOUBLE_EQ(stretches.speeds[1], 90.0 * kDegree);
  EXPECT_EQ(stretches.repetitions, 3);
  EXPECT_EQ(stretches.order, perturbation::Stretches::Order::listed);
  EXPECT_DOUBLE_EQ(stretches.acceleration, 1800.0 * kDegree);
  const auto& trial = std::get<ElbowTrial>(scenario.trial);
  EXPECT_DOUBLE_EQ(trial.home, 80.0 * kDegree);
  EXPECT_EQ(trial.elbow.inertia, 0.07);
  EXPECT_DOUBLE_EQ(trial.elbow.rest, 80.0 * kDegree);  // home
  EXPECT_EQ(trial.elbow.weight, 2.0);
  EXPECT_FALSE(trial.elbow.muscles[participant::ElbowJoint::flexor].threshold);
  const auto& triceps = trial.elbow.muscles[participant::ElbowJoint::extensor];
  EXPECT_DOUBLE_EQ(triceps.threshold.value(), 45.0 * kDegree);
  EXPECT_EQ(triceps.velocity_gain, 0.08);
  EXPECT_EQ(triceps.gain, 9.0);
  EXPECT_EQ(triceps.latency, 0.028);
  EXPECT_EQ(triceps.background, 0.02);
  ASSERT_EQ(triceps.responses.size(), 1U);
  EXPECT_EQ(triceps.responses[0].latency, 0.055);
  EXPECT_EQ(triceps.responses[0].activation, 0.06);
  EXPECT_DOUBLE_EQ(triceps.responses[0].trigger_speed, 30.0 * kDegree);
  EXPECT_EQ(trial.emg.largest, 800e-6);
  EXPECT_EQ(trial.emg.hum, 5e-6);
}

TEST(ScenarioFile, AnElbowIsMovedByAngles) {
  for (const char* kind : {"kind = \"ramp_and_hold\"\namplitude_deg = 3", "kind = \"multisine\"",
                           "kind = \"pulses\"\namplitude_deg = 3", "kind = \"random_binary\"\namplitude_deg = 1"}) {
    const auto plan = read(elbow(kind)).front().perturbation;
    EXPECT_EQ(perturbation::make_schedule(plan, 1).value().space(), perturbation::Space::joint) << kind;
  }
  EXPECT_NE(refusal(elbow("kind = \"multisine\"\npeak_Nm = 1")).find("peak_deg"), std::string::npos);
  EXPECT_NE(refusal(elbow("kind = \"none\"")).find("kind"), std::string::npos);
  EXPECT_NE(refusal(with("", "kind = \"position\"", "kind = \"stretches\"")).find("joint"), std::string::npos);
  EXPECT_NE(refusal(elbow("kind = \"stretches\"", "[participant.biceps]\ngain_Nm_per_rad = 5\n")).find("threshold_deg"),
            std::string::npos);
}

TEST(ScenarioFile, MistakesNameFileLineKeyValueAndWhatIsAllowed) {
  const std::pair<std::string, std::vector<std::string>> mistakes[] = {
      {with("peak_degg = 2\n"), {"mine.toml", "line 5", "'peak_degg'", "'peak_deg'"}},
      {with("[robot]\nhandle_mass_kg = -0.1\n"), {"line 6", "robot.handle_mass_kg", "-0.1", "0"}},
      {with("", "kind = \"positron\""), {"control.kind", "'positron'", "position, force, line"}},
      {with("", ""), {"control", "kind"}},
      {"[control]\nkind = \"force\"\n", {"perturbation", "kind"}},
      {with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[1, 0], [0, 1]]\n[participant]\nkind = \"arm\"\n"),
       {"rig", "participant"}},
      {with("[rig]\nmass_kg = 1\nstiffness_N_per_m = [[1, 0], [0, 1]]\n"
            "[[rig.spring]]\nstiffness_N_per_m = 100\nrest_length_mm = 90\nanchor_mm = [1, 2]\n"),
       {"rig.stiffness_N_per_m", "spring"}},
      {with("[participant]\nkind = \"arm\"\nnumber = 7\n"), {"participant.number", "7", "6"}},
      {with("harmonics = [1, 2.5]\n"), {"perturbation.harmonics", "2.5"}},
      {with("", "kind = \"position\"", "kind = \"pulses\"\namplitude_deg = 1"), {"amplitude_deg", "amplitude_mm"}},
      {with("[trial]\nname = \"a\"\n"), {"trial"}},
      {"[control\n", {"mine.toml", "line 1"}},
      {with("peak_deg = \"two\"\n"), {"line 5", "perturbation.peak_deg", "text", "number"}},
      {with("[recording]\nseed = 1.5\n"), {"line 6", "recording.seed"}},
      {with("[robot]\nhome_mm = [1, 2, 3]\n"), {"line 6", "robot.home_mm"}},
      {with("[sensors.clock]\njitter_ms = 2\n"), {"line 6", "'jitter_ms'", "'jitter_us'"}},
      {with("[sensors.force]\nkind = \"scale\"\n"), {"'scale'", "load_cell, strain_gauge, perfect"}},
      {with("[participant]\nkind = \"joint\"\n"), {"participant.kind", "'joint'", "arm, linear, tone"}},
      {with("[rig]\nmass_kg = 1\n"), {"rig", "stiffness_N_per_m"}},
      {one_axis("kind = \"multisine\"", "kind = \"force\"\nproportional_Nm_per_rad = 5"), {"proportional_Nm_per_rad"}},
      {with("[[trial]]\nname = \"a\"\nrecording.seeed = 1\n"), {"line 7", "'seeed'", "'seed'"}},
      {with("[[trial]]\nname = \"a\"\n[[trial]]\nname = \"a\"\n"), {"'a'"}},
  };
  for (const auto& [text, words] : mistakes) {
    const std::string said = refusal(text);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << said << "\nlacks " << word;
  }
}

}  // namespace scenario_file_test
}  // namespace mbk::laboratory
