#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::identify {

/// The part of `signal` that a finite impulse response explains from past and present of `reference`, including its
/// mean: the noise-free part of a signal in a loop. The response is as long as a twentieth of the samples, at most 300.
/// Each half of the samples uses the response estimated on the other half: its own would fit some of the noise of that
/// half and reintroduce the bias of many weak instruments.
[[nodiscard]] Vector explained_by_past(const Vector& reference, const Vector& signal);

}  // namespace mbk::identify
