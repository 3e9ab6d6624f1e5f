#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/model/trial/chart.h"

namespace mbk {

/// What the runs of a study show of one quantity. Acceptance is by equivalence: fewer runs have wider intervals, so
/// that they never make it easier.
enum class RowVerdict {
  met,          ///< the 95 % interval lies inside the accepted range
  falls_short,  ///< the interval lies outside
  not_shown,    ///< too few runs: the interval reaches across an end of the range
  informative   ///< there is no accepted range
};

[[nodiscard]] constexpr auto word_table(RowVerdict) {
  using enum RowVerdict;
  return std::to_array<Word<RowVerdict>>(
      {{met, "met"}, {falls_short, "falls short"}, {not_shown, "not shown"}, {informative, "informative"}});
}

/// One quantity of a study against known truth: what came out, how sure that is, and what is accepted.
struct ValidationRow {
  std::string what;
  double value = 0;
  /// Two-sided 95 % interval of the value, from the number of runs; an end may be infinite. Absent: the value is not
  /// an estimate (nothing in it is random, or it counts what happened in these runs), and is judged as it stands.
  std::optional<std::pair<double, double>> interval95;
  std::optional<std::pair<double, double>> expected;  ///< accepted range, with its ends; absent: informative
  std::optional<std::string> unit;                    ///< of this row, in place of the table's
  std::optional<double> spread;                       ///< standard deviation over the runs, in the row's unit
  std::optional<int> trials;                          ///< the value is a share [%] of so many

  [[nodiscard]] bool judged() const { return expected.has_value(); }

  [[nodiscard]] RowVerdict verdict() const {
    if (!expected) return RowVerdict::informative;
    if (trials == 0) return RowVerdict::not_shown;
    if (!interval95) return accepts(value) ? RowVerdict::met : RowVerdict::falls_short;
    const auto& [low, high] = *interval95;
    if (accepts(low) && accepts(high)) return RowVerdict::met;
    const bool reaches_in = high >= expected->first && low <= expected->second;
    return reaches_in && !std::isnan(value) ? RowVerdict::not_shown : RowVerdict::falls_short;
  }
  [[nodiscard]] bool met() const { return !judged() || verdict() == RowVerdict::met; }

 private:
  [[nodiscard]] bool accepts(double x) const { return expected->first <= x && x <= expected->second; }
};

/// A method against known truth.
struct ValidationTable {
  std::string study;     ///< "coverage"
  std::string question;  ///< in words
  std::string unit;      ///< of the values: "%"
  int runs = 0;
  std::uint64_t seed = 0;
  std::vector<ValidationRow> rows;
  std::vector<std::string> notes;  ///< sentences below the table
  std::vector<Chart> charts;

  /// falls_short where one row does; else not_shown where one is, or where no row is judged; else met.
  [[nodiscard]] RowVerdict verdict() const {
    bool met = false, not_shown = false;
    for (const ValidationRow& row : rows) {
      const RowVerdict one = row.verdict();
      if (one == RowVerdict::falls_short) return one;
      met |= one == RowVerdict::met;
      not_shown |= one == RowVerdict::not_shown;
    }
    return met && !not_shown ? RowVerdict::met : RowVerdict::not_shown;
  }
  /// Whether every row that is judged is met, and one is judged.
  [[nodiscard]] bool met() const { return verdict() == RowVerdict::met; }
};

}  // namespace mbk
