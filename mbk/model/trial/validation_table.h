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
  falls_short,  ///< the estimate lies outside
  not_shown,    ///< too few runs: the estimate could lie inside or does, the interval does not
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

  /// Where no share of so few trials could lie inside the range, such as of 4 within 92 to 98 %, an estimate outside it
  /// says nothing; then the row falls short only where the whole interval lies beyond the range.
  [[nodiscard]] RowVerdict verdict() const {
    if (!expected) return RowVerdict::informative;
    if (!interval95) return accepts(value) ? RowVerdict::met : RowVerdict::falls_short;
    const auto& [low, high] = *interval95;
    if (accepts(low) && accepts(high)) return RowVerdict::met;
    if (accepts(value)) return RowVerdict::not_shown;
    const bool beyond = !(high >= expected->first && low <= expected->second);
    return too_few_trials() && !beyond ? RowVerdict::not_shown : RowVerdict::falls_short;
  }
  [[nodiscard]] bool met() const { return !judged() || verdict() == RowVerdict::met; }

 private:
  [[nodiscard]] bool accepts(double x) const { return expected->first <= x && x <= expected->second; }
  [[nodiscard]] bool too_few_trials() const {
    if (!trials) return false;
    const double first_inside = std::ceil(expected->first / 100.0 * *trials);
    return *trials == 0 || first_inside > std::floor(expected->second / 100.0 * *trials);
  }
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
