#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/kinarm/exam_parameters.h"
#include "mbk/files/kinarm/force_sign.h"
#include "mbk/files/kinarm/hand_geometry.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

inline constexpr double kRateTolerance = 1e-3;  ///< of two rates that are to be one, relative

/// A signal of a trial under its own name.
struct ExamSignal {
  std::string name, unit;
  double rate_hz = 0.0;
  Vector values;
};

/// A trial as it stands in the exam, before anything is computed from it.
struct ExamTrial {
  std::vector<ExamSignal> signals;
  std::vector<Event> events;
  ExamParameters parameters;  ///< its own, then those of the exam
  double frames = 0, rate_hz = 0;
  std::vector<std::string> notes;

  [[nodiscard]] const ExamSignal* find(std::string_view name) const;
};

/// Joins the parts of a trial that the recorder split: the events of a part come later by the frames before it.
/// Signals that not every part has are dropped, with a note.
/// @fails  data: parts of different rates.
[[nodiscard]] Result<ExamTrial> join_parts(std::vector<ExamTrial> parts);

/// Puts right what is known to be wrong or stored otherwise, with a note each: positions of the left arm under the name
/// of the right, torques of old recorders that are wrong; gives units the names that they have here.
void correct(ExamTrial& trial);

/// The arms of which joints were recorded.
[[nodiscard]] std::vector<Arm> arms_of(const ExamTrial& trial);

/// The hand of an arm by the geometry of the robot. Signals that are empty could not be computed.
struct HandOfArm {
  HandSignal position, velocity, acceleration, commanded;
  bool trusted = false;  ///< what was recorded of the hand does not contradict it
};

/// Computes the hand and compares it with what was recorded of it.   @param notes  what was found; what is missing
[[nodiscard]] HandOfArm hand_of(Arm arm, const ExamTrial& trial, std::vector<std::string>& notes);

/// What the trial says of the sign of the force sensor; empty vectors where it holds no force.
[[nodiscard]] ForceEvidence evidence_of(Arm arm, const ExamTrial& trial, const HandOfArm& hand);

/// "Right_FS_ForceX" and "Right_FS_ForceY" where both are there, in newtons and as long as the joints.
[[nodiscard]] bool has_force(Arm arm, const ExamTrial& trial);

/// The names of the signals that hand_of and evidence_of need of an arm.
[[nodiscard]] bool tells_of_force(std::string_view name);

}  // namespace mbk::recording
