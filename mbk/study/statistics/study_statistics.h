#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/study/reliability/bland_altman.h"
#include "mbk/study/reliability/comparison.h"
#include "mbk/study/reliability/generalizability.h"
#include "mbk/study/reliability/mixed_model.h"
#include "mbk/study/reliability/retest.h"
#include "mbk/study/store/store_values.h"
#include "mbk/study/store/study_list.h"

/// What a study says of people: how reliable each outcome is, and whether conditions, groups or sessions differ.
namespace mbk::statistics {

using reliability::Interval;
using reliability::Support;

/// What two sets of results that are compared differ in.
enum class ComparedBy {
  condition,  ///< the same people under two conditions, or two sets of people
  group,      ///< two sets of people, under each condition
  session,    ///< the same people in two sessions, under each condition
};

[[nodiscard]] constexpr auto word_table(ComparedBy) {
  using enum ComparedBy;
  return std::to_array<Word<ComparedBy>>({{condition, "condition"}, {group, "group"}, {session, "session"}});
}

/// People by their numbers, under a name.
struct PeopleGroup {
  std::string name;
  std::vector<std::int64_t> participants;
};

struct Comparing {
  ComparedBy by = ComparedBy::condition;
  std::vector<std::string> levels;  ///< at least two, compared in pairs in this order; empty: all that there are
};

struct StatisticsOptions {
  std::vector<std::string> outcomes;  ///< their names; empty: all
  std::optional<Comparing> comparing;
  std::vector<PeopleGroup> groups;
  std::optional<reliability::Averaged> averaged;  ///< of raters: also means of 1 … so many raters
  unsigned threads = 0;                           ///< 0: as many as there are cores; the numbers are the same for any
  std::uint64_t seed = 1;                         ///< of drawn permutations
};

/// The same people several times: one value of each person in each repetition.
struct Repeated {
  Support support = Support::too_few_people;
  std::vector<std::int64_t> participants;  ///< those that have a value in each; a row of `scores`
  std::vector<std::int64_t> repetitions;   ///< numbers of sessions, or 1 … k of trials; a column of `scores`
  int left_out = 0;                        ///< people with values who lack one of these
  Matrix scores;                           ///< [unit of the outcome]; orientations are unwrapped about the mean axis
  reliability::TestRetest test_retest;     ///< empty where `support` is not enough
};

/// Two sessions of the same people, later − earlier.
struct SessionAgreement {
  std::int64_t first_session = 0, second_session = 0;
  reliability::BlandAltman limits;
};

/// What becomes of a number when one person is left out: the person who changes it most.
struct Influence {
  std::int64_t participant = 0;
  double without = kNaN;  ///< the number without that person
};

/// What resampling people says of a number (people_bootstrap.h).
struct BootstrapInterval {
  double value = kNaN;
  double standard_error = kNaN;          ///< standard deviation of the draws
  Interval percentile95 = {kNaN, kNaN};  ///< NaN: none can be stated
  Interval bca95 = {kNaN, kNaN};         ///< bias-corrected and accelerated
  int undefined = 0;                     ///< draws that gave no number
};

struct ReliabilityBootstrap {
  BootstrapInterval icc_agreement, icc_consistency;  ///< ICC(A,1), ICC(C,1)
  BootstrapInterval sem_agreement;                   ///< [unit]; MDC is 1.96 √2 of it
};

/// Why numbers of an outcome do not hold as they stand. A sentence in OutcomeReliability::notes goes with each.
enum class ReliabilityWarning {
  sessions_and_trials,  ///< their variances are not identifiable: too few sessions have two trials
  people_and_sessions,  ///< of a pilot: too few people have two sessions
  heavy_tails,          ///< errors scatter with heavier tails than the intervals of SEM and MDC allow for
};

[[nodiscard]] constexpr auto word_table(ReliabilityWarning) {
  using enum ReliabilityWarning;
  return std::to_array<Word<ReliabilityWarning>>({{sessions_and_trials, "sessions-and-trials-not-identifiable"},
                                                  {people_and_sessions, "people-and-sessions-not-identifiable"},
                                                  {heavy_tails, "heavy-tails"}});
}

/// Variances by restricted maximum likelihood from every trial, whoever lacks whichever session.
struct MixedReliability {
  Support support = Support::too_few_people;
  bool weighted = false;  ///< each trial by its own standard error
  int participants = 0, sessions = 0, results = 0;
  /// Between people, between sessions of a person, between trials of a session beyond what `known` says, and the mean
  /// of the trials' own squared standard errors (0 where not weighted) [unit²].
  /// `session` and `residual` are NaN where the data do not separate them; `within` is their sum, which is always
  /// known.
  double participant = kNaN, session = kNaN, residual = kNaN, within = kNaN, known = kNaN;
  std::vector<reliability::ModelReliability> of_trials;  ///< of one trial, and of the mean of `typical_trials`
  int typical_trials = 1;                                ///< in a session, the median
};

/// Variances of raters beside those of people, sessions and trials, from every result that names a rater.
struct RaterReliability {
  int without_rater = 0;  ///< results that name none and are left out
  reliability::RaterModel model;
  /// Of one trial by one rater in one session, of as many as are typical of the study, and of those asked for.
  std::vector<reliability::Generalizability> of_numbers;
};

/// One outcome under one condition.
struct OutcomeReliability {
  std::string condition, outcome, unit;
  bool axial = false;             ///< an orientation
  int participants = 0;           ///< with a result
  int repeated_participants = 0;  ///< in two sessions or more
  int results = 0;
  Repeated between_sessions;                ///< of the means of each session's trials
  std::vector<SessionAgreement> agreement;  ///< each session with the one before
  std::optional<Influence> influence;       ///< on ICC(A,1) between sessions
  std::int64_t session = 0;                 ///< the one that `within_session` is of; 0: none
  Repeated within_session;                  ///< of single trials, in their order
  MixedReliability mixed_model;
  std::optional<RaterReliability> raters;         ///< absent where no result names a rater
  std::optional<ReliabilityBootstrap> bootstrap;  ///< of `between_sessions`, where it was asked for
  std::vector<ReliabilityWarning> warnings;
  std::vector<std::string> notes;  ///< what must be known beside the numbers; sentences
};

/// Quartiles of distances.
struct Quartiles {
  int count = 0;
  double lower = kNaN, median = kNaN, upper = kNaN;
};

/// Impedance widths (affine-invariant distances, impedance/impedance_width.h) of a matrix under one condition.
struct MatrixSpread {
  std::string condition, matrix;  ///< "M", "B", "K"
  Support support = Support::too_few_people;
  int participants = 0, sessions = 0;  ///< that have a positive definite mean
  int left_out = 0;                    ///< sessions whose mean matrix is not positive definite
  Quartiles within;                    ///< between sessions of one person
  Quartiles between;                   ///< between people
  double closer = kNaN;  ///< chance that a distance within a person is less than one between people; 0.5: no help
};

/// What may be said of a difference.
enum class DifferenceVerdict {
  differs,         ///< Holm's p over all tests is at most 0.05
  not_shown,       ///< it is not; which is no proof that there is none
  too_few_people,  ///< even if all went one way, no permutation could show it at 0.05
  no_variation,    ///< nothing varies, so that nothing can be said
};

[[nodiscard]] constexpr auto word_table(DifferenceVerdict) {
  using enum DifferenceVerdict;
  return std::to_array<Word<DifferenceVerdict>>({{differs, "differs"},
                                                 {not_shown, "not shown"},
                                                 {too_few_people, "too few people"},
                                                 {no_variation, "no variation"}});
}

/// The difference by a model with the participant as random effect, which also takes people who have only one of the
/// two; each mean by the standard errors of its trials where all are known.
struct MixedDifference {
  bool weighted = false;
  int participants = 0;
  reliability::FixedEffect difference;
  double participant = kNaN, residual = kNaN;  ///< variances [unit²]
};

/// One outcome between two levels, second − first. Each person counts once in each, with the mean of their results.
struct OutcomeComparison {
  std::string condition;  ///< under which groups or sessions are compared; "" where conditions are
  std::string first, second, outcome, unit;
  bool axial = false;
  int left_out = 0;                              ///< paired: people who have only one of the two
  double first_mean = kNaN, second_mean = kNaN;  ///< of the people who count
  Vector first_values, second_values;            ///< theirs; paired: entry i of both is one person
  reliability::Difference difference;
  reliability::Permutation permutation;
  std::optional<MixedDifference> mixed_model;
  /// Adjusted for all tests of the comparison; NaN where p is.
  double p_holm = kNaN, p_benjamini_hochberg = kNaN;
  std::optional<Influence> influence;          ///< on p: the person without whom it is largest
  std::optional<BootstrapInterval> bootstrap;  ///< of the difference, where it was asked for
  DifferenceVerdict verdict = DifferenceVerdict::too_few_people;
  std::vector<std::string> notes;
};

struct Comparison {
  ComparedBy by = ComparedBy::condition;
  std::vector<std::string> levels;
  int tests = 0;  ///< p-values that are adjusted together
  std::vector<OutcomeComparison> outcomes;
};

/// How people were resampled.
struct BootstrapDraws {
  int draws = 0;
  std::uint64_t seed = 1;
};

/// What a study says, by one analysis.
struct StudyStatistics {
  std::vector<OutcomeReliability> reliability;  ///< by condition and outcome
  std::vector<MatrixSpread> matrices;
  std::optional<Comparison> comparison;
  std::optional<BootstrapDraws> bootstrap;
  std::vector<std::string> notes;  ///< on the study as a whole; sentences
};

/// Adds to the columns what follows from elements of 2×2 or 3×3 matrices: of stiffness (K), damping (B) and inertia (M)
/// the eigenvalues of the symmetric part (stiffness_lambda_max, stiffness_lambda_min) and the parts of the off-diagonal
/// elements (stiffness_symmetric_xy, stiffness_antisymmetric), beside the area, shape and orientation that a result
/// has. With three axes also stiffness_lambda_mid, _symmetric_xz and _yz, and the vector _antisymmetric_x, _y and _z;
/// results with two axes in the same study have none of these numbers.
void add_matrix_numbers(store::OutcomeColumns& columns);

/// Everything at once. Reliability after mbk/study/reliability: the classical forms from people who have every session
/// that most have, and from the first session with repeated trials; the mixed model from all.
///
/// Orientations are taken about their mean axis, and not at all where one is more than 45° from it. Weighting by
/// standard errors is left out above 5,000 results of one outcome and condition, where it costs much and changes
/// little.
/// @fails  usage: an outcome, a level, a group is not there; a person is in two groups; fewer than two levels.
[[nodiscard]] Result<StudyStatistics> study_statistics(const store::OutcomeColumns& columns,
                                                       const StatisticsOptions& options = {});

/// Schema "mbk.study_summary/1".
[[nodiscard]] std::string to_json(const store::StudyList& list, std::span<const store::OutcomeSummary> outcomes,
                                  const StudyStatistics& statistics);

}  // namespace mbk::statistics
