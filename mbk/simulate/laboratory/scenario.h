#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mbk/model/perturbation/schedule_plan.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/springs.h"
#include "mbk/simulate/laboratory/one_axis_experiment.h"
#include "mbk/simulate/laboratory/one_axis_sensors.h"
#include "mbk/simulate/laboratory/planar_experiment.h"
#include "mbk/simulate/laboratory/ready_scenarios.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/one_axis_joint.h"
#include "mbk/simulate/participant/tone_robot.h"

namespace mbk::config {
class Section;
}

namespace mbk::laboratory {

/// A payload held by springs: a linear field, or an array of real springs on the disc of the handle.
struct RigPlan {
  double mass = 0.0;                      ///< payload [kg]
  Matrix2d damping = Matrix2d::Zero();    ///< dampers [N·s/m]
  Matrix2d stiffness = Matrix2d::Zero();  ///< of the linear field [N/m]
  Vector2d equilibrium = {0.3, -0.05};    ///< of the linear field [m]
  std::vector<Spring> springs;            ///< where there are any, the linear field is not used
};

/// Nothing at the handle.
struct NoLoad {};

/// A trial of the planar robot.
struct PlanarTrial {
  ClosedLoop::Options robot;
  Vector2d home = {0.3, -0.05};
  control::Mode control;
  std::variant<NoLoad, participant::ArmOptions, participant::ToneRobot::Options, RigPlan> load;
  SensorOptions sensors;
};

/// A trial of a one-axis machine.
struct OneAxisTrial {
  OneAxisLoop::Machine machine;
  perturbation::Quantity controlled = perturbation::Quantity::position;  ///< what the schedule must command
  OneAxisLoop::Servo servo;                                              ///< where that is the position
  participant::OneAxisJoint::Options joint;
  OneAxisSensorOptions sensors;
};

/// Everything that one simulated recording is made of.
struct Scenario {
  std::string file_name;   ///< without its folder and ending
  std::string trial_name;  ///< of the [[trial]]; empty where the file has none
  std::string condition;   ///< in words
  std::variant<PlanarTrial, OneAxisTrial> trial;
  perturbation::Plan perturbation;
  Hertz rate{1000.0};
  std::uint64_t seed = 1;            ///< of phases, decisions and noise
  Readers readers = Readers::owner;  ///< of the recording
};

/// The trials that a scenario file describes, in its order. Every key has its unit; unknown keys are errors. The
/// sections [session], [safety], [person] and [device] of an experiment may stand in it and are not looked at.
/// @param file  how messages call it
/// @fails  data: with file, line, key, value and what is allowed.
[[nodiscard]] Result<std::vector<Scenario>> read_scenarios(std::string_view text, const std::filesystem::path& file);

/// One trial out of its sections; who asks calls finish() of the document. file_name and trial_name stay empty.
[[nodiscard]] Scenario read_scenario(const config::Section& root);

/// What a recording of the scenario says of it: truth_scenario, truth_trial, truth_condition, truth_seed and
/// truth_note; and of an arm of two links what anyone in the room could measure: shoulder_x_m, shoulder_y_m,
/// upper_arm_m, forearm_m, elbow.
[[nodiscard]] std::map<std::string, std::string> scenario_metadata(const Scenario& scenario);

/// Said wherever something is shown that a participant who corrects position or force had a part in.
inline constexpr const char* kTunedGains = "the gains of the participant's will are tuned, not fitted to anyone";

struct SimulateOptions {
  std::function<void(double fraction)> progress;  ///< of this recording
  std::function<void(const TrueState&)> watch;    ///< of a planar trial
};

/// Runs a scenario. The same scenario and seed give the same recording, to the bit. To what `perform` writes into the
/// metadata comes scenario_metadata.
/// @fails  usage: control and perturbation speak of different quantities; as perturbation::make_schedule and both
/// `perform`.
[[nodiscard]] Result<Performance> simulate(const Scenario& scenario, const SimulateOptions& options = {});

/// The recording without what only a simulation can know: the truth, and the scenario's name and words.
[[nodiscard]] Recording without_truth(Recording recording);

}  // namespace mbk::laboratory
