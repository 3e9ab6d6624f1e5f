#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/stretch_estimate.h"
#include "mbk/model/trial/warning.h"

namespace mbk::explore {

/// A limit of stretches without EMG.
inline constexpr std::string_view kTorqueAlone = "torque alone does not show whether a muscle was active";

struct StretchOptions {
  std::optional<double> from, to;   ///< analysed positions [rad]; absent: where all stretches have constant velocity
  double inertia = 0;               ///< subtracted, times the acceleration [kg·m²]
  std::optional<double> viscosity;  ///< largest slope over speed that counts as passive [N·m·s/rad]; absent: not used
};

/// Resistance to stretches at constant velocity, as motorised tests of spasticity measure it.
///
/// A movement is a run of one sign of the velocity; its plateau is where the speed is within 10 % of its usual one, and
/// holds at least 40 % of its travel. The resisting torque of direction d is r = −d F, F of the hand on the robot.
/// The passive curve is the mean r of the slowest speed in 45 bins of angle or fewer: gravity, elasticity and offset.
/// The excess of other speeds is r less that.
///
/// Slope: mean r regressed on speed. Its interval is Student's, by the scatter between repetitions at each speed
/// (Welch–Satterthwaite); where each recording holds one speed only, their offsets count, so that the interval is by
/// recordings; with one for each speed, by the scatter about the line.
/// Verdict: velocity-dependent if the rise within the stretch (last less first third) grows with speed, beyond a
/// viscosity that doubles over the stretch: the lower limits (97.5 %) of the slopes of L − E and of L − 2E are above 0,
/// E and L the mean r of first and last third. Nothing is judged where the slope is below 0 (97.5 %), as that of no
/// passive limb is, or where the analysed positions contain acceleration. A constant viscosity has L = E, and no offset
/// changes L − E. Or, if options.viscosity is set, if the lower limit of the slope is above that. Catch: the same two
/// tests of one speed against the slowest, at 5 % over all speeds. Its angle is the start of the best-fitting curve
/// that is flat, rises along a line and is flat again, mean over repetitions; its interval includes the passive curve's
/// uncertainty by jackknife. The threshold at rest is extrapolated from three or more of them over speed (Levin &
/// Feldman 1994, Brain Res 657:23; Calota, Feldman & Levin 2008, Clin Neurophysiol 119:2329). It has no interval: from
/// torque it is biased (docs/theory/stretch.md).
/// @param trials  whole recordings of one limb, each of one or more movements
/// @fails  data: fewer than two movements with constant velocity; no common angles. usage: an empty range.
[[nodiscard]] Result<StretchEstimate> stretch(std::span<const ExplorationTrial> trials, const StretchOptions& options,
                                              std::vector<Warning>& warnings);

}  // namespace mbk::explore
