#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// Numbers that were measured in people, in sessions, one a row; rows in any order, as many in each session as there
/// are. All vectors have N entries.
struct Measurements {
  Vector values;                   ///< NaN: a missing cell, which is left out and counted
  std::vector<int> participants;   ///< any numbers, equal for equal people
  std::vector<int> sessions;       ///< within the participant: 1 of one person and 1 of another are two sessions
  Matrix fixed;                    ///< N×p: the columns whose coefficients are wanted, the intercept among them
  std::vector<std::string> names;  ///< p: of those columns, for messages; may be empty
  /// N: how sure each value is, as its own fit says [unit of the values, squared]; empty: nothing is known of that.
  Vector known_variance;
};

/// A coefficient of a column of Measurements::fixed, or a weighted sum of coefficients.
struct FixedEffect {
  double value = 0, standard_error = 0;
  /// Satterthwaite's, 2 v²/(gᵀ A g) with v the squared standard error, g its gradient by the variances, A their
  /// covariance by the observed information (Giesbrecht & Burns 1985; as lmerTest); ∞ where no variance is estimated.
  double degrees_of_freedom = 0;
  Interval interval95;  ///< by Student's t
  double p = 0;         ///< two-sided, that it is 0
};

/// An estimated variance.
struct VarianceComponent {
  double value = 0;      ///< 0 where the likelihood has its maximum there: then it has no standard error
  bool present = false;  ///< false: the data cannot tell it from another one, which holds both
  std::optional<double> standard_error;  ///< by the observed information
};

/// Restricted maximum likelihood of
///   y = X β + bᵢ + sᵢⱼ + e,   bᵢ ~ N(0, σ_p²), sᵢⱼ ~ N(0, σ_s²), e ~ N(0, σ_e² + vᵢⱼₖ)
/// of participant i, session j within the participant, trial k; v is Measurements::known_variance, or 0.
struct MixedModel {
  int participants = 0, sessions = 0, rows = 0, missing = 0;  ///< rows and missing together are all that was given
  VarianceComponent participant, session, residual;
  double typical_known_variance = 0;  ///< mean of the known variances
  std::vector<FixedEffect> effects;   ///< in the order of the columns
  Matrix covariance;                  ///< p×p: of the coefficients
  /// −2 ln of the restricted likelihood, with (N − p) ln 2π, without ln det XᵀX; as lme4's REMLcrit.
  double deviance = 0;
  std::vector<Matrix> covariance_gradient;  ///< of `covariance`, by each estimated variance that is not 0
  Matrix variance_covariance;  ///< of those variances: participant, session, residual, those that are there
};

/// Fits it. The ratios of the variances are profiled: without known variances, σ_e² follows from them in closed form.
/// The likelihood and its derivatives are sums over sessions and participants, so that 10⁴ rows take well below a
/// second. A variance may be 0. Where every session has one row, the session is part of the residual; where every
/// participant has one session, of the participant.
/// @fails  data: shapes differ; a value of X or v is not finite, v is negative; columns of X depend on each other
/// (which
///   is named); no more rows than columns; two participants at least are needed; nothing varies but what X, people and
///   sessions explain (the residual is 0).
[[nodiscard]] Result<MixedModel> fit_mixed_model(const Measurements& measurements);

/// Whether the data separate the variance between sessions from that between trials: at least kMinPeople results beyond
/// the first of each session. With one trial in each session only the sum of both is identifiable, and with a few more
/// the split rests on a handful of differences.
[[nodiscard]] bool separates_sessions_from_trials(const MixedModel& model);

/// wᵀβ with its standard error, degrees of freedom and interval.
/// @param weights p
[[nodiscard]] FixedEffect contrast(const MixedModel& model, const Vector& weights);

/// Reliability by the variances of a mixed model, of the mean of so many trials of one session.
struct ModelReliability {
  Support support = Support::enough;
  int trials = 1;
  /// σ_p²/(σ_p² + σ_s² + (σ_e² + v̄)/m): what two sessions of the same person agree in.
  double icc = 0;
  Interval icc95;
  double sem_between = 0;  ///< √(σ_s² + (σ_e² + v̄)/m): between sessions
  Interval sem_between95;
  double sem_within = 0;  ///< √((σ_e² + v̄)/m): within a session; NaN where that is not separable from sessions
  Interval sem_within95;
  double mdc95_between = 0, mdc95_within = 0;  ///< 1.96 √2 SEM
};

/// Intervals are those of profile restricted likelihoods: the values at which −2 ln of it rises by less than 3.84 above
/// its minimum over the other variances. They need neither equal numbers of trials nor variances above 0; how often
/// they hold the truth is in `mbk validate reliability`. Those of SEM are widened for tails (heavy_tails.h). Near 0 a
/// variance cannot be missed below, and they hold it more often. Fixed effects decide what is counted as error: with a
/// column for each session the ICC is one of consistency. Where sessions and trials are not separable (above), the ICC
/// and the SEM between sessions of one trial remain, and means of more trials have too_few_trials.
/// @param trials ≥ 1: m
/// @fails  as fit_mixed_model; usage: trials < 1.
[[nodiscard]] Result<ModelReliability> model_reliability(const Measurements& measurements, int trials = 1);

/// A model and what follows from it for means of several numbers of trials.
struct FittedReliability {
  std::optional<MixedModel> model;  ///< absent where there are too few people or sessions
  std::vector<ModelReliability> of_trials;
};

/// The same for each of some numbers of trials, from one fit.   @fails  as model_reliability
[[nodiscard]] Result<FittedReliability> fit_reliability(const Measurements& measurements, std::span<const int> trials);

}  // namespace mbk::reliability
