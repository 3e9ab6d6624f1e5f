#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// [1] Maximum drift of a quartz clock.
inline constexpr double kLargestDrift = 2e-4;

/// The clock of a sender between two resets, and the offsets that the recorder measured: recorder = time + value.
struct SenderClock {
  Vector stamps;         ///< [s] of the samples
  Vector times, values;  ///< [s] of the offsets
};

/// A step of one of the two clocks that offsets compare.
struct ClockStep {
  Index first = 0;    ///< sample behind it
  Index unsure = 0;   ///< samples before `first` that may be behind it too; 0 where the stamps show the step
  double size = 0.0;  ///< [s], that was added to the stamps behind it
};

/// Finds steps in clock offsets and removes them: stamps, times and values of offsets after a step are converted to the
/// clock before it.
///
/// Between two offsets the step is J = median(vᵢ − s·tᵢ | next eight) − median(vᵢ − s·tᵢ | last eight), where s is the
/// median slope within these two groups. It is taken out
/// - where the stamps of samples jump by −J at one sample, beyond their usual interval and within four standard errors,
///   and J exceeds four standard errors and 0.2 ms: the sender's clock was set there. Fewer offsets than eight on a
///   side are enough, down to one, unless stamps jump as far more often than offsets come. A jump that is larger is a
///   pause in which it was set, which stays, if J passes the test below or the pause is longer than 0.25 s;
/// - where J exceeds eight standard errors and 1 ms, with four offsets on each side, and is no change of the drift,
///   whatever the stamps say; 25 ms where there are fewer than eight offsets in all. Samples between the two offsets
///   are unsure.
///
/// @returns  steps in the order of samples
[[nodiscard]] std::vector<ClockStep> take_out_steps(SenderClock& clock);

/// The standard deviation of single offsets about a line through their neighbours, or of their differences where that
/// is less, without outliers; 0 for fewer than five, which do not tell it.
[[nodiscard]] double noise_of_offsets(const Vector& times, const Vector& values);

}  // namespace mbk::recording
