#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The samples of a channel that are not measurements.
struct Stale {
  Updates updates;
  std::vector<bool> samples;  ///< true for a sample that is not; empty if all are measurements
};

/// Finds repeated values that a measured signal would not have.
///
/// A quantised signal (an encoder, a converter) legitimately repeats its value: it rests, or moves by less than a step
/// per sample, and then changes by one step. So a repeat counts only if the changes around it are large compared with
/// the small changes of the channel (their 5 % quantile) and have more sizes than one or two encoder steps; there a
/// legitimate signal repeats in at most 7 % of its samples.
///   held         the changes fall on every Nth sample (95 % of them), or N samples apart to within a sample or 15 %,
///                and differ in size: a ramp in equal steps changes regularly, too, but always by one step
///   repeated     more than 12 % of the samples among moving ones repeat
///   frozen       runs of five samples and more, in noise or before a jump that catches up, 1 % of the samples in all
///   placeholder  single values far from both neighbours, at least five times the same, wherever the signal is
/// A value at which a channel rests repeatedly (no contact: 0 N) and its extremes are never reported.
/// @param values  of one channel; NaN is ignored    @returns Staleness::none for less than 200 samples or 40 changes
[[nodiscard]] Stale find_stale(const Eigen::Ref<const Vector>& values);

}  // namespace mbk::recording
