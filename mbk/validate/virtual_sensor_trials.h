#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/robot/capstan.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/simulated_trials.h"

namespace mbk::validation {

/// Where the force of a measurement comes from: method 2 of Dyck (2013, §5.2.2), its method 1 with three models of the
/// robot's friction, and the momentum observer, which is causal.
enum class Force { sensor, virtual_sensor, no_coulomb, no_friction, observer };
inline constexpr int kForces = 5;

[[nodiscard]] constexpr auto word_table(Force) {
  using enum Force;
  return std::to_array<Word<Force>>({{sensor, "sensor"},
                                     {virtual_sensor, "virtual sensor"},
                                     {no_coulomb, "virtual sensor without Coulomb"},
                                     {no_friction, "virtual sensor without friction"},
                                     {observer, "momentum observer"}});
}

/// One robot, as three models of its friction found it.
struct Robots {
  std::array<std::shared_ptr<const robot::DynamicModel>, 3> models;  ///< by FrictionModel

  /// The model that a computed force rests on; that of all friction for the observer.
  [[nodiscard]] std::shared_ptr<const robot::DynamicModel> behind(Force force) const;
};

/// From one free motion, each as identified_robot does it.
/// @fails  as free_motion, identified_robot
[[nodiscard]] Result<Robots> identify_robots(std::uint64_t seed, const std::optional<robot::Capstan>& capstan = {});

/// What one force made of one trial.
struct ForceOutcome {
  impedance::Model model, standard_error;
  Vector vaf;            ///< of the model, held out [%]
  Eigen::Vector2d rmse;  ///< of the force against what acted, behind the same filters [N]
};

/// A trial of a rig or a limb, measured with several forces.
struct ForceTrial {
  std::string stiffness, mass;  ///< of a rig: "K5", "M3"
  impedance::Model truth;       ///< mean over the trial
  std::array<ForceOutcome, kForces> by;

  [[nodiscard]] const ForceOutcome& of(Force force) const { return by[static_cast<std::size_t>(force)]; }
};

/// How a trial is measured, apart from the source of its force.
struct ForceMeasurement {
  measurement::Options options = mass_and_springs();
  std::vector<Force> forces = {Force::sensor, Force::virtual_sensor, Force::no_coulomb, Force::no_friction,
                               Force::observer};
};

/// The signals that a measurement with this force rests on.
/// @fails  as preprocess::prepare, preprocess::virtual_force
[[nodiscard]] Result<PreparedTrial> prepare_with(const Recording& recording, Force force, const Robots& robots,
                                                 preprocess::Options options);

/// One planar trial, simulated once and measured with each of the forces; the others stay empty.
/// @fails  as simulate, prepare_with and identify_impedance
[[nodiscard]] Result<ForceTrial> perform(const laboratory::Scenario& scenario, const Robots& robots,
                                         const ForceMeasurement& measurement);

}  // namespace mbk::validation
