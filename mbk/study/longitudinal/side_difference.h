#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/study/longitudinal/course.h"
#include "mbk/study/longitudinal/normal_range.h"

namespace mbk::longitudinal {

/// Two conditions that differ in the side alone: indices into OutcomeColumns::conditions.
struct SidePair {
  std::string name;  ///< what they share: "rest" of "rest-left" and "rest-right"; may be empty
  int left = 0, right = 0;
};

/// Conditions whose names differ in the word "left" and "right" alone, in upper or lower case.
[[nodiscard]] std::vector<SidePair> side_pairs(const std::vector<std::string>& conditions);

/// What the error of a difference between sides is from.
enum class ErrorBasis {
  sessions,    ///< how much the difference varies between sessions, in other people of the study
  recordings,  ///< the standard errors of the results, which do not tell of variation between sessions
  unknown,
};

[[nodiscard]] constexpr auto word_table(ErrorBasis) {
  using enum ErrorBasis;
  return std::to_array<Word<ErrorBasis>>({{sessions, "sessions"}, {recordings, "recordings"}, {unknown, "unknown"}});
}

/// One outcome of one person, left less right, in the last session with results of both sides.
struct SideDifference {
  std::string left_condition, right_condition, outcome, unit;
  std::int64_t session = 0;
  double left = kNaN, right = kNaN;  ///< means of the session's results
  double difference = kNaN;          ///< left − right
  double error = kNaN;               ///< 95 % of errors of the difference are smaller
  Interval error95 = {kNaN, kNaN};   ///< how well that is known; NaN where it is from recordings
  ErrorBasis basis = ErrorBasis::unknown;
  std::string why_unknown;   ///< why it is not from sessions, as a clause
  bool heavy_tails = false;  ///< differences of other people have heavy tails: error95 does not hold
  ChangeVerdict verdict = ChangeVerdict::unknown;  ///< whether the sides differ by more than that error
  NormalRange normal;                              ///< of the controls' differences in their last sessions
  RangeVerdict range_verdict = RangeVerdict::unknown;
  std::string why_not_comparable = {};       ///< why the sides are not comparable, as a clause; without verdicts
  std::string why_no_comparable_range = {};  ///< the same of the controls' differences; without range_verdict
};

/// Of each outcome that the participant has of both sides; orientations are omitted. The error is 1.96 σ, with σ² the
/// variance (REML) of left − right between sessions of a person, in all people but the participant; the mean of more
/// trials is not taken to be better. People whose sides are not comparable with each other and with the participant's
/// do not count, neither for the error nor for the range.
/// @param controls  without the participant
[[nodiscard]] std::vector<SideDifference> side_differences(const store::OutcomeColumns& columns,
                                                           std::int64_t participant,
                                                           const std::set<std::int64_t>& controls,
                                                           const StretchExtents& extents = {});

}  // namespace mbk::longitudinal
