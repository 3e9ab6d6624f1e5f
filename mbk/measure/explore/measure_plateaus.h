#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/reference_ramps.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/plateau_stiffness.h"
#include "mbk/model/trial/warning.h"

namespace mbk::explore {

struct PlateauOptions {
  std::optional<double> from_s, to_s;  ///< of the window, after the onset [s]; absent: by the rule below
  [[nodiscard]] bool asked() const { return from_s || to_s; }
};

/// The ramps of a trial that displace the hand: none if the reference is a force or was not recorded. Steps are
/// included on request.
[[nodiscard]] std::vector<ReferenceRamp> displacing_ramps(const ExplorationTrial& trial, bool steps_too = false);

/// Whether the reference consists of ramps and holds, enough to estimate a stiffness.
[[nodiscard]] bool is_ramp_and_hold(const ExplorationTrial& trial, const PlateauOptions& options);

/// Stiffness from the mean restoring force on plateaus (Mussa-Ivaldi, Hogan & Bizzi 1985): for each ramp place and
/// force, averaged over the window, minus their averages over the 0.3 s before the onset, and regress_stiffness of
/// them. By default the window ends 0.3 s after the onset, or with the hold where that is shorter, and begins as soon
/// after the ramp as what inertia and damping add is below 1 % of K, but not later than 60 ms before its end. The mean
/// force of inertia and damping over a window of length T is exactly M Δẋ/T + B Δx/T, with Δ from its begin to its end:
/// this contribution is reported for a limb with stated B/K and M/K (PlateauStiffness).
/// @param trials  whole recordings, with the rest before the first ramp
/// @fails  usage: a window of fewer than four samples, or that begins before the onset. data: no ramp with a hold and
/// a rest that are long enough; as regress_stiffness.
[[nodiscard]] Result<PlateauStiffness> plateau_stiffness(std::span<const ExplorationTrial> trials,
                                                         const PlateauOptions& options = {});

/// What the user must know of it, and whether it is usable: the hand at rest on the window, the displacement reached,
/// the interval narrow enough, K the same over all directions.
[[nodiscard]] std::vector<Warning> judge_plateaus(PlateauStiffness& found);

}  // namespace mbk::explore
