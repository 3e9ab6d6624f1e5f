#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The samples of a channel that are no measurements.
struct Stale {
  Updates updates;
  std::vector<bool> samples;  ///< true where a sample is none; empty where all are measurements
};

/// Finds values that repeat where a measured signal would not repeat them.
///
/// A signal in steps (an encoder, a converter) repeats its value honestly: it rests, or moves by less than a step in a
/// sample, and then it changes by one step. So a repeat counts only where the changes around it are large against the
/// small changes of the channel (their 5 % quantile) and take so many sizes that they are no steps of an encoder or
/// two, where an honest signal repeats in 7 % of its samples at most.
///   held         the changes fall on every Nth sample (95 % of them), or N samples apart to within a sample or 15 %,
///                and differ in size: a ramp in equal steps changes regularly, too, but always by one step
///   repeated     more than 12 % of the samples among moving ones repeat
///   frozen       runs of five samples and more, in noise or before a jump that catches up, 1 % of the samples in all
///   placeholder  single values far from both neighbours, at least five times the same, wherever the signal is
/// A value at which a channel rests again and again (no contact: 0 N) and its extremes are never accused.
/// @param values  of one channel; NaN is no value    @returns Staleness::none for less than 200 samples or 40 changes
[[nodiscard]] Stale find_stale(const Eigen::Ref<const Vector>& values);

}  // namespace mbk::recording
