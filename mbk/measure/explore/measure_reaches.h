#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/reach_stiffness.h"
#include "mbk/model/trial/warning.h"

namespace mbk::explore {

struct ReachOptions {
  std::string trigger = "trigger";     ///< name of the event
  std::optional<double> from_s, to_s;  ///< of the window, after the trigger [s]; absent: 0.14 and 0.2
};

/// Stiffness of a hand that reaches, of recordings of one or more reaches each. Every event options.trigger is one
/// reach; its reference is the displacement that was commanded relative to the predicted way, and rests where the hand
/// was let go on undisturbed. A reach is displaced where the mean reference over the window differs from that just
/// before the trigger by a tenth, or more, of the largest such difference.
/// servo_displacement_stiffness is made twice: by each reach's own past, and by the mean of the undisturbed reaches.
/// @param warnings  warnings are appended
/// @fails  data: no such event; no reference of a position; fewer than 8 undisturbed reaches; as
/// servo_displacement_stiffness.
[[nodiscard]] Result<ReachStiffness> reach_stiffness(std::span<const ExplorationTrial> trials,
                                                     const ReachOptions& options, std::vector<Warning>& warnings);

}  // namespace mbk::explore
