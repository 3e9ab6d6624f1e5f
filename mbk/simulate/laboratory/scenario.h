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

#include "mbk/model/perturbation/optimal_power.h"
#include "mbk/model/perturbation/random_binary.h"
#include "mbk/model/perturbation/underdamped_pulse.h"
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

/// Sums of sines, one for each axis or joint, with phases and power by a stated rule.
struct MultisinePlan {
  enum class Phases { random, schroeder, low_crest };
  /// Lines and phases of each axis its own, lines in turn to one and the other, or the first or second of a pair of
  /// experiments that differ in the second axis's sign (axis_pair.h).
  enum class Axes { independent, interleaved, hadamard_first, hadamard_second };
  perturbation::Quantity quantity = perturbation::Quantity::position;
  perturbation::Space space = perturbation::Space::joint;
  double peak = 0.034906585039886591;  ///< of each axis: ±2° by default [rad, m, N or N·m]
  double period = 10.0;                ///< [s]
  std::vector<int> harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29};
  Phases phases = Phases::random;
  std::optional<perturbation::OptimalPowerOptions> optimal_power;  ///< absent: the same at every line
  Axes axes = Axes::independent;
  double duration = 62.1;  ///< [s]
  double moving_in = 5.0;  ///< from rest [s]
};

/// Underdamped pulses in random order.
struct PulsePlan {
  perturbation::Quantity quantity = perturbation::Quantity::position;
  perturbation::Space space = perturbation::Space::hand;
  perturbation::PulseSchedule::Options pulses;
  double tail = 3.0;  ///< recorded after the last pulse [s]
};

/// A filtered random binary sequence along one line.
struct RandomBinaryPlan {
  perturbation::Quantity quantity = perturbation::Quantity::force;
  perturbation::Space space = perturbation::Space::hand;
  perturbation::RandomBinaryOptions sequence;
  double angle = 1.5707963267948966;  ///< of the line from +x [rad]
  double duration = 62.1;             ///< [s]
};

/// Nothing is commanded.
struct RestPlan {
  double duration = 10.0;  ///< [s]
};

struct PerturbationPlan {
  std::variant<RestPlan, MultisinePlan, PulsePlan, RandomBinaryPlan> kind = MultisinePlan{};
  perturbation::Limits limits;  ///< what the schedule must keep
};

/// The schedule that a plan gives with a seed.
/// @fails  usage: as perturbation's; a limit is broken.
[[nodiscard]] Result<perturbation::Schedule> make_schedule(const PerturbationPlan& plan, std::uint64_t seed);

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
  PerturbationPlan perturbation;
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
/// @fails  usage: control and perturbation speak of different quantities; as make_schedule and both `perform`.
[[nodiscard]] Result<Performance> simulate(const Scenario& scenario, const SimulateOptions& options = {});

/// The recording without what only a simulation can know: the truth, and the scenario's name and words.
[[nodiscard]] Recording without_truth(Recording recording);

}  // namespace mbk::laboratory
