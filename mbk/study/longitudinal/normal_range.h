#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/words.h"
#include "mbk/study/longitudinal/stretch_extent.h"
#include "mbk/study/reliability/support.h"
#include "mbk/study/store/store_values.h"

/// What is usual among the controls of a study, and where one person is beside that.
namespace mbk::longitudinal {

/// Where 95 % of further people like the controls are expected.
struct NormalRange {
  int controls = 0;                              ///< whose numbers it is from
  double mean = kNaN;                            ///< NaN: fewer than kMinPeople controls
  reliability::Interval range95 = {kNaN, kNaN};  ///< the same; NaN also where they do not vary
  int not_comparable = 0;  ///< controls whose results are not comparable (StretchExtents) and do not count
};

/// The prediction interval of one further value, if values are normally distributed:
///   x̄ ± t(0.975, n − 1) s √(1 + 1/n)
/// (Hahn & Meeker 1991, Statistical Intervals, section 4.7).
/// @param values  one for each control; the range is NaN if one is not finite
[[nodiscard]] NormalRange normal_range(const std::vector<double>& values);

/// Where a value is beside a range.
enum class RangeVerdict { inside, below, above, unknown };

[[nodiscard]] constexpr auto word_table(RangeVerdict) {
  using enum RangeVerdict;
  return std::to_array<Word<RangeVerdict>>(
      {{inside, "inside"}, {below, "below"}, {above, "above"}, {unknown, "unknown"}});
}

/// Why fewer than kMinPeople controls count, if some are not comparable, as a clause; otherwise "". It tells of no
/// control alone.
[[nodiscard]] std::string too_few_comparable(const NormalRange& normal);

[[nodiscard]] RangeVerdict verdict_of(double value, const NormalRange& normal);

/// One outcome of one person in one session.
struct SessionResult {
  int results = 0;
  double mean = kNaN;                         ///< of the session's results
  double standard_error = kNaN;               ///< of that, by the standard errors of the results; NaN: not known
  std::vector<std::int64_t> recordings = {};  ///< that it is from
};

/// By participant and session, of the results under a condition (an index into columns.conditions). Not for
/// orientations.
[[nodiscard]] std::map<std::int64_t, std::map<std::int64_t, SessionResult>> session_results(
    const store::OutcomeColumns& columns, const store::OutcomeColumn& column, int condition);

/// The last session of each participant with a result under that condition.
[[nodiscard]] std::map<std::int64_t, std::int64_t> last_sessions(const store::OutcomeColumns& columns, int condition);

/// One outcome of the person under one condition, in the last session, beside the controls in theirs.
struct OutcomeRange {
  std::string condition, outcome, unit;
  std::int64_t session = 0;
  int results = 0;
  double value = kNaN;  ///< mean of the session's results
  NormalRange normal;
  int without = 0;  ///< controls with a result under the condition that lacks this number, such as an angle of catch
  RangeVerdict verdict = RangeVerdict::unknown;
  std::string why_not_comparable = {};  ///< why no range applies to the value, as a clause; "" where one does
};

/// Of each condition and outcome that the participant has a number of; orientations are omitted. Controls whose results
/// are not comparable do not count.
/// @param controls  without the participant
[[nodiscard]] std::vector<OutcomeRange> outcome_ranges(const store::OutcomeColumns& columns, std::int64_t participant,
                                                       const std::set<std::int64_t>& controls,
                                                       const StretchExtents& extents = {});

}  // namespace mbk::longitudinal
