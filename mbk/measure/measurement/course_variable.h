#pragma once

#include <optional>
#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/time_course.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::measurement {

/// The word for onsets of the reference, instead of the name of an event.
inline constexpr const char* kAlignOnReference = "reference";

/// The variable over which M, B and K are followed.
/// - Neither: time since the first sample of each recording.
/// - `scheduled`: the channel that the trials carry.
/// - `align`: time since events of that name, or since onsets of the reference (reference_onsets.h), from at most 1 s
///   before each to shortly before the next, limited to the range that every repetition covers.
/// @fails  no event of that name (existing ones are named); no onset of the reference; events within 0.5 s of each
/// other
[[nodiscard]] Result<explore::CourseVariable> course_variable(std::span<const ExplorationTrial> trials, bool scheduled,
                                                              const std::optional<std::string>& align);

/// Highest frequency at which the limb was moved, over all trials [Hz].
[[nodiscard]] double moved_up_to(std::span<const ExplorationTrial> trials);

}  // namespace mbk::measurement
