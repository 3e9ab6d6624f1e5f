#include "mbk/validate/robot_trials.h"

#include <memory>
#include <utility>

#include "mbk/measure/measurement/identify_robot.h"
#include "mbk/validate/simulated_trials.h"

namespace mbk::validation {
namespace {

Result<laboratory::Scenario> free_motion_scenario() {
  auto scenarios = MBK_TRY(ready("free_motion"));
  return scenarios.front();
}

}  // namespace

robot::DriveTerms drive_terms(FrictionModel friction) {
  robot::DriveTerms terms;
  terms.viscous = friction != FrictionModel::none;
  terms.coulomb = terms.offset = friction == FrictionModel::full;
  return terms;
}

laboratory::PlanarTrial& planar(laboratory::Scenario& scenario) {
  return std::get<laboratory::PlanarTrial>(scenario.trial);
}

void measure_currents(laboratory::Scenario& scenario) {
  laboratory::MotorCurrentOptions<2> current;
  current.noise = kTorqueNoise / current.torque_constant[0];
  planar(scenario).sensors.torque = current;
}

Result<Recording> free_motion(std::uint64_t seed, const std::optional<robot::Capstan>& capstan) {
  auto scenario = MBK_TRY(free_motion_scenario());
  scenario.seed = seed;
  planar(scenario).robot.capstan = capstan;
  measure_currents(scenario);
  auto performance = MBK_TRY(laboratory::simulate(scenario));
  return std::move(performance.recording);
}

Result<Vector> true_parameters(FrictionModel friction) {
  auto scenario = MBK_TRY(free_motion_scenario());
  const robot::PlanarRobot& robot = planar(scenario).robot.robot;
  const robot::DriveTerms terms = drive_terms(friction);
  const int per_joint = terms.per_joint();
  Vector truth = Vector::Zero(3 + 2 * per_joint);
  truth.head(3) << robot.inertia.alpha1, robot.inertia.alpha2, robot.inertia.alpha3;
  for (int joint = 0; joint < 2; ++joint) {
    Index at = 3 + joint * per_joint;
    const robot::JointFriction& of_joint = robot.friction[static_cast<std::size_t>(joint)];
    if (terms.viscous) truth[at++] = of_joint.viscous;
    if (terms.coulomb) truth[at] = of_joint.coulomb;
  }
  return truth;
}

Result<RobotIdentification> identified_robot(const Recording& recording, FrictionModel friction,
                                             robot::PlanarMechanism::Coriolis coriolis) {
  auto scenario = MBK_TRY(free_motion_scenario());
  robot::PlanarMechanism::Options mechanism;
  mechanism.geometry = planar(scenario).robot.robot.geometry;
  mechanism.coriolis = coriolis;
  robot::DynamicModel model{std::make_shared<robot::PlanarMechanism>(mechanism), drive_terms(friction)};
  model.parameters = Vector::Zero(static_cast<Index>(model.coefficients().size()));
  measurement::RobotOptions options;
  options.fit.delay = true;
  return measurement::identify_robot({&recording, 1}, {}, model, options);
}

}  // namespace mbk::validation
