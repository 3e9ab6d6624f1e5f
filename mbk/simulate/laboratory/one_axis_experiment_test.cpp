#include "mbk/simulate/laboratory/one_axis_experiment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "mbk/simulate/laboratory/truth_text.h"
#include "mbk/simulate/participant/one_axis_joint.h"

namespace mbk::laboratory {
namespace {

using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

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

OneAxisExperiment experiment(Schedule schedule) {
  OneAxisExperiment e{.schedule = std::move(schedule)};
  e.machine.friction.viscous = 0.1;
  e.sensors = {.position_resolution = 0.0, .reaction_noise = 0.0, .acceleration_noise = 0.0};
  return e;
}

Performance performed(const OneAxisExperiment& e) {
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

TEST(OneAxisExperiment, RecordingOfPerfectSensorsObeysTheJoint) {
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

TEST(OneAxisExperiment, EnergyIsThatOfTheRecordedReaction) {
  const Performance trial = performed(experiment(binary(Quantity::force, 1.5)));
  const Vector rate = rate_of(channel(trial, "position"));
  const double energy = -1e-3 * rate.dot(channel(trial, "reaction").segment(1, rate.size()));
  EXPECT_NEAR(energy, trial.energy_absorbed, 2e-3 * trial.energy_exchanged);
  EXPECT_GT(trial.energy_absorbed, 0.0);
  EXPECT_GT(trial.energy_exchanged, trial.energy_absorbed);
}

TEST(OneAxisExperiment, ServoFollowsPlacesAndMotorExertsTorques) {
  const Performance following = performed(experiment(binary(Quantity::position, 0.03)));
  const Vector error = channel(following, "position") - channel(following, "reference");
  EXPECT_LT(error.norm(), 0.15 * channel(following, "reference").norm());
  EXPECT_EQ(following.recording.find("reference")->unit, "rad");

  // u = j_m ẍ + F_r + h; what is recorded is the mean before and after a step of the motor, half a tick off
  const OneAxisExperiment e = experiment(binary(Quantity::force, 1.5));
  const Performance exerting = performed(e);
  EXPECT_EQ(exerting.recording.find("reference")->unit, "N.m");
  const Vector moved = e.machine.inertia * channel(exerting, "acceleration") - channel(exerting, "reaction");
  const Vector& wanted = channel(exerting, "reference");
  const Index inner = wanted.size() - 2;
  const Vector torque = moved.segment(1, inner) + e.machine.friction.viscous * rate_of(channel(exerting, "position"));
  const Vector halfway = 0.5 * (wanted.segment(1, inner) + wanted.head(inner));
  EXPECT_LT((torque - halfway).norm(), 1e-3 * wanted.norm());
}

TEST(OneAxisExperiment, RecordingHasItsClockItsEventsAndTheTruth) {
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
  EXPECT_EQ(trial.truth.K(0, 0), kStiffness);
}

TEST(OneAxisExperiment, RefusesWhatIsNoTrialAndTellsOfMotionThatRunsAway) {
  participant::OneAxisJoint load = joint();
  OneAxisExperiment e = experiment(binary(Quantity::position, 0.03));
  e.rate = Hertz(0.0);
  EXPECT_EQ(perform(e, load).error().message, "sample rate 0 Hz is not above 0");
  e = experiment(binary(Quantity::position, 0.03));
  e.servo.derivative = -1.0;
  EXPECT_EQ(perform(e, load).error().kind, ErrorKind::usage);
  e = experiment(binary(Quantity::position, 0.03));
  e.servo.proportional = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(perform(e, load).error().kind, ErrorKind::usage);
  e = experiment(binary(Quantity::position, 0.03));
  e.servo.proportional = 1e7;  // far above what a servo of 1 kHz can hold
  const auto outcome = perform(e, load);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().kind, ErrorKind::data);
  EXPECT_NE(outcome.error().message.find("not finite any more at "), std::string::npos) << outcome.error().line();
}

}  // namespace
}  // namespace mbk::laboratory
