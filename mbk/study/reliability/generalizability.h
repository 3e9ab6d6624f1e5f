#pragma once

#include <array>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/study/reliability/support.h"

/// Generalizability theory (Cronbach et al. 1972; Brennan 2001): people are measured by raters, in sessions, in trials.
namespace mbk::reliability {

/// Numbers, one a row, in any order and of any design. All vectors have N entries.
struct Ratings {
  Vector values;                  ///< finite
  std::vector<int> participants;  ///< any numbers, equal for equal people
  std::vector<int> raters;        ///< the same rater has the same number for all people
  std::vector<int> sessions;  ///< crossed: session 1 of all people is one session. Trials are rows alike in all three
};

/// What a variance is of.
enum class FacetTerm {
  participant,
  rater,              ///< one rater measures more than another, in all people
  participant_rater,  ///< raters differ by other amounts in other people
  session,            ///< all people change together, as by learning
  participant_session,
  rater_session,
  participant_rater_session,
  residual,  ///< trials
};

[[nodiscard]] constexpr auto word_table(FacetTerm) {
  using enum FacetTerm;
  return std::to_array<Word<FacetTerm>>({{participant, "participant"},
                                         {rater, "rater"},
                                         {participant_rater, "participant×rater"},
                                         {session, "session"},
                                         {participant_session, "participant×session"},
                                         {rater_session, "rater×session"},
                                         {participant_rater_session, "participant×rater×session"},
                                         {residual, "residual"}});
}

/// An estimated variance.
struct FacetVariance {
  FacetTerm term = FacetTerm::residual;
  double value = 0;               ///< 0 where the likelihood has its maximum there; never below
  double standard_error = 0;      ///< by the expected information, also at 0
  std::vector<FacetTerm> pooled;  ///< what the design cannot tell from it, and is part of it
};

/// What the sessions of a study are to its variances.
enum class SessionFacet {
  separate,    ///< they have variances of their own
  too_few,     ///< fewer than kMinPeople people have two: a session is no facet, and its trials are trials
  confounded,  ///< each rater has sessions of their own: what sessions differ by is part of what raters do
};

[[nodiscard]] constexpr auto word_table(SessionFacet) {
  using enum SessionFacet;
  return std::to_array<Word<SessionFacet>>(
      {{separate, "separate"}, {too_few, "too few people with two sessions"}, {confounded, "confounded with raters"}});
}

/// Restricted maximum likelihood of y = μ + the sum of independent normal effects, one for each level of each term.
struct RaterModel {
  Support support = Support::enough;  ///< if not, the rest is empty but for the counts
  int participants = 0, raters = 0, sessions = 0, rows = 0;
  int repeated_participants = 0;  ///< measured by two raters or more
  SessionFacet session_facet = SessionFacet::too_few;
  bool has_trials = false;  ///< at least kMinPeople rows beyond the first of each person, rater and session
  double mean = 0;          ///< μ
  std::vector<FacetVariance> variances;  ///< in the order of FacetTerm
  Matrix covariance;                     ///< of these estimates, by the expected information
  double deviance = 0;                   ///< as lme4's REMLcrit
  /// Of each variance, its share in the mean of a person's results in this study.
  Vector of_person_mean;
};

/// Fits it by Fisher scoring with bounds at 0. A term is left out where fewer than kMinPeople differences tell of it,
/// or where its covariance is a combination of those of others (a zero of the expected information); it is then pooled,
/// see FacetVariance. In balanced designs whose analysis of variance has no negative estimate, the result is that
/// analysis.
///
/// Cost: people × (raters × sessions)³ for each of about ten steps; trials cost nothing.
/// @fails  data: shapes differ; a value is not finite.
[[nodiscard]] Result<RaterModel> fit_raters(const Ratings& ratings);

/// What a result is the mean of.
struct Averaged {
  int raters = 1, sessions = 1, trials = 1;  ///< trials by each rater in each session
};

/// A standard error of measurement, and 1.96 √2 of it. NaN where it is not known.
struct AveragedError {
  double sem = kNaN;
  Interval sem95 = {kNaN, kNaN};
  double mdc95 = kNaN;
  Interval mdc95_interval = {kNaN, kNaN};
};

/// What raters, sessions and trials make of a mean over so many of them.
struct Generalizability {
  Support support = Support::enough;  ///< too_few_sessions or too_few_trials: more than one, which the study does not
                                      ///< tell of
  Averaged averaged;
  double relative = kNaN;  ///< G: people ranked by the same raters in the same sessions
  Interval relative95 = {kNaN, kNaN};
  double absolute = kNaN;  ///< Φ: any raters
  Interval absolute95 = {kNaN, kNaN};
  AveragedError relative_error, absolute_error;
  AveragedError same_raters;  ///< between two sessions by the same raters; NaN where sessions are no facet
};

/// With variances σ² of p (people), r, s and their products, and R raters, S sessions, T trials each,
///   δ² = σ_pr²/R + σ_ps²/S + σ_prs²/(R S) + σ_e²/(R S T),  Δ² = δ² + σ_r²/R + σ_s²/S + σ_rs²/(R S)
///   G = σ_p²/(σ_p² + δ²),  Φ = σ_p²/(σ_p² + Δ²),  SEM = δ or Δ
/// and, by the same raters, √(σ_s²/S + σ_ps²/S + σ_rs²/(R S) + σ_prs²/(R S) + σ_e²/(R S T)). Of one trial by each rater
/// in one session, Φ(1) = ICC(2,1), Φ(k) = ICC(2,k), G(1) = ICC(3,1) of Shrout & Fleiss (1979).
///
/// Intervals: of SEM by χ² with Satterthwaite's degrees of freedom 2 v²/(cᵀ A c) for the variance v = cᵀσ², A the
/// covariance by the expected information, widened for tails (heavy_tails.h); variances that are 0 count with their
/// uncertainty. Of G and Φ after McGraw & Wong (1996), with whom it agrees in their designs: the variance of people's
/// means is to what the coefficient says it is as F, both with such degrees of freedom; cut at 0.
/// @fails  usage: a number that is not above 0.
[[nodiscard]] Result<Generalizability> generalizability(const RaterModel& model, const Averaged& averaged);

}  // namespace mbk::reliability
