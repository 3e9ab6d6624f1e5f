#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/reproduction.h"
#include "mbk/model/trial/robot_identification.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/virtual_sensor_trials.h"
#include "thesis/workbench.h"

/// What the exhibits of the apparatus and of the virtual sensor have in common. For the sources of this module only.
namespace mbk::thesis {

/// The ready scenarios of table 5.1: arrays of springs, and linear fields in their place.
inline constexpr const char* kSpringRigs = "rig_springs_table_5_1";
inline constexpr const char* kLinearRigs = "rig_table_5_1";

/// Scenarios that bring a seed of their own keep it in a reproduction with the seed 1, and get another with each other.
[[nodiscard]] std::uint64_t rig_seed(const Workbench& bench, const laboratory::Scenario& scenario);

/// " --seed 1001", or nothing where the scenario's own seed is meant.
[[nodiscard]] std::string seed_option(const Workbench& bench, const laboratory::Scenario& scenario);

/// What the text of the source says of its numbers, which stands in ours (exhibit_text.h), and what ours say.
[[nodiscard]] ReproducedTable claims_table(const char* id);
void add_claim(ReproducedTable& table, const char* claim, std::string ours);

/// A free motion of the robot, and what models of it find in the first forty of its last fifty seconds.
struct FreeMotion {
  RobotIdentification viscous;       ///< with viscous friction alone, by the filters and least squares of the source
  RobotIdentification full;          ///< the same with Coulomb friction and an offset besides
  RobotIdentification by_default;    ///< as mbk robot identify does it
  RobotIdentification printed_sign;  ///< as `full`, with the Coriolis sign of (A.6) as it is printed
};

struct FreeMotions {
  std::vector<FreeMotion> trials;
  Recording first;  ///< recording of the first trial
};

inline constexpr int kFreeMotions = 6;  ///< (Dyck 2013, A.2)

/// The options of `mbk robot identify` behind FreeMotion::viscous, in words.
inline constexpr const char* kPublishedRobotOptions =
    "--method ls --motor-delay 0 --sg-window 151 --cutoff 4.5 --from 12 --split 52 --to 62";

/// @fails  as simulate, identify_robot
[[nodiscard]] Result<FreeMotions> make_free_motions(Workbench& bench);

/// The signals of a free motion as `viscous` and `full` see them.
/// @fails  as preprocess::prepare_dynamics
[[nodiscard]] Result<PreparedDynamics> prepare_free_motion(const Recording& recording,
                                                           const robot::DynamicModel& model);

/// The robot that virtual sensors rest on: FreeMotion::viscous, which the source had, and `full` of the first of the
/// free motions.
/// @fails  as make_free_motions
[[nodiscard]] Result<validation::Robots> identified_robots(Workbench& bench);

}  // namespace mbk::thesis
