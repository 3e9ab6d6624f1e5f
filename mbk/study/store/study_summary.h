#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/study/store/store_values.h"

namespace mbk::store {

/// One outcome under one condition, over participants: each counts once, with the mean of its results.
struct OutcomeSummary {
  std::string condition, outcome, unit;
  std::int64_t results = 0, participants = 0;
  double mean = 0.0;  ///< of the participants' means; of an orientation the mean axis
  /// Of the participants' means; NaN where there is one participant. Of an orientation ½ √(−2 ln R), R the length of
  /// the mean of (cos 2θ, sin 2θ).
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();
  double minimum = 0.0, maximum = 0.0;  ///< of all results
};

/// By condition and outcome, each in the order in which the columns have them.
[[nodiscard]] std::vector<OutcomeSummary> summarise_outcomes(const OutcomeColumns& columns);

/// Whether an outcome is an angle of an axis [°], which is the same 180° further.
[[nodiscard]] bool is_orientation(std::string_view outcome);

/// The same numbers, a column for each outcome.
[[nodiscard]] OutcomeColumns columns_of(const ObservationTable& table);

}  // namespace mbk::store
