#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/model/trial/chart.h"

namespace mbk {

/// Where a number of ours comes from, beside one that a source printed.
enum class Provenance {
  recomputed,       ///< from other printed numbers, by the formula
  simulated,        ///< the mechanism, by a simulated robot, participant or rig: alike in form, not in value
  not_recoverable,  ///< what it rests on was never published
};

[[nodiscard]] constexpr auto word_table(Provenance) {
  using enum Provenance;
  return std::to_array<Word<Provenance>>(
      {{recomputed, "recomputed"}, {simulated, "simulated"}, {not_recoverable, "not recoverable"}});
}

/// How a number of ours stands to the printed one.
enum class Agreement {
  not_compared,     ///< one of the two is missing or is words, or ours is simulated and need not be the same
  within_rounding,  ///< what the rounding of the numbers that ours rests on leaves open reaches the printed one's
  round_trip,       ///< as within_rounding, but ours was computed from that printed number itself: the formulas undo
                    ///< each other, and nothing is known of the source
  erratum,          ///< it does not, and the source is at fault: the table names the erratum
  differs,          ///< it does not, and nothing explains it
};

[[nodiscard]] constexpr auto word_table(Agreement) {
  using enum Agreement;
  return std::to_array<Word<Agreement>>({{not_compared, "not compared"},
                                         {within_rounding, "within rounding"},
                                         {round_trip, "round trip"},
                                         {erratum, "erratum"},
                                         {differs, "differs"}});
}

/// Agreements that have another name since mbk.reproduction/1: "was" in JSON, for one version.
[[nodiscard]] constexpr auto former_word_table(Agreement) {
  using enum Agreement;
  return std::to_array<Word<Agreement>>({{erratum, "slip"}, {round_trip, "within rounding"}});
}

/// One cell of a table: numbers, or words where there is no number.
struct ReproducedCell {
  std::string printed;                             ///< as it stands in print, every digit; empty: nothing is printed
  std::optional<double> printed_value;             ///< absent where words are printed
  double rounding = 0;                             ///< half a unit of the last printed digit
  std::optional<double> ours;                      ///< absent where ours is words or cannot be had
  std::string words;                               ///< ours, where it is no number
  std::optional<double> spread;                    ///< standard deviation or error of ours, as the table says
  std::optional<std::pair<double, double>> range;  ///< what the rounding of the inputs leaves ours, low and high
  Agreement agreement = Agreement::not_compared;

  /// Ours − printed, where both are numbers.
  [[nodiscard]] std::optional<double> difference() const {
    if (!ours || !printed_value) return {};
    return *ours - *printed_value;
  }
};

struct ReproducedColumn {
  std::string name;
  std::string unit;  ///< may be empty
  int decimals = 2;  ///< with which ours is shown where nothing is printed
};

struct ReproducedRow {
  std::string name;
  std::vector<ReproducedCell> cells;  ///< one for each column
};

/// A table of the source and ours, cell by cell.
struct ReproducedTable {
  std::string id;  ///< by which printed cells are found: "3.6"; with a suffix where an exhibit has several
  std::string title;
  Provenance provenance = Provenance::recomputed;
  std::string what_rows_are;  ///< "participant"
  std::string spread_is;      ///< "standard error over four trials"; empty: no cell has one
  std::vector<ReproducedColumn> columns;
  std::vector<ReproducedRow> rows;
  std::string erratum;  ///< id of the erratum that explains cells that differ; empty: none does
};

/// One item of the source, reproduced: a table, a figure, an erratum, a question or a piece of future work.
struct Exhibit {
  enum class Kind { table, figure, erratum, question, future_work };
  std::string id;     ///< "table-3.6", "figure-4.3", "erratum-1", "question-2", "future-work-4"
  std::string title;  ///< in words of our own
  Kind kind = Kind::table;
  int chapter = 0;  ///< 3 to 6; 0: an appendix
  Provenance provenance = Provenance::recomputed;
  std::vector<std::string> text;      ///< paragraphs: how ours came about, what to see, why it cannot be had
  std::vector<std::string> commands;  ///< that make ours, as they are typed
  std::vector<ReproducedTable> tables;
  std::vector<Chart> charts;
  std::vector<std::string> related;  ///< ids of other exhibits
};

[[nodiscard]] constexpr auto word_table(Exhibit::Kind) {
  using enum Exhibit::Kind;
  return std::to_array<Word<Exhibit::Kind>>({{table, "table"},
                                             {figure, "figure"},
                                             {erratum, "erratum"},
                                             {question, "question"},
                                             {future_work, "future work"}});
}

/// What of a source was reproduced.
struct Reproduction {
  std::string source;  ///< what it is a reproduction of
  std::vector<Exhibit> exhibits;

  /// How many printed numbers and words stand so to ours. Each has one agreement, so that these add up to printed().
  [[nodiscard]] int count(Agreement agreement) const {
    return count_printed(
        [&](const ReproducedTable&, const ReproducedCell& cell) { return cell.agreement == agreement; });
  }

  [[nodiscard]] int printed() const {
    return count_printed([](const ReproducedTable&, const ReproducedCell&) { return true; });
  }

  /// How many of the printed ones stand beside simulated numbers, with which none is compared.
  [[nodiscard]] int beside_simulated() const {
    return count_printed(
        [](const ReproducedTable& table, const ReproducedCell&) { return table.provenance == Provenance::simulated; });
  }

 private:
  template <typename Condition>
  [[nodiscard]] int count_printed(const Condition& condition) const {
    int cells = 0;
    for (const Exhibit& exhibit : exhibits) {
      for (const ReproducedTable& table : exhibit.tables) {
        for (const ReproducedRow& row : table.rows) {
          for (const ReproducedCell& cell : row.cells) cells += !cell.printed.empty() && condition(table, cell) ? 1 : 0;
        }
      }
    }
    return cells;
  }
};

}  // namespace mbk
