#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::identify {

/// What a finite impulse response makes of the past and present of `reference` in `signal`, its mean included: the part
/// of a signal in a loop that its noise has no share in. As long as a twentieth of the samples, at most 300. The
/// response for each half of the samples is that of the other half: with its own, the response would follow the noise
/// of that very half a little, and the bias of instruments that are many and weak would come back.
[[nodiscard]] Vector explained_by_past(const Vector& reference, const Vector& signal);

}  // namespace mbk::identify
