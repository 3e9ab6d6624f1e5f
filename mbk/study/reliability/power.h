#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/reliability/comparison.h"

namespace mbk::reliability {

/// Chance that a two-sided t test at `level` finds a standardised difference d, by the noncentral t:
///   P(|T| > t(1 − α/2; ν)),  T ~ t(ν, d√ñ);  unpaired ν = 2n − 2, ñ = n/2; paired ν = n − 1, ñ = n
/// @param people ≥ 2, in each group, or pairs
[[nodiscard]] double power_of_t_test(double d, int people, Pairing pairing, double level = 0.05);

/// The fewest people, in each group, or pairs, with which that chance is at least `power`.
/// @param d  over the standard deviation of one person's value, or of the differences where paired
/// @fails  usage: d is 0 or not finite; power or level is not in (0, 1), or power is not above level; more than 10⁷.
[[nodiscard]] Result<int> people_for_effect(double d, double power, Pairing pairing, double level = 0.05);

/// Variances by which numbers differ [unit², all the same]: as a mixed model gives them.
struct VarianceComponents {
  double participant = 0, session = 0, residual = 0;
};

/// A plan of so many trials in so many sessions.
struct Plan {
  int sessions = 1, trials = 1;  ///< trials in each session
  std::optional<int> people;     ///< in each group, or pairs, of people_and_trials
  double variance = 0;           ///< of one person's mean, or of its change where paired
};

/// People that a wanted difference of means takes, for each number of trials from 1 to `max_trials` in each of so many
/// sessions: a person's mean has the variance σ_p² + (σ_s² + σ_e²/m)/k; paired, its change between two conditions, each
/// measured like that, 2 (σ_s² + σ_e²/m)/k: what differs between people drops out.
/// @param difference  wanted [unit]
/// @fails  usage: as people_for_effect; a variance is negative or not finite; all are 0; sessions or max_trials < 1.
[[nodiscard]] Result<std::vector<Plan>> people_and_trials(const VarianceComponents& variances, double difference,
                                                          double power, Pairing pairing, int sessions, int max_trials,
                                                          double level = 0.05);

/// Trials that a wanted minimal detectable change takes.
struct TrialsForChange {
  std::optional<int> trials;  ///< fewest in each session; absent: no number of trials is enough
  double mdc95 = 0;           ///< with that many
  double smallest_mdc95 = 0;  ///< with any number of trials: what sessions differ by remains
};

/// MDC = 1.96 √2 √((σ_s² + σ_e²/m)/k), where each of the two measurements is the mean of k sessions.
/// @fails  usage: `change` is not above 0; a variance is negative or not finite; sessions < 1.
[[nodiscard]] Result<TrialsForChange> trials_for_change(const VarianceComponents& variances, double change,
                                                        int sessions = 1);

}  // namespace mbk::reliability
