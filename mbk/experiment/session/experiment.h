#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/experiment/session/device_plan.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::session {

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

/// Limits that the file does not give, and that therefore follow from what a trial of positions plans (make_plan).
struct LimitsFromPlan {
  bool speed = false, excursion = false, tracking = false;
};

/// One trial of an experiment: which robot it runs on, how that is driven, what the gate allows, and for a simulated
/// robot who holds it.
struct Trial {
  std::string name;               ///< of the [[trial]]; empty where the file has none
  laboratory::Scenario scenario;  ///< planar; its robot, control, perturbation and sensors
  control::SequenceOptions sequence;
  safety::Limits limits;
  LimitsFromPlan from_plan;
  DevicePlan device;
  Person person;
  std::string protocol;  ///< name of the file without folder and ending

  [[nodiscard]] const laboratory::PlanarTrial& planar() const {
    return std::get<laboratory::PlanarTrial>(scenario.trial);
  }
};

/// The trials that an experiment file describes, in its order. It has the sections of a scenario and besides
///   [session]  soft_start_s, move_speed_mm_per_s, settle_s, handover_s
///   [safety]   a key for each member of safety::Limits
///   [device]   which robot: a simulated one, or one behind UDP or a plug-in, and how it is wired
///   [person]   number, age_years, handedness, height_cm, weight_kg, upper_arm_mm, forearm_mm, consent, withdrawn
/// Every one of them may be left out, so that each planar scenario is an experiment too.
/// @param file  how messages call it
/// @fails  data: with file, line, key, value and what is allowed; a one-axis machine; a person's name.
[[nodiscard]] Result<std::vector<Trial>> read_experiment(std::string_view text, const std::filesystem::path& file);

/// What a recording says of the person: participant, age_years, handedness, …; only what is known.
[[nodiscard]] std::map<std::string, std::string> metadata_of(const Person& person);

}  // namespace mbk::session
