#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"
#include "mbk/model/trial/impulse_response_estimate.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// A recording that was explored.
struct ExploredRecording {
  SourceFile source;
  double duration_s = 0, rate_hz = 0;
  double from_s = 0, to_s = 0;  ///< the part that was explored
  std::string window_rule;
};

/// What recordings say of a limb without a model of it. Each part is there where it was asked for and the data allow
/// it; why one is absent stands in the notes.
struct Exploration {
  int axes = 2;
  Motion motion = Motion::translation;
  std::vector<ExploredRecording> recordings;
  std::optional<FrequencyResponseEstimate> frequency_response;
  std::optional<ImpulseResponseEstimate> impulse_response;
  std::optional<ParallelCascadeEstimate> parallel_cascade;
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  bool usable = true;
};

}  // namespace mbk
