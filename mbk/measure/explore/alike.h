#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::explore {

/// Checks that trials to be averaged have the same signals at the same rate.
/// @fails  no trial; different numbers of inputs or outputs; different sample times: the message names the file.
[[nodiscard]] Result<void> check_alike(std::span<const ExplorationTrial> trials);

/// Whether every trial has a reference.
[[nodiscard]] bool all_have_reference(std::span<const ExplorationTrial> trials);

}  // namespace mbk::explore
