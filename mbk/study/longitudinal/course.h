#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/words.h"
#include "mbk/study/longitudinal/stretch_extent.h"
#include "mbk/study/reliability/support.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/store/store_values.h"

/// How outcomes of each person develop over sessions, and what of that is more than error of measurement.
namespace mbk::longitudinal {

using reliability::Interval;

/// What may be said of a change of one person between two sessions.
enum class ChangeVerdict {
  beyond_error,  ///< more than even the upper end of the interval of the minimal detectable change, which holds
  uncertain,     ///< more than the minimal detectable change, and less than that end
  within_error,  ///< at most the minimal detectable change: no detectable change
  unknown,       ///< the minimal detectable change is not known
};

[[nodiscard]] constexpr auto word_table(ChangeVerdict) {
  using enum ChangeVerdict;
  return std::to_array<Word<ChangeVerdict>>(
      {{beyond_error, "beyond-error"}, {uncertain, "uncertain"}, {within_error, "within-error"}, {unknown, "unknown"}});
}

/// The results of one person in one session.
struct SessionMean {
  std::int64_t session = 0;
  int results = 0;
  double mean = kNaN;  ///< of the results; of an orientation the mean axis, within 90° of that of the first session
};

/// What a session differs by from an earlier one.
struct Change {
  std::int64_t first_session = 0, last_session = 0;
  double first = kNaN, last = kNaN;
  double difference = kNaN;       ///< last − first
  double mdc = kNaN;              ///< minimal detectable change (95 %) between means of so many results; NaN: unknown
  Interval mdc95 = {kNaN, kNaN};  ///< how well that is known
  bool by_others = false;         ///< by the variances of all other people, since it is more than by those of all
  bool heavy_tails = false;       ///< errors of those people have heavy tails: mdc95 does not hold
  ChangeVerdict verdict = ChangeVerdict::unknown;
  std::string why_not_comparable = {};  ///< as a clause; then mdc and verdict are unknown
};

/// One outcome of one person under one condition.
struct Course {
  std::int64_t participant = 0;
  std::vector<SessionMean> sessions;   ///< by their numbers
  std::vector<Change> changes;         ///< each later session against the first
  std::optional<Change> latest;        ///< the last session against the one before, with three sessions or more
  double mean = kNaN;                  ///< of the sessions' means
  Interval interval95 = {kNaN, kNaN};  ///< of that, by the variances of all people; NaN: unknown
};

/// One outcome under one condition.
struct OutcomeCourses {
  std::string condition, outcome, unit;
  bool axial = false;                  ///< an orientation
  int repeated_participants = 0;       ///< who have two sessions or more
  std::string why_unknown;             ///< why no minimal detectable change is known, as a clause; "" where it is
  double mean = kNaN;                  ///< of the people's means
  Interval interval95 = {kNaN, kNaN};  ///< of that, by Student's t; NaN: fewer than two people, or an orientation
  std::vector<Course> courses;         ///< by participants
};

/// The minimal detectable change between the means of so many results in two sessions,
///   1.96 √(2 σ_s² + (σ_e² + v̄)(1/m₁ + 1/m₂)),
/// with the variances of the mixed model; where they are not separable, their sum is taken for σ_s², which is exact for
/// one trial in each session and too large for more. It is unknown where fewer than kMinPeople people have two
/// sessions: the variances of too few people, or of trials of one session alone, say nothing of what a person changes
/// by.
struct DetectableChange {
  std::string why_unknown;                    ///< a clause; "": it is known
  double session = 0, trial = 0;              ///< σ_s², σ_e² + v̄ [unit²]
  double lower_factor = 1, upper_factor = 1;  ///< ends of its 95 % interval, as factors
  bool heavy_tails = false;                   ///< errors have heavy tails, so that this interval does not hold

  [[nodiscard]] bool known() const { return why_unknown.empty(); }
  [[nodiscard]] double between(int first_results, int second_results) const;
};

[[nodiscard]] DetectableChange detectable_change(const statistics::OutcomeReliability& reliability);

/// What a difference is by that.
[[nodiscard]] ChangeVerdict verdict_of(double difference, double mdc, const Interval& mdc95);

/// For every outcome and condition of the statistics. A person whose difference exceeds the minimal detectable change
/// of all people is judged with the minimal detectable change of all others, if known and for at most 40 such people:
/// one large change among few people would otherwise mask itself. Sessions that are not comparable have no verdict.
/// @param statistics  with a participant, of comparable_columns(); otherwise their variances include results that are
///     not comparable
/// @param participant  only that one's courses; the minimal detectable change is still that of all people
[[nodiscard]] std::vector<OutcomeCourses> courses(const store::OutcomeColumns& columns,
                                                  const statistics::StudyStatistics& statistics,
                                                  std::optional<std::int64_t> participant = {},
                                                  const StretchExtents& extents = {});

}  // namespace mbk::longitudinal
