#pragma once

#include <vector>

#include "mbk/base/core/columns.h"
#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/preprocess/windows.h"

namespace mbk::preprocess {

/// The frequencies at which the limb was moved.
struct Band {
  Hertz low, high;
};

/// Excited band of a motion: `low` is where 5 % of the power of the position lies below, `high` where 95 % of the
/// power of the velocity does, looking up to a tenth of the sample rate. For lines of equal amplitude that is the
/// lowest and the highest line.
/// @param motion N×n, reference or hand position; each cut must lie inside it    @fails a cut is shorter than 8
/// samples.
[[nodiscard]] Result<Band> excited_band(const Columns& motion, const std::vector<Cut>& cuts, Hertz sample_rate);

/// Where 95 % of a signal's own power lies below, looking up to a tenth of the sample rate.
/// @fails  as excited_band.
[[nodiscard]] Result<Hertz> band_top(const Columns& signals, const std::vector<Cut>& cuts, Hertz sample_rate);

/// Where a motion sinks into noise: the spectral density of its acceleration, 1 Hz fine, first falls below twice its
/// floor, which is the median of the lines from the top of the excited band to `limit`. There signal and noise weigh
/// the same.
/// @param position N, of one joint or axis    @returns `limit` where fewer than five lines lie between, or none is
/// below
/// @fails  as excited_band.
[[nodiscard]] Result<Hertz> motion_top(const Vector& position, const std::vector<Cut>& cuts, Hertz sample_rate,
                                       Hertz limit);

/// Forward and backward, the low-pass passes this fraction of its cutoff with a gain of 0.994.
inline constexpr double kPassed = 0.6;

}  // namespace mbk::preprocess
