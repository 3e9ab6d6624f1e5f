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
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "mbk/simulate/laboratory/ready_scenarios.h"
#include "mbk/simulate/laboratory/record_elbow.h"
#include "mbk/simulate/laboratory/simulated_experiment.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/compliant_grip.h"
#include "mbk/simulate/participant/one_axis_joint.h"
#include "mbk/simulate/participant/spatial_arm.h"
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

/// An empty handle.
struct NoLoad {};

/// Possible loads at the handle of a robot with this number of axes.
template <int Axes>
using LoadPlan =
    std::conditional_t<Axes == 1, std::variant<participant::OneAxisJoint::Options>,
                       std::variant<NoLoad, participant::ArmOptions, participant::ToneRobot::Options, RigPlan>>;

/// The apparatus and the load of a trial.
template <int Axes>
struct SimulatedTrial {
  typename ClosedLoop<Axes>::Options robot;
  AxisVector<Axes> home = AxisVector<Axes>::Zero();
  ModeOf<Axes> control;
  LoadPlan<Axes> load;
  std::optional<participant::GripOptions> grip;  ///< of an arm; absent: the hand is rigidly attached to the handle
  SensorOptions<Axes> sensors;
};
using PlanarTrial = SimulatedTrial<2>;
using OneAxisTrial = SimulatedTrial<1>;

/// A hand in space that follows the schedule exactly: no robot, no servo.
struct SpaceTrial {
  Eigen::Vector3d home = {0.3, -0.05, 0.0};                               ///< about which the schedule moves [m]
  std::variant<impedance::Model, participant::SpatialArm::Options> limb;  ///< a constant impedance, or an arm
  PrescribedMotionSensors sensors;
};

/// All inputs of one simulated recording.
struct Scenario : protocol::TrialPlan {
  std::variant<PlanarTrial, OneAxisTrial, SpaceTrial, ElbowTrial> trial;
};

/// The trials that a scenario file describes, in its order. Every key has its unit; unknown keys are errors. The
/// sections [session], [safety], [person] and [device] of an experiment are allowed and ignored.
/// @param file  its name in messages
/// @fails  data: with file, line, key, value and the allowed values.
[[nodiscard]] Result<std::vector<Scenario>> read_scenarios(std::string_view text, const std::filesystem::path& file);

/// One trial from its sections; the caller calls finish() of the document. Its name and protocol remain empty.
[[nodiscard]] Scenario read_scenario(const config::Section& root);

/// Metadata of the scenario in a recording: truth_scenario, truth_trial, truth_condition, truth_seed and
/// truth_note; and for a two-link arm the measurable dimensions: shoulder_x_m, shoulder_y_m,
/// upper_arm_m, forearm_m, elbow.
[[nodiscard]] std::map<std::string, std::string> scenario_metadata(const Scenario& scenario);

/// Shown with every result of a participant with voluntary position or force control.
inline constexpr const char* kTunedGains =
    "the gains of the participant's voluntary control were chosen, not fitted to data from people";

struct SimulateOptions {
  std::function<void(double fraction)> progress;   ///< of this recording
  std::function<void(const TrueState<2>&)> watch;  ///< of a planar trial
};

/// Runs a scenario. The same scenario and seed give an identical recording. Adds scenario_metadata to the metadata of
/// `perform`.
/// @fails  usage: control and perturbation refer to different quantities; as perturbation::make_schedule and `perform`.
[[nodiscard]] Result<Performance> simulate(const Scenario& scenario, const SimulateOptions& options = {});

/// The recording without data that only a simulation has: the true values, and the name and description of the
/// scenario.
[[nodiscard]] Recording without_truth(Recording recording);

}  // namespace mbk::laboratory
