#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/study/statistics/study_statistics.h"

/// Intervals by resampling people (Efron & Tibshirani 1993): of n people n are drawn with replacement, each with all of
/// their numbers, and what is stated of them is computed anew. Nothing is assumed of how the numbers are distributed.
namespace mbk::statistics {

/// The numbers of the people that one statement is about.
struct PeopleTable {
  std::optional<reliability::Pairing> pairing;  ///< of a difference; absent: reliability
  Matrix first;                                 ///< a person in each row; reliability: a session in each column
  Matrix second;                                ///< of a difference: the other column; else empty
};

/// One for each reliability between sessions and each difference that is stated, in the order of `statistics`.
[[nodiscard]] std::vector<PeopleTable> people_tables(const StudyStatistics& statistics);

/// What one draw of people gives: of reliability ICC(A,1), ICC(C,1) and SEM (agreement), of a difference second −
/// first; one table after the other. NaN where those who were drawn have none. Paired people are drawn as pairs, the
/// two samples of an unpaired difference each by itself. It depends on the tables, the seed and the number of the draw
/// alone; of tables with equally many people the same rows are drawn.
/// @param draw  0, 1, …
[[nodiscard]] std::vector<double> bootstrap_draw(std::span<const PeopleTable> tables, std::uint64_t seed, int draw);

/// Adds the intervals that the draws give to `statistics`.
///   percentile: the quantiles 0.025 and 0.975 of the draws
///   BCa: the quantiles Φ(z₀ + (z₀ + z)/(1 − a(z₀ + z))) for z = ∓1.96, with z₀ by the share of draws below the
///   estimate and a = Σₛ nₛ⁻³ Σᵢ Uᵢ³/(6 (Σₛ nₛ⁻² Σᵢ Uᵢ²)^(3/2)), Uᵢ = (nₛ − 1)(θ̄ₛ − θ₍ᵢ₎) by leaving out each person of
///   each sample s (Efron 1987; Davison & Hinkley 1997, §5.4)
/// Where more than 5 % of the draws give no number, or all lie on one side of the estimate, there is no interval.
/// @param tables  people_tables(statistics)    @param draws  bootstrap_draw(tables, seed, 0), …
void add_bootstrap(StudyStatistics& statistics, std::span<const PeopleTable> tables,
                   const std::vector<std::vector<double>>& draws, std::uint64_t seed);

}  // namespace mbk::statistics
