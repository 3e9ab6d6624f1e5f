#include "mbk/simulate/laboratory/planar_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/simulate/laboratory/truth_text.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/linear_limb.h"

namespace mbk::laboratory {
namespace {

using perturbation::Multisine;
using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

const Vector2d kHome(0.30, -0.05);
constexpr double kHandle = 0.194;

Schedule sines(Quantity quantity, Space space, double amplitude, double duration = 8.0) {
  const auto axis = [&](std::uint32_t stream) {
    return Multisine::with_random_phases(10.0, {1, 7, 13, 20, 29}, std::vector<double>(5, amplitude), 3, stream)
        .value();
  };
  return Schedule::multisine(axis(0), axis(1), quantity, space, duration, 1.0).value();
}

Schedule pulses(double amplitude) {
  perturbation::PulseSchedule::Options options;
  options.amplitude = amplitude;
  options.quiet = 1.0;
  return Schedule::pulses(options, Quantity::force, 3.0).value();
}

participant::LinearLimb limb() {
  impedance::Model model;
  model.M = (Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  model.B = (Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  model.K = (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished();  // not symmetric
  model.x0 = kHome + Vector2d(0.002, -0.001);
  return participant::LinearLimb::create(model).value();
}

Experiment experiment(Schedule schedule, std::variant<PositionMode, ForceMode, LineMode> control) {
  Experiment e{.home = kHome, .schedule = std::move(schedule), .control = std::move(control)};
  e.robot.handle_mass = kHandle;
  e.sensors = SensorOptions::perfect();
  return e;
}

Matrix columns(const Recording& recording, const char* first, const char* second) {
  Matrix pair(recording.samples(), 2);
  pair.col(0) = recording.find(first)->values;
  pair.col(1) = recording.find(second)->values;
  return pair;
}

/// A trial, and the truth of every tick.
struct Watched {
  Performance performance;
  std::vector<TrueState> states;
};

Watched watched(Experiment e, participant::Load& load) {
  Watched result;
  e.watch = [&](const TrueState& state) { result.states.push_back(state); };
  auto performance = perform(e, load);
  EXPECT_TRUE(performance) << performance.error().line();
  result.performance = std::move(*performance);
  return result;
}

/// Every way of driving the robot.
std::vector<Experiment> all_modes() {
  std::vector<Experiment> all;
  all.push_back(experiment(sines(Quantity::position, Space::joint, 0.01), PositionMode{}));
  all.push_back(experiment(sines(Quantity::position, Space::hand, 0.002), PositionMode{}));
  all.push_back(experiment(sines(Quantity::force, Space::hand, 1.0), ForceMode{}));
  all.push_back(experiment(sines(Quantity::force, Space::hand, 1.0), LineMode{}));
  return all;
}

TEST(Experiment, RecordingOfPerfectSensorsObeysTheLimbAndTheHandle) {
  for (const Experiment& e : all_modes()) {
    participant::LinearLimb load = limb();
    const impedance::Model truth = load.impedance(kHome);
    const Watched trial = watched(e, load);
    const Recording& r = trial.performance.recording;
    const Matrix x = columns(r, "hand_x", "hand_y"), a = columns(r, "acceleration_x", "acceleration_y"),
                 f = columns(r, "force_x", "force_y");
    for (Index i = 0; i < r.samples(); ++i) {
      const TrueState& state = trial.states[static_cast<std::size_t>(i)];
      const Vector expected = (truth.M + kHandle * Matrix::Identity(2, 2)) * a.row(i).transpose() +
                              truth.B * state.velocity + truth.K * (x.row(i).transpose() - truth.x0);
      ASSERT_LT((f.row(i).transpose() + expected).norm(), 1e-11) << "sample " << i;
    }
  }
}

/// E = −∫ F_h·v dt by trapezoids, as a user computes it from a recording and the velocity.
double energy_of_samples(const Watched& trial) {
  const Matrix f = columns(trial.performance.recording, "force_x", "force_y");
  double energy = 0.0;
  for (std::size_t i = 1; i < trial.states.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double before = f.row(at - 1).dot(trial.states[i - 1].velocity),
                 after = f.row(at).dot(trial.states[i].velocity);
    energy -= 0.5 * (before + after) * (trial.states[i].time - trial.states[i - 1].time);
  }
  return energy;
}

/// ∫ F*·v dt − viscous − dry − kinetic, with the motors' work as that of the commanded force F* = J⁻ᵀ τ.
double energy_by_identity(const TrueState& last) {
  return last.energy.motors - last.energy.viscous - last.energy.dry - last.kinetic_energy;
}

TEST(Experiment, EnergyIdentityHoldsToAMillionthOfTheEnergyExchanged) {
  for (const Experiment& e : all_modes()) {
    participant::LinearLimb load = limb();
    const Watched trial = watched(e, load);
    const TrueState& last = trial.states.back();
    const double scale = trial.performance.energy_exchanged;
    const double handle = 0.5 * kHandle * last.velocity.squaredNorm();
    EXPECT_NEAR(trial.performance.energy_absorbed + handle, energy_by_identity(last), 1e-6 * scale);
  }
}

TEST(Experiment, EnergyIdentityHoldsToAThousandthWithDryFrictionAndAnArmThatCorrects) {
  participant::ArmOptions person = participant::rigid_arm_options();
  participant::Arm arm = participant::Arm::create(person, 1e-3).value();
  Experiment e = experiment(pulses(2.0), ForceMode{});
  for (robot::JointFriction& joint : e.robot.robot.friction) joint.coulomb = 0.114;
  const Watched trial = watched(e, arm);
  const double handle = 0.5 * kHandle * trial.states.back().velocity.squaredNorm();
  EXPECT_NEAR(trial.performance.energy_absorbed + handle, energy_by_identity(trial.states.back()),
              1e-3 * trial.performance.energy_exchanged);
  EXPECT_NEAR(energy_of_samples(trial), trial.performance.energy_absorbed + handle,
              1e-3 * trial.performance.energy_exchanged);
}

TEST(Experiment, EnergyIsThatOfTheRecordedForce) {
  for (const Experiment& e : all_modes()) {
    participant::LinearLimb load = limb();
    const Watched trial = watched(e, load);
    const double handle = 0.5 * kHandle * trial.states.back().velocity.squaredNorm();
    // Trapezoids err by (ωT)²/12 of what is exchanged: 3e-5 at 3 Hz, and the first half tick is at rest
    EXPECT_NEAR(energy_of_samples(trial), trial.performance.energy_absorbed + handle,
                5e-5 * trial.performance.energy_exchanged);
  }
}

TEST(Experiment, HalvingTheStepChangesTheMotionByLessThanAHundredThousandth) {
  for (Experiment e : all_modes()) {
    participant::LinearLimb load = limb(), again = limb();
    const Watched coarse = watched(e, load);
    e.robot.steps_per_tick = 2;
    const Watched fine = watched(e, again);
    double away = 0.0, travel = 0.0;
    for (std::size_t i = 0; i < fine.states.size(); ++i) {
      away = std::max(away, (coarse.states[i].position - fine.states[i].position).norm());
      travel = std::max(travel, (fine.states[i].position - kHome).norm());
    }
    EXPECT_LT(away, 1e-5 * travel);
  }
}

TEST(Experiment, PositionModeFollowsItsReferenceAndRecordsItAsAPlace) {
  participant::LinearLimb load = limb();
  Experiment e = experiment(sines(Quantity::position, Space::joint, 0.01), PositionMode{});
  std::get<PositionMode>(e.control).gains.proportional.setConstant(600.0);
  std::get<PositionMode>(e.control).gains.derivative.setConstant(15.0);
  const Watched trial = watched(e, load);
  const Recording& r = trial.performance.recording;
  const Matrix error = columns(r, "hand_x", "hand_y") - columns(r, "reference_x", "reference_y");
  EXPECT_LT(error.rowwise().norm().maxCoeff(), 1e-3);  // of 12 mm
  EXPECT_EQ(r.find("reference_x")->unit, "m");
  EXPECT_EQ(r.time[0], 1e-3);
}

TEST(Experiment, ForceModeRecordsTheForceThatIsCommanded) {
  participant::LinearLimb load = limb();
  const Experiment e = experiment(pulses(2.0), ForceMode{});
  const Watched trial = watched(e, load);
  const Recording& r = trial.performance.recording;
  EXPECT_EQ(r.find("reference_x")->unit, "N");
  EXPECT_NEAR(columns(r, "reference_x", "reference_y").rowwise().norm().maxCoeff(), 2.0, 1e-12);
  EXPECT_EQ(r.events.size(), 32u);
}

TEST(Experiment, LineModeKeepsTheHandOnTheLine) {
  participant::LinearLimb load = limb();
  const Watched trial = watched(experiment(sines(Quantity::force, Space::hand, 1.0), LineMode{}), load);
  double across = 0.0, along = 0.0;
  for (const TrueState& state : trial.states) {
    across = std::max(across, std::abs(state.position.x() - kHome.x()));
    along = std::max(along, std::abs(state.position.y() - kHome.y()));
  }
  EXPECT_GT(along, 0.01);
  EXPECT_LT(across, 0.03 * along);
}

TEST(Experiment, MetadataHoldTheTruthOfTheLoad) {
  participant::LinearLimb load = limb();
  const Watched trial = watched(experiment(pulses(2.0), ForceMode{}), load);
  const std::map<std::string, std::string> wanted = {
      {"truth_M", "[[1.326, -0.935], [-0.935, 1.883]]"},
      {"truth_B", "[[5.76, -2.14], [-2.14, 10.56]]"},
      {"truth_K", "[[42.4, -20.9], [-36.3, 125.3]]"},
      {"truth_x0", "[0.302, -0.051]"},
      {"truth_energy_absorbed_J", exact_text(trial.performance.energy_absorbed)},
      {"truth_force_delay_s", "0"},
      {"handle_mass_kg", "0.194"},
      {"rate_hz", "1000"}};
  EXPECT_EQ(trial.performance.recording.metadata, wanted);
  EXPECT_NEAR(trial.performance.truth.K(0, 1), -20.9, 1e-12);  // a mean over the trial
}

TEST(Experiment, MetadataTellOfASensorThatIsLateAndClips) {
  participant::LinearLimb load = limb();
  Experiment e = experiment(sines(Quantity::force, Space::hand, 1.0, 2.0), ForceMode{});
  StrainGaugeOptions gauge;
  gauge.converter_range = 0.1;  // ±0.9 N
  e.sensors.force = gauge;
  const Watched trial = watched(e, load);
  const auto& metadata = trial.performance.recording.metadata;
  EXPECT_GT(std::stoi(metadata.at("force_samples_clipped")), 10);
  EXPECT_NEAR(std::stod(metadata.at("truth_force_delay_s")), 8.6e-3, 1e-4);
}

TEST(Experiment, SaysWhenTheHandLeavesTheWorkspace) {
  participant::LinearLimb load = limb();
  Experiment e = experiment(sines(Quantity::force, Space::hand, 40.0), ForceMode{});
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("leaves the workspace at "), std::string::npos) << outcome.error().line();
  e = experiment(sines(Quantity::position, Space::hand, 0.3), PositionMode{});
  EXPECT_FALSE(perform(e, load));
}

TEST(Experiment, RefusesToFollowAForceOrToExertAPlace) {
  participant::LinearLimb load = limb();
  EXPECT_FALSE(perform(experiment(pulses(2.0), PositionMode{}), load));
  EXPECT_FALSE(perform(experiment(sines(Quantity::position, Space::joint, 0.01), ForceMode{}), load));
  EXPECT_FALSE(perform(experiment(sines(Quantity::force, Space::joint, 0.1), ForceMode{}), load));
  Experiment e = experiment(pulses(2.0), ForceMode{});
  e.home = Vector2d(0.9, 0.0);
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().where.substr(0, 4), "home");
}

}  // namespace
}  // namespace mbk::laboratory
