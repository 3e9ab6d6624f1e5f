#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "mbk/experiment/protocol/trial_plan.h"
#include "mbk/model/trial/springs.h"
#include "mbk/simulate/laboratory/ready_scenarios.h"
#include "mbk/simulate/laboratory/simulated_experiment.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/compliant_grip.h"
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

/// What may hang at the handle of a robot of so many axes.
template <int Axes>
using LoadPlan =
    std::conditional_t<Axes == 1, std::variant<participant::OneAxisJoint::Options>,
                       std::variant<NoLoad, participant::ArmOptions, participant::ToneRobot::Options, RigPlan>>;

/// The apparatus of a trial, and who holds it.
template <int Axes>
struct SimulatedTrial {
  typename ClosedLoop<Axes>::Options robot;
  AxisVector<Axes> home = AxisVector<Axes>::Zero();
  ModeOf<Axes> control;
  LoadPlan<Axes> load;
  std::optional<participant::GripOptions> grip;  ///< of an arm; absent: hand and handle are one
  SensorOptions<Axes> sensors;
};
using PlanarTrial = SimulatedTrial<2>;
using OneAxisTrial = SimulatedTrial<1>;

/// Everything that one simulated recording is made of.
struct Scenario : protocol::TrialPlan {
  std::variant<PlanarTrial, OneAxisTrial> trial;
};

/// The trials that a scenario file describes, in its order. Every key has its unit; unknown keys are errors. The
/// sections [session], [safety], [person] and [device] of an experiment may stand in it and are not looked at.
/// @param file  how messages call it
/// @fails  data: with file, line, key, value and what is allowed.
[[nodiscard]] Result<std::vector<Scenario>> read_scenarios(std::string_view text, const std::filesystem::path& file);

/// One trial out of its sections; who asks calls finish() of the document. Its name and protocol stay empty.
[[nodiscard]] Scenario read_scenario(const config::Section& root);

/// What a recording of the scenario says of it: truth_scenario, truth_trial, truth_condition, truth_seed and
/// truth_note; and of an arm of two links what anyone in the room could measure: shoulder_x_m, shoulder_y_m,
/// upper_arm_m, forearm_m, elbow.
[[nodiscard]] std::map<std::string, std::string> scenario_metadata(const Scenario& scenario);

/// Said wherever something is shown that a participant who corrects position or force had a part in.
inline constexpr const char* kTunedGains =
    "the gains of the participant's voluntary control are tuned, not fitted to anyone";

struct SimulateOptions {
  std::function<void(double fraction)> progress;   ///< of this recording
  std::function<void(const TrueState<2>&)> watch;  ///< of a planar trial
};

/// Runs a scenario. The same scenario and seed give the same recording, to the bit. To what `perform` writes into the
/// metadata comes scenario_metadata.
/// @fails  usage: control and perturbation speak of different quantities; as perturbation::make_schedule and `perform`.
[[nodiscard]] Result<Performance> simulate(const Scenario& scenario, const SimulateOptions& options = {});

/// The recording without what only a simulation can know: the truth, and the scenario's name and words.
[[nodiscard]] Recording without_truth(Recording recording);

}  // namespace mbk::laboratory
