#include "mbk/model/robot/observed_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "mbk/measure/analyse/compare_forces.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/simulate/laboratory/simulated_experiment.h"

namespace mbk::pipeline {
namespace observed_force_test {

using robot::EncoderMomentumObserver;

/// A trial with the truth of each tick beside it.
struct Watched {
  Recording recording;
  Matrix force, joint_velocity;  // true
};

Watched watched(bool perfect) {
  auto scenario =
      laboratory::read_scenarios(laboratory::find_ready_scenario("relaxed_sinusoidal")->text, "relaxed_sinusoidal.toml")
          .value()
          .front();
  auto& trial = std::get<laboratory::PlanarTrial>(scenario.trial);
  for (robot::JointFriction& joint : trial.robot.robot.friction) joint.coulomb = 0.11;
  if (perfect) trial.sensors = laboratory::SensorOptions<2>::perfect();
  std::vector<laboratory::TrueState<2>> states;
  laboratory::SimulateOptions options;
  options.watch = [&](const laboratory::TrueState<2>& state) { states.push_back(state); };
  Watched result{laboratory::simulate(scenario, options).value().recording, {}, {}};
  const auto samples = static_cast<Index>(states.size());
  result.force.resize(samples, 2);
  result.joint_velocity.resize(samples, 2);
  for (Index i = 0; i < samples; ++i) {
    result.force.row(i) = states[static_cast<std::size_t>(i)].force_hand_on_robot.transpose();
    result.joint_velocity.row(i) = states[static_cast<std::size_t>(i)].theta_rate.transpose();
  }
  return result;
}

/// The robot of the scenario, with or without its dry friction.
robot::DynamicModel thesis_robot(double coulomb) {
  const robot::PlanarRobot thesis;
  robot::DynamicModel model{std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{}),
                            {.offset = false}};
  model.parameters.resize(7);
  model.parameters << thesis.inertia.alpha1, thesis.inertia.alpha2, thesis.inertia.alpha3, thesis.friction[0].viscous,
      coulomb, thesis.friction[1].viscous, coulomb;
  return model;
}

Matrix channels(const Recording& recording, const char* first, const char* second) {
  Matrix pair(recording.samples(), 2);
  pair.col(0) = recording.find(first)->values;
  pair.col(1) = recording.find(second)->values;
  return pair;
}

struct Outcome {
  ForceComparison comparison, without_lag;
  double lag;
};

Outcome compared(const Watched& trial, double coulomb, const EncoderMomentumObserver::Options& options) {
  const auto seen = robot::observe_force(thesis_robot(coulomb), channels(trial.recording, "joint_1", "joint_2"),
                                         channels(trial.recording, "torque_1", "torque_2"), options, 1e-3)
                        .value();
  const Index rows = trial.force.rows() - seen.settled, late = std::llround(seen.lag / 1e-3);
  const analyse::ForcePair pair{seen.force_hand_on_robot.bottomRows(rows), trial.force.bottomRows(rows),
                                trial.joint_velocity.bottomRows(rows)};
  const analyse::ForcePair moved{pair.estimated.bottomRows(rows - late), pair.measured.topRows(rows - late),
                                 pair.joint_velocity.topRows(rows - late)};
  return {analyse::compare_forces({pair}, 1e-3).value(), analyse::compare_forces({moved}, 1e-3).value(), seen.lag};
}

TEST(ObservedForce, OfASimulatedTrialIsTheTrueForceLaterByTheLagOfTheObserver) {
  const Watched trial = watched(true);
  for (const double gain : {30.0, 60.0, 200.0}) {
    const Outcome found = compared(trial, 0.11, {.gain = gain});
    // Each sine is late by its phase, most at zero frequency and least at the highest line.
    constexpr double kHighest = 2.0 * std::numbers::pi * 2.9, kMargin = 1e-3;  // [rad/s]; a tick [s]
    const double at_highest = std::atan(kHighest / gain) / kHighest;
    for (Index axis = 0; axis < 2; ++axis) {
      EXPECT_GT(found.comparison.lag[axis], found.lag - 1.0 / gain + at_highest - kMargin) << "gain " << gain;
      EXPECT_LT(found.comparison.lag[axis], found.lag + kMargin) << "gain " << gain;
      EXPECT_GT(found.without_lag.vaf[axis], gain < 50.0 ? 96.0 : 99.5) << "gain " << gain;
    }
  }
}

TEST(ObservedForce, AsksForTheFrictionOfTheRobot) {
  const Watched trial = watched(true);
  const Outcome with = compared(trial, 0.11, {}), without = compared(trial, 0.0, {});
  for (Index axis = 0; axis < 2; ++axis) {
    EXPECT_LT(with.without_lag.all.rmse[axis], 0.3 * without.without_lag.all.rmse[axis]);
    EXPECT_LT(std::abs(with.without_lag.motion.bias[axis]), 0.02);
  }
}

TEST(ObservedForce, FromTheEncodersOfTheThesisIsNoiseAwayFromThatOfPerfectOnes) {
  const Outcome found = compared(watched(false), 0.11, {});
  for (Index axis = 0; axis < 2; ++axis) {
    EXPECT_LT(found.comparison.all.rmse[axis], 0.5);  // the lag of 18 ms is most of it
    EXPECT_LT(found.without_lag.all.rmse[axis], 0.1);
    EXPECT_GT(found.without_lag.vaf[axis], 99.0);
  }
}

}  // namespace observed_force_test
}  // namespace mbk::pipeline
