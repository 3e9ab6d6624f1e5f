#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/springs.h"

namespace mbk::calibration {

struct StretchOptions {
  double hac_lag_s = 1.0;    ///< correlation time of the residual for the standard errors [s] ≥ 0
  double hook_share = 0.01;  ///< share of the compliance that the hooks may still add in the straight part, in (0, 1)
};

/// The constant of an extension spring from a slow stretch along one axis, the machine reading
///   F = −k (x − x₀) beyond the hooks                                      (Dyck 2013, §5.3.1)
/// with x the position and F the reaction, what the spring exerts on the machine. The tension is T = |F| on the side of
/// the stretch, and s = ±x grows with it.
///
/// At first the hooks bend, so the curve is softer there than further on. They are put in series with the spring as a
/// contact that gives by s_h in all and closes with the load:
///   s = s₀ + T/k + s_h (1 − exp(−T/F_h)),   ds/dT = 1/k + (s_h/F_h) exp(−T/F_h)
/// Written as s(T) it needs no root to state; it is fitted to T(s), since the noise is in the force and the position is
/// known much better. Levenberg–Marquardt from the best of a grid over F_h, for each of which the rest is linear.
///
/// The hooks count as seen where s_h is above 4 of its standard errors and the fit's error falls. Then the straight
/// part is where (s_h/F_h) exp(−T/F_h) ≤ hook_share/k, else it is everything. k is the slope of a line through the
/// straight part; standard errors after Newey and West, widened for the length of the data.
/// @param time [s], increasing    @param position [m]    @param reaction [N]; as long as `time`
/// @fails  data: lengths differ; fewer than 20 samples; a value is not finite; time does not increase; the position
/// does not change. not usable: the force grows with the position, so that its sign is that of the other side; less
/// than a third of the stretch is straight; a line explains less than 90 % of the tension's variance.
[[nodiscard]] Result<SpringConstant> fit_spring_constant(const Vector& time, const Vector& position,
                                                         const Vector& reaction, const StretchOptions& options = {});

/// The same of a recording of one axis, with position and reaction.
/// @fails  data: one of them is not there, or is an angle or a moment. As fit_spring_constant; the message names the
/// file.
[[nodiscard]] Result<SpringConstant> spring_constant_of(const Recording& recording, const StretchOptions& options = {});

/// T of a hook fit at the stretch s [N]: the root of s = s₀ + T/k + s_h (1 − exp(−T/F_h)). Below s₀ it goes on as
/// a line with the slope at s₀.
[[nodiscard]] double hook_tension(const HookFit& fit, double s);

}  // namespace mbk::calibration
