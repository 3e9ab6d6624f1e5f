#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/model/trial/chart.h"

namespace mbk {

/// One quantity of a study against known truth: what came out, how sure that is, and what is expected.
struct ValidationRow {
  std::string what;
  double value = 0;
  std::pair<double, double> interval99;               ///< of the value, from the number of runs
  std::optional<std::pair<double, double>> expected;  ///< met where interval99 overlaps it; absent: only reported
  std::optional<std::string> unit;                    ///< of this row, in place of the table's
  std::optional<double> spread;                       ///< standard deviation over the runs, in the row's unit
  std::optional<double> coverage;                     ///< share of the runs whose 95 % interval holds the truth, 0 to 1

  [[nodiscard]] bool judged() const { return expected.has_value(); }
  [[nodiscard]] bool met() const {
    return !expected || (interval99.second >= expected->first && interval99.first <= expected->second);
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

  /// Whether every row that is judged is met. A table without rows is not.
  [[nodiscard]] bool met() const {
    for (const ValidationRow& row : rows) {
      if (!row.met()) return false;
    }
    return !rows.empty();
  }
};

}  // namespace mbk
