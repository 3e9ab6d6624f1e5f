#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/config/document.h"
#include "mbk/base/core/result.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/protocol/device_plan.h"
#include "mbk/experiment/protocol/trial_plan.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/model/robot/dynamics.h"

namespace mbk::protocol {

/// Who sits at the robot: a number, never a name. Empty texts and zeros are not known, and not recorded.
struct Person {
  int number = 0;
  double age_years = 0.0;
  std::string handedness;  ///< "right", "left", "both"
  double height = 0.0;     ///< [m]
  double weight = 0.0;     ///< [kg]
  double upper_arm = 0.0;  ///< [m]
  double forearm = 0.0;    ///< [m]
  std::string consent;     ///< reference of the consent form
  bool withdrawn = false;  ///< the person has withdrawn: no further trial, and the data are not to be used
};

/// Limits that the file does not give, and that therefore follow from what a trial of positions plans
/// (session::make_plan).
struct LimitsFromPlan {
  bool speed = false, excursion = false, tracking = false;
};

struct Trial;

/// What stands in for the robot where there is none: a simulated one, with somebody at its handle.
class Simulation {
 public:
  Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  virtual ~Simulation() = default;

  /// The robot at rest at the trial's home, with the seed and the perturbation of the trial as it is now.
  /// @fails  usage: what is simulated cannot be.
  [[nodiscard]] virtual Result<std::unique_ptr<device::Device>> robot(const Trial& trial) const = 0;

  /// What a recording of it says besides.
  [[nodiscard]] virtual std::map<std::string, std::string> metadata(const Trial& trial) const = 0;
};

/// One trial of an experiment with a planar robot: what is done, which robot it runs on, how that is driven, and what
/// the gate allows.
struct Trial : TrialPlan {
  robot::PlanarRobot robot;
  double handle_mass = 0.0;             ///< beyond the force sensor [kg]
  Eigen::Vector2d home = {0.3, -0.05};  ///< of the hand, base frame [m]
  control::Mode control;
  control::SequenceOptions sequence;
  safety::Limits limits;
  LimitsFromPlan from_plan;
  DevicePlan device;
  Person person;
  /// Keys of [robot] that the file does not give though its robot is a real one: they are those of the thesis's robot.
  std::vector<std::string> assumed;
  std::string file_sha256;                       ///< of the experiment file, in hexadecimal digits
  std::shared_ptr<const Simulation> simulation;  ///< null: nobody told what could be simulated
};

/// Makes the simulation of a trial from the sections that describe it ([participant], [rig], [sensors], …);
/// laboratory::read_simulation is one.
using ReadSimulation =
    std::function<Result<std::shared_ptr<const Simulation>>(const config::Section& root, const Trial& trial)>;

/// The trials that an experiment file describes, in its order. It has the sections of a scenario and besides
///   [session]  soft_start_s, move_speed_mm_per_s, settle_s, handover_s
///   [safety]   a key for each member of safety::Limits
///   [device]   which robot: a simulated one, or one behind UDP or a plug-in, and how it is wired
///   [person]   number, age_years, handedness, height_cm, weight_kg, upper_arm_mm, forearm_mm, consent, withdrawn
/// Every one of them may be left out, so that each planar scenario is an experiment too.
/// @param file  how messages call it
/// @param simulation  without it the sections that describe a simulation are not looked at
/// @fails  data: with file, line, key, value and what is allowed; a one-axis machine; a person's name; a
///         real robot that no [robot] describes.
[[nodiscard]] Result<std::vector<Trial>> read_experiment(std::string_view text, const std::filesystem::path& file,
                                                         const ReadSimulation& simulation = {});

/// "[robot] does not give d1_mm, d2_mm: those of the robot of Dyck (2013) are assumed"; "" where nothing is.
[[nodiscard]] std::string assumptions_text(const Trial& trial);

/// The robot that a trial runs on.
/// @fails  usage: a simulated one, and nobody told how. As Simulation::robot, UdpDevice::create, PluginDevice::create.
[[nodiscard]] Result<std::unique_ptr<device::Device>> make_device(const Trial& trial);

/// What a recording says of the person: participant, age_years, handedness, …; only what is known.
[[nodiscard]] std::map<std::string, std::string> metadata_of(const Person& person);

}  // namespace mbk::protocol
