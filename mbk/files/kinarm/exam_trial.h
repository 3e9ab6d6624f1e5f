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

/// A trial as stored in the exam, before anything is computed from it.
struct ExamTrial {
  std::vector<ExamSignal> signals;
  std::vector<Event> events;
  ExamParameters parameters;  ///< its own, then those of the exam
  double frames = 0, rate_hz = 0;
  std::vector<std::string> notes;

  [[nodiscard]] const ExamSignal* find(std::string_view name) const;
};

/// Joins the parts of a trial that the recorder split and shifts the events of a part by the preceding frames. Signals
/// that are not in every part are dropped, with a note.
/// @fails  data: parts of different rates.
[[nodiscard]] Result<ExamTrial> join_parts(std::vector<ExamTrial> parts);

/// Corrects known errors, with a note each: left-arm positions named as right-arm positions, wrong torques of old
/// recorders; converts unit names to those of mbk.
void correct(ExamTrial& trial);

/// The arms whose joints were recorded.
[[nodiscard]] std::vector<Arm> arms_of(const ExamTrial& trial);

/// The hand of an arm from the geometry of the robot. Empty signals could not be computed.
struct HandOfArm {
  HandSignal position, velocity, acceleration, commanded;
  bool trusted = false;  ///< the recorded hand position does not contradict it
};

/// Computes the hand and compares it with the recorded position.   @param notes  receives findings and missing inputs
[[nodiscard]] HandOfArm hand_of(Arm arm, const ExamTrial& trial, std::vector<std::string>& notes);

/// Evidence of the trial for the sign of the force sensor; empty vectors without force.
[[nodiscard]] ForceEvidence evidence_of(Arm arm, const ExamTrial& trial, const HandOfArm& hand);

/// "Right_FS_ForceX" and "Right_FS_ForceY" if both exist, in newtons and as long as the joints.
[[nodiscard]] bool has_force(Arm arm, const ExamTrial& trial);

/// The names of the signals that hand_of and evidence_of need of an arm.
[[nodiscard]] bool tells_of_force(std::string_view name);

}  // namespace mbk::recording
