#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/measured_delay.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// A known mass on the handle and nothing else, moved about: all that the force sensor should read is
///   −F(t + τ) = m ẍ(t) + c
/// The force is moved by τ, m and c are found by least squares with the jerk beside them, and τ is corrected by what
/// the jerk explains, −m Δτ, until it stays (Gauss & Newton). Standard errors are those of Newey & West. Both axes
/// share τ and m.
/// @param mass  beyond the force sensor, the handle's own included [kg] > 0
/// @returns not usable, with the reasons, where that mass does not explain 95 % of the force, the mass found is not the
/// one stated (within 5 % and its interval), or the delay is known no better than to ±2 ms.
/// @fails  as preprocess::prepare; usage: the mass is not above zero; data: it does not move
[[nodiscard]] Result<MeasuredDelay> find_sensor_delay(const Recording& recording, double mass,
                                                      const preprocess::Options& options);

}  // namespace mbk::measurement
