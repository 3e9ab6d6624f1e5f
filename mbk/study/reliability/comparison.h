#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// Whether people of the two samples are the same ones.
enum class Pairing {
  unpaired,  ///< two groups
  paired,    ///< the same people twice: entry i of both is one person
};

[[nodiscard]] constexpr auto word_table(Pairing) {
  using enum Pairing;
  return std::to_array<Word<Pairing>>({{unpaired, "unpaired"}, {paired, "paired"}});
}

/// A standardised difference.
struct EffectSize {
  double g = 0;         ///< Hedges's: d times the factor that removes its bias for small samples
  double d = 0;         ///< unpaired: over the pooled standard deviation; paired: over that of the differences (d_z)
  Interval interval95;  ///< of the population's, exact by the noncentral t where both groups vary alike
};

/// A difference of means, second − first [unit of the numbers].
struct Difference {
  Support support = Support::enough;
  Pairing pairing = Pairing::unpaired;
  int first_count = 0, second_count = 0;
  double value = 0, standard_error = 0, degrees_of_freedom = 0;
  Interval interval95;
  double p = 0;  ///< two-sided, by Student's t
  EffectSize effect;
};

/// Unpaired: Welch (1947), √(s₁²/n₁ + s₂²/n₂) with Satterthwaite's degrees of freedom; paired: of the differences. With
///   d = (x̄₂ − x̄₁)/s,  g = J(ν) d,  J(ν) = Γ(ν/2)/(√(ν/2) Γ((ν−1)/2))                     (Hedges 1981)
/// and the interval of the population's δ from P(T ≤ t; ν, δ√ñ) = 0.975 and 0.025, ñ = n₁n₂/(n₁+n₂), or n where paired.
/// Support: too few people where a sample has fewer than 2; no variation where nothing varies.
/// @fails  data: a value is not finite; paired samples differ in length.
[[nodiscard]] Result<Difference> difference(const Vector& first, const Vector& second, Pairing pairing);

/// The p of difference() alone, for samples of finite values; NaN where there is none.
[[nodiscard]] double difference_p(const Vector& first, const Vector& second, Pairing pairing);

struct PermutationOptions {
  int max_exact = 20'000;  ///< up to so many arrangements all are looked at
  int draws = 9'999;       ///< else so many are drawn
  std::uint64_t seed = 1;
};

/// p-value without a distribution.
struct Permutation {
  /// too_few_people: no arrangement at all could reach p ≤ 0.05, as with three against three.
  Support support = Support::enough;
  double p = 1;
  double smallest_p = 1;  ///< that these numbers of people allow
  bool exact = false;     ///< all arrangements; otherwise p = (k + 1)/(draws + 1)
  int arrangements = 0;   ///< all of them, or draws
};

/// Two-sided, by Welch's or Student's t of each arrangement: of who is in which group, or, where paired, of the signs
/// of the differences. p is the share of arrangements with |t| as large as the one that was measured, which is one of
/// them, so that p is never 0. Studentised, it holds its level, for large samples, also where groups differ in spread
/// (Janssen 1997).
/// @fails  as difference(); usage: draws or max_exact below 1.
[[nodiscard]] Result<Permutation> permutation_test(const Vector& first, const Vector& second, Pairing pairing,
                                                   const PermutationOptions& options = {});

/// Adjusted p-values, in the order given: reject where they are at most α.
///   Holm (1979): max over the smaller ones of (m − i + 1) p₍ᵢ₎: the chance of one false rejection is at most α
///   Benjamini & Hochberg (1995): min over the larger ones of m p₍ᵢ₎/i: the expected false share is at most α
/// @fails  data: one is not in [0, 1].
[[nodiscard]] Result<Vector> holm(const Vector& p);
[[nodiscard]] Result<Vector> benjamini_hochberg(const Vector& p);

}  // namespace mbk::reliability
