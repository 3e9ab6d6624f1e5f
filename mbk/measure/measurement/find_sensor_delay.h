#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/measured_delay.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// For a known mass moved on the handle, without a hand, the force sensor should read
///   −F(t + τ) = m ẍ(t) + c
/// The force is shifted by τ; m, c and the coefficient −m Δτ of the jerk are found by least squares; τ is corrected by
/// Δτ until it converges (Gauss & Newton). Standard errors are those of Newey & West. Both axes share τ and m.
/// @param mass  beyond the force sensor, including the handle [kg] > 0
/// @returns not usable, with reasons, if the mass explains less than 95 % of the force, the mass found differs from the
/// stated one (by more than 5 % and its interval), or the delay is uncertain by more than ±2 ms.
/// @fails  as preprocess::prepare; usage: the mass is not above zero; data: it does not move
[[nodiscard]] Result<MeasuredDelay> find_sensor_delay(const Recording& recording, double mass,
                                                      const preprocess::Options& options);

}  // namespace mbk::measurement
