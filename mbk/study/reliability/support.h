#pragma once

#include <array>
#include <utility>

#include "mbk/base/core/words.h"

namespace mbk::reliability {

/// The ends of an interval.
using Interval = std::pair<double, double>;

/// Whether the data can carry a statistic, and if not, what they lack.
enum class Support {
  enough,
  too_few_people,    ///< fewer than the statistic needs; where it says how many, that is there too
  too_few_sessions,  ///< of one session or trial nothing repeats
  too_few_trials,    ///< too few sessions with two trials or more: sessions and trials are not identifiable
  no_variation,      ///< all values are alike, or all that could be compared
  too_few_raters,    ///< fewer than kMinPeople people were measured by two raters
};

[[nodiscard]] constexpr auto word_table(Support) {
  using enum Support;
  return std::to_array<Word<Support>>({{enough, "enough"},
                                       {too_few_people, "too few people"},
                                       {too_few_sessions, "too few sessions"},
                                       {too_few_trials, "too few trials"},
                                       {no_variation, "no variation"},
                                       {too_few_raters, "too few raters"}});
}

/// What lies beyond either end of a 95 % interval.
inline constexpr double kTail95 = 0.025;

/// Below that many people no reliability is stated: of four people in two sessions, the 95 % interval of an ICC of 0.9
/// reaches down to 0.3.
inline constexpr int kMinPeople = 5;

/// 1.96: of the published minimal detectable change, 1.96 √2 SEM, and of limits of agreement, d̄ ± 1.96 s.
inline constexpr double kPublishedNormal95 = 1.96;

}  // namespace mbk::reliability
