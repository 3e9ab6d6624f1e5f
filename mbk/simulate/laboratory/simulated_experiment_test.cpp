#include "mbk/simulate/laboratory/simulated_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "mbk/simulate/laboratory/truth_text.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/linear_limb.h"
#include "mbk/simulate/participant/one_axis_joint.h"

namespace mbk::laboratory {
namespace simulated_experiment_test {

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
  return Schedule::multisine({axis(0), axis(1)}, quantity, space, duration, 1.0).value();
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

Experiment<2> experiment(Schedule schedule, std::variant<PositionMode, ForceMode, LineMode> control) {
  Experiment<2> e{.home = kHome, .schedule = std::move(schedule), .control = std::move(control)};
  e.robot.handle_mass = kHandle;
  e.sensors = SensorOptions<2>::perfect();
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
  std::vector<TrueState<2>> states;
};

Watched watched(Experiment<2> e, participant::Load<2>& load) {
  Watched result;
  e.watch = [&](const TrueState<2>& state) { result.states.push_back(state); };
  auto performance = perform(e, load);
  EXPECT_TRUE(performance) << performance.error().line();
  result.performance = std::move(*performance);
  return result;
}

/// Every way of driving the robot.
std::vector<Experiment<2>> all_modes() {
  std::vector<Experiment<2>> all;
  all.push_back(experiment(sines(Quantity::position, Space::joint, 0.01), PositionMode{}));
  all.push_back(experiment(sines(Quantity::position, Space::hand, 0.002), PositionMode{}));
  all.push_back(experiment(sines(Quantity::force, Space::hand, 1.0), ForceMode{}));
  all.push_back(experiment(sines(Quantity::force, Space::hand, 1.0), LineMode{}));
  return all;
}

TEST(Experiment, RecordingOfPerfectSensorsObeysTheLimbAndTheHandle) {
  for (const Experiment<2>& e : all_modes()) {
    participant::LinearLimb load = limb();
    const impedance::Model truth = load.impedance(kHome);
    const Watched trial = watched(e, load);
    const Recording& r = trial.performance.recording;
    const Matrix x = columns(r, "hand_x", "hand_y"), a = columns(r, "acceleration_x", "acceleration_y"),
                 f = columns(r, "force_x", "force_y");
    for (Index i = 0; i < r.samples(); ++i) {
      const TrueState<2>& state = trial.states[static_cast<std::size_t>(i)];
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
double energy_by_identity(const TrueState<2>& last) {
  return last.energy.motors - last.energy.viscous - last.energy.dry - last.kinetic_energy;
}

TEST(Experiment, EnergyIdentityHoldsToAMillionthOfTheEnergyExchanged) {
  for (const Experiment<2>& e : all_modes()) {
    participant::LinearLimb load = limb();
    const Watched trial = watched(e, load);
    const TrueState<2>& last = trial.states.back();
    const double scale = trial.performance.energy_exchanged;
    const double handle = 0.5 * kHandle * last.velocity.squaredNorm();
    EXPECT_NEAR(trial.performance.energy_absorbed + handle, energy_by_identity(last), 1e-6 * scale);
  }
}

TEST(Experiment, EnergyIdentityHoldsToAThousandthWithDryFrictionAndAnArmThatCorrects) {
  participant::ArmOptions person = participant::rigid_arm_options();
  participant::Arm arm = participant::Arm::create(person, 1e-3).value();
  Experiment<2> e = experiment(pulses(2.0), ForceMode{});
  for (robot::JointFriction& joint : e.robot.robot.friction) joint.coulomb = 0.114;
  const Watched trial = watched(e, arm);
  const double handle = 0.5 * kHandle * trial.states.back().velocity.squaredNorm();
  EXPECT_NEAR(trial.performance.energy_absorbed + handle, energy_by_identity(trial.states.back()),
              1e-3 * trial.performance.energy_exchanged);
  EXPECT_NEAR(energy_of_samples(trial), trial.performance.energy_absorbed + handle,
              1e-3 * trial.performance.energy_exchanged);
}

TEST(Experiment, EnergyIsThatOfTheRecordedForce) {
  for (const Experiment<2>& e : all_modes()) {
    participant::LinearLimb load = limb();
    const Watched trial = watched(e, load);
    const double handle = 0.5 * kHandle * trial.states.back().velocity.squaredNorm();
    // Trapezoids err by (ωT)²/12 of what is exchanged: 3e-5 at 3 Hz, and the first half tick is at rest
    EXPECT_NEAR(energy_of_samples(trial), trial.performance.energy_absorbed + handle,
                5e-5 * trial.performance.energy_exchanged);
  }
}

TEST(Experiment, HalvingTheStepChangesTheMotionByLessThanAHundredThousandth) {
  for (Experiment<2> e : all_modes()) {
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
  Experiment<2> e = experiment(sines(Quantity::position, Space::joint, 0.01), PositionMode{});
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
  const Experiment<2> e = experiment(pulses(2.0), ForceMode{});
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
  for (const TrueState<2>& state : trial.states) {
    across = std::max(across, std::abs(state.position.x() - kHome.x()));
    along = std::max(along, std::abs(state.position.y() - kHome.y()));
  }
  EXPECT_GT(along, 0.01);
  EXPECT_LT(across, 0.03 * along);
}

TEST(Experiment, MetadataHoldTheTruthOfTheLoad) {
  participant::LinearLimb load = limb();
  const Watched trial = watched(experiment(pulses(2.0), ForceMode{}), load);
  const std::map<std::string, std::string> expected = {
      {"truth_M", "[[1.326, -0.935], [-0.935, 1.883]]"},
      {"truth_B", "[[5.76, -2.14], [-2.14, 10.56]]"},
      {"truth_K", "[[42.4, -20.9], [-36.3, 125.3]]"},
      {"truth_x0", "[0.302, -0.051]"},
      {"truth_energy_absorbed_J", exact_text(trial.performance.energy_absorbed)},
      {"truth_force_delay_s", "0"},
      {"handle_mass_kg", "0.194"},
      {"rate_hz", "1000"}};
  EXPECT_EQ(trial.performance.recording.metadata, expected);
  EXPECT_NEAR(trial.performance.truth.K(0, 1), -20.9, 1e-12);  // a mean over the trial
}

TEST(Experiment, MetadataTellOfASensorThatIsLateAndClips) {
  participant::LinearLimb load = limb();
  Experiment<2> e = experiment(sines(Quantity::force, Space::hand, 1.0, 2.0), ForceMode{});
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
  Experiment<2> e = experiment(sines(Quantity::force, Space::hand, 40.0), ForceMode{});
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().message.find("workspace"), std::string::npos) << outcome.error().line();
  e = experiment(sines(Quantity::position, Space::hand, 0.3), PositionMode{});
  EXPECT_FALSE(perform(e, load));
}

TEST(Experiment, RefusesToFollowAForceOrToExertAPlace) {
  participant::LinearLimb load = limb();
  EXPECT_FALSE(perform(experiment(pulses(2.0), PositionMode{}), load));
  EXPECT_FALSE(perform(experiment(sines(Quantity::position, Space::joint, 0.01), ForceMode{}), load));
  EXPECT_FALSE(perform(experiment(sines(Quantity::force, Space::joint, 0.1), ForceMode{}), load));
  Experiment<2> e = experiment(pulses(2.0), ForceMode{});
  e.home = Vector2d(0.9, 0.0);
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().where.substr(0, 4), "home");
}

constexpr double kInertia = 0.015, kViscosity = 0.8, kStiffness = 45.0, kRest = 0.01;

participant::OneAxisJoint joint() {
  participant::OneAxisJoint::Options options;
  options.inertia = kInertia;
  options.viscosity = kViscosity;
  options.stiffness = kStiffness;
  options.rest = kRest;
  options.remnant.floor = 0.0;
  return participant::OneAxisJoint::create(options, 1e-3).value();
}

Schedule binary(Quantity quantity, double amplitude) {
  perturbation::RandomBinaryOptions options;
  options.amplitude = amplitude;
  options.damping_ratio = 0.7;
  options.natural_frequency = RadPerSec(30.0);
  return Schedule::random_binary(options, 0.0, quantity, 10.0, Space::joint).value();
}

Experiment<1> experiment(Schedule schedule) {
  const bool position = schedule.quantity() == Quantity::position;
  Experiment<1> e{.schedule = std::move(schedule),
                  .control = position ? OneAxisMode(ServoMode{}) : OneAxisMode(ForceMode{})};
  e.robot.robot.friction[0].viscous = 0.1;
  e.sensors = SensorOptions<1>::perfect();
  return e;
}

Performance performed(const Experiment<1>& e) {
  participant::OneAxisJoint load = joint();
  auto performance = perform(e, load);
  EXPECT_TRUE(performance) << performance.error().line();
  return *performance;
}

const Vector& channel(const Performance& performance, const char* name) {
  return performance.recording.find(name)->values;
}

/// Differences over two samples: errs by (ωT)²/6, 6e-5 at 3 Hz.
Vector rate_of(const Vector& values) {
  const Index n = values.size();
  return (values.tail(n - 2) - values.head(n - 2)) / 2e-3;
}

TEST(ExperimentOfOneAxis, RecordingOfPerfectSensorsObeysTheJoint) {
  for (const auto& [quantity, amplitude] : {std::pair{Quantity::position, 0.03}, {Quantity::force, 1.5}}) {
    const Performance trial = performed(experiment(binary(quantity, amplitude)));
    const Vector& x = channel(trial, "position");
    const Index inner = x.size() - 2;
    const Vector expected = -(kInertia * channel(trial, "acceleration").segment(1, inner) + kViscosity * rate_of(x) +
                              kStiffness * (x.segment(1, inner).array() - kRest).matrix());
    const Vector reaction = channel(trial, "reaction").segment(1, inner);
    EXPECT_LT((reaction - expected).norm(), 1e-3 * reaction.norm());
  }
}

TEST(ExperimentOfOneAxis, EnergyIsThatOfTheRecordedReaction) {
  const Performance trial = performed(experiment(binary(Quantity::force, 1.5)));
  const Vector rate = rate_of(channel(trial, "position"));
  const double energy = -1e-3 * rate.dot(channel(trial, "reaction").segment(1, rate.size()));
  EXPECT_NEAR(energy, trial.energy_absorbed, 2e-3 * trial.energy_exchanged);
  EXPECT_GT(trial.energy_absorbed, 0.0);
  EXPECT_GT(trial.energy_exchanged, trial.energy_absorbed);
}

TEST(ExperimentOfOneAxis, ServoFollowsPlacesAndMotorExertsTorques) {
  const Performance following = performed(experiment(binary(Quantity::position, 0.03)));
  const Vector error = channel(following, "position") - channel(following, "reference");
  EXPECT_LT(error.norm(), 0.15 * channel(following, "reference").norm());
  EXPECT_EQ(following.recording.find("reference")->unit, "rad");

  // u = j_m ẍ + F_r + h; what is recorded is the mean before and after a step of the motor, half a tick off
  const Experiment<1> e = experiment(binary(Quantity::force, 1.5));
  const Performance exerting = performed(e);
  EXPECT_EQ(exerting.recording.find("reference")->unit, "N.m");
  const Vector moved = e.robot.robot.inertia.mass * channel(exerting, "acceleration") - channel(exerting, "reaction");
  const Vector& expected = channel(exerting, "reference");
  const Index inner = expected.size() - 2;
  const Vector torque =
      moved.segment(1, inner) + e.robot.robot.friction[0].viscous * rate_of(channel(exerting, "position"));
  const Vector halfway = 0.5 * (expected.segment(1, inner) + expected.head(inner));
  EXPECT_LT((torque - halfway).norm(), 1e-3 * expected.norm());
}

TEST(ExperimentOfOneAxis, RecordingHasItsClockItsEventsAndTheTruth) {
  perturbation::PulseSchedule::Options pulses;
  pulses.directions = 2;
  pulses.amplitude = 0.02;
  pulses.quiet = 0.5;
  const Performance trial =
      performed(experiment(Schedule::pulses(pulses, Quantity::position, 2.0, Space::joint).value()));
  const Recording& r = trial.recording;
  EXPECT_EQ(r.time[0], 1e-3);
  EXPECT_NEAR(r.time[r.samples() - 1], 1e-3 * static_cast<double>(r.samples()), 1e-9);
  EXPECT_EQ(r.events.size(), 8u);
  EXPECT_EQ(r.metadata.at("truth_M"), "[[0.015]]");
  EXPECT_EQ(r.metadata.at("truth_B"), "[[0.8]]");
  EXPECT_EQ(r.metadata.at("truth_K"), "[[45]]");
  EXPECT_EQ(r.metadata.at("truth_x0"), "[0.01]");
  EXPECT_EQ(r.metadata.at("truth_energy_absorbed_J"), exact_text(trial.energy_absorbed));
  EXPECT_NEAR(trial.truth.K(0, 0), kStiffness, 1e-12);  // a mean over the trial
  EXPECT_EQ(r.metadata.count("handle_mass_kg"), 0u);
}

TEST(ExperimentOfOneAxis, RefusesWhatIsNoTrialAndTellsOfMotionThatRunsAway) {
  participant::OneAxisJoint load = joint();
  Experiment<1> e = experiment(binary(Quantity::position, 0.03));
  e.rate = Hertz(0.0);
  EXPECT_NE(perform(e, load).error().message.find(" 0 Hz"), std::string::npos);
  e = experiment(binary(Quantity::position, 0.03));
  e.control = ForceMode{};
  EXPECT_NE(perform(e, load).error().message.find("perturbation"), std::string::npos);
  e = experiment(binary(Quantity::position, 0.03));
  std::get<ServoMode>(e.control).derivative = -1.0;
  EXPECT_EQ(perform(e, load).error().kind, ErrorKind::usage);
  e = experiment(binary(Quantity::position, 0.03));
  std::get<ServoMode>(e.control).proportional = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(perform(e, load).error().kind, ErrorKind::usage);
  e = experiment(binary(Quantity::position, 0.03));
  std::get<ServoMode>(e.control).proportional = 1e7;  // far above what a servo of 1 kHz can hold
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::data);
  EXPECT_NE(outcome.error().message.find("motion"), std::string::npos) << outcome.error().line();
}

}  // namespace simulated_experiment_test
}  // namespace mbk::laboratory
