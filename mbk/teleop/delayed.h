#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {

struct DelayedStability {
  AbsoluteStability stability;
  FrequencyGrid grid;  ///< bounded; high is infinite if all frequencies above the last point are covered
};

/// The conditions of llewellyn() for a teleoperator with its true delays, D₁ D₂ = e^(−jωT), in double.
///
/// All conditions depend on the sum T of both delays alone. With z = N/(s δ), δ = (1 + C₆)(1 + C₅) − D₁D₂ C₂C₃, and
/// multiplied by positive factors, they are sums of products of polynomials of ω, cos ωT and sin ωT/(ωT), which are
/// evaluated in interval arithmetic on cells of the frequency axis. A cell is halved until its bounds show that the
/// condition holds or is violated in all of it, so that nothing between two frequencies is missed, except violations of
/// less than kDelayTolerance of the sum of the terms' sizes. Above a frequency at which the conditions hold for every
/// phase of the delay they hold at all.
/// Conditions on poles are decided as by llewellyn_on_grid().
/// @param a  shortage of passivity of the termination at `port` [N·s/m]
/// @fails  not usable: as llewellyn_on_grid(); there is a cell that remains undecided.
[[nodiscard]] Result<DelayedStability> llewellyn_with_delay(const Teleoperator& teleoperator, Port port = Port::one,
                                                            const Rational& a = 0);

inline constexpr double kDelayTolerance = 1e-6;

/// The largest shortage, by the same decisions: at_least is stable, and more than at_most violates a condition at a
/// frequency that was evaluated.
/// @fails  as above
[[nodiscard]] Result<LargestShortage> largest_shortage_with_delay(const Teleoperator& teleoperator, Port port);

}  // namespace mbk::teleop
