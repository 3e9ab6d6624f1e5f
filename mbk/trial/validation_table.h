#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mbk {

/// One quantity of a study against known truth: what came out, how sure that is, and what is wanted.
struct ValidationRow {
  std::string what;
  double value = 0;
  std::pair<double, double> interval99;  ///< of the value, from the number of runs
  std::pair<double, double> wanted;      ///< the row is met where interval99 overlaps it
  [[nodiscard]] bool met() const { return interval99.second >= wanted.first && interval99.first <= wanted.second; }
};

/// A method against known truth.
struct ValidationTable {
  std::string study;     ///< "coverage"
  std::string question;  ///< in words
  std::string unit;      ///< of the values: "%"
  int runs = 0;
  std::uint64_t seed = 0;
  std::vector<ValidationRow> rows;

  [[nodiscard]] bool met() const {
    for (const ValidationRow& row : rows) {
      if (!row.met()) return false;
    }
    return !rows.empty();
  }
};

}  // namespace mbk
