#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// Two-way analysis of variance of n people in k sessions, one number in each cell [unit of the numbers, squared].
struct MeanSquares {
  int people = 0, sessions = 0;
  double between_people = 0;    ///< MSB, n − 1 degrees of freedom
  double between_sessions = 0;  ///< MSJ, k − 1
  double residual = 0;          ///< MSE, (n − 1)(k − 1)
  double within_people = 0;     ///< MSW, n(k − 1): sessions and residual together
};

/// What an intraclass correlation counts as error, by its names of McGraw & Wong (1996).
enum class IccForm {
  one_way,      ///< ICC(1): everything within a person
  agreement,    ///< ICC(A, 1), Shrout & Fleiss's (2, 1): also what all people change by from session to session
  consistency,  ///< ICC(C, 1), their (3, 1): only what is left after that
};

[[nodiscard]] constexpr auto word_table(IccForm) {
  using enum IccForm;
  return std::to_array<Word<IccForm>>({{one_way, "one-way"}, {agreement, "agreement"}, {consistency, "consistency"}});
}

/// An intraclass correlation. It may be below 0, and is 1 at most; so may the ends of its interval, which is nowhere
/// cut.
struct Icc {
  IccForm form = IccForm::agreement;
  int averaged = 1;  ///< of one measurement, or of the mean over all k sessions
  double value = 0;
  Interval interval95;
};

/// Standard error of measurement and minimal detectable change [unit of the numbers].
struct MeasurementError {
  IccForm form = IccForm::agreement;  ///< agreement or consistency: what is counted as error
  double sem = 0;
  Interval sem95;
  double mdc95 = 0;  ///< 1.96 √2 SEM: a change between two measurements that is less may be error
  Interval mdc95_interval;
};

/// Reliability of numbers that were measured again.
struct TestRetest {
  Support support = Support::enough;
  MeanSquares mean_squares;
  std::vector<Icc> icc;                 ///< of one: one-way, agreement, consistency; then of k; empty where not enough
  std::vector<MeasurementError> error;  ///< agreement, consistency; empty where not enough
};

///   MSB = k Σᵢ(x̄ᵢ − x̄)²/(n − 1), MSJ = n Σⱼ(x̄ⱼ − x̄)²/(k − 1), MSE = Σᵢⱼ(xᵢⱼ − x̄ᵢ − x̄ⱼ + x̄)²/((n − 1)(k − 1))
/// @param scores  n×k, a person in each row    @fails  data: fewer than 2×2; a value is not finite.
[[nodiscard]] Result<MeanSquares> mean_squares(const Matrix& scores);

/// The intraclass correlation of one measurement; its formulas stand at test_retest().
[[nodiscard]] double icc_of(IccForm form, const MeanSquares& squares);

/// Intraclass correlations after Shrout & Fleiss (1979) and McGraw & Wong (1996), tables 4, 7 and 8,
///   ICC(1) = (MSB − MSW)/(MSB + (k−1) MSW)
///   ICC(A,1) = (MSB − MSE)/(MSB + (k−1) MSE + k (MSJ − MSE)/n)
///   ICC(C,1) = (MSB − MSE)/(MSB + (k−1) MSE)
/// and of the mean of k, k r/(1 + (k−1) r). Intervals by the F distribution, exact for normal numbers but in the
/// agreement form, whose degrees of freedom are Satterthwaite's (there a negative estimate counts as 0).
///   SEM: agreement √((MSJ − MSE)/n + MSE), consistency √MSE; MDC = 1.96 √2 SEM
/// with intervals by χ², that of the agreement by Satterthwaite's degrees of freedom, widened for tails
/// (heavy_tails.h).
///
/// Sessions that differ in trials, missing cells, groups: mixed_model.h.
/// @param scores  n×k, a person in each row, a session in each column
/// @fails  data: a value is not finite; no rows or columns.
[[nodiscard]] Result<TestRetest> test_retest(const Matrix& scores);

}  // namespace mbk::reliability
