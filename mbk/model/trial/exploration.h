#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/model/trial/after_onset_estimate.h"
#include "mbk/model/trial/emg_estimate.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/reach_stiffness.h"
#include "mbk/model/trial/stretch_estimate.h"
#include "mbk/model/trial/time_course_estimate.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// Analyses of recordings.
enum class ExplorationPart {
  frequency_response,
  impulse_response,
  reflex,
  time_course,
  ramp_and_hold,
  servo_displacement,
  emg,     ///< only if requested
  stretch  ///< only if requested
};

[[nodiscard]] constexpr auto word_table(ExplorationPart) {
  using enum ExplorationPart;
  return std::to_array<Word<ExplorationPart>>({{frequency_response, "frequency-response"},
                                               {impulse_response, "impulse-response"},
                                               {reflex, "reflex"},
                                               {time_course, "time-course"},
                                               {ramp_and_hold, "ramp-and-hold"},
                                               {servo_displacement, "servo-displacement"},
                                               {emg, "emg"},
                                               {stretch, "stretch"}});
}

/// An explored recording.
struct ExploredRecording {
  SourceFile source;
  double duration_s = 0, rate_hz = 0;
  double from_s = 0, to_s = 0;  ///< the part that was explored
  std::string window_rule;
};

/// Results on a limb without a model of it. A part is present if it was requested and the data allow it; the notes
/// explain missing parts.
struct Exploration {
  int axes = 2;
  Motion motion = Motion::translation;
  bool other_signals = false;  ///< the response is not that of force to motion, but from one channel to another
  std::vector<ExploredRecording> recordings;
  std::optional<FrequencyResponseEstimate> frequency_response;
  std::optional<ImpulseResponseEstimate> impulse_response;
  std::optional<ParallelCascadeEstimate> parallel_cascade;
  std::optional<PlateauStiffness> plateau_stiffness;
  std::optional<ReachStiffness> reach_stiffness;
  std::optional<TimeCourseEstimate> time_course;
  std::optional<AfterOnsetEstimate> after_onset;  ///< only if requested
  std::optional<EmgEstimate> emg;                 ///< only if requested
  std::optional<StretchEstimate> stretch;         ///< only if requested
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  bool usable = true;
};

}  // namespace mbk
