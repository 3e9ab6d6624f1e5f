#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/model/trial/chart.h"

namespace mbk {

/// Origin of a reproduced number that is compared with a printed one.
enum class Provenance {
  recomputed,       ///< from other printed numbers, by the formula
  simulated,        ///< the mechanism, with a simulated robot, participant or rig: similar in form, not in value
  not_recoverable,  ///< its inputs were never published
};

[[nodiscard]] constexpr auto word_table(Provenance) {
  using enum Provenance;
  return std::to_array<Word<Provenance>>(
      {{recomputed, "recomputed"}, {simulated, "simulated"}, {not_recoverable, "not recoverable"}});
}

/// Agreement of a reproduced number with the printed one.
enum class Agreement {
  not_compared,     ///< one of the two is missing or text, or the reproduced one is simulated and need not agree
  within_rounding,  ///< the printed number is within the rounding of the inputs
  round_trip,  ///< as within_rounding, but computed from that printed number itself: the formulas cancel, so this is no
               ///< check of the source
  erratum,     ///< it disagrees because of an error in the source: the table names the erratum
  differs,     ///< it disagrees without explanation
};

[[nodiscard]] constexpr auto word_table(Agreement) {
  using enum Agreement;
  return std::to_array<Word<Agreement>>({{not_compared, "not compared"},
                                         {within_rounding, "within rounding"},
                                         {round_trip, "round trip"},
                                         {erratum, "erratum"},
                                         {differs, "differs"}});
}

/// Agreements renamed since mbk.reproduction/1: "was" in JSON, for one version.
[[nodiscard]] constexpr auto former_word_table(Agreement) {
  using enum Agreement;
  return std::to_array<Word<Agreement>>({{erratum, "slip"}, {round_trip, "within rounding"}});
}

/// One cell of a table: numbers or text.
struct ReproducedCell {
  std::string printed;                  ///< as printed, every digit; empty: nothing is printed
  std::optional<double> printed_value;  ///< absent if text is printed
  double rounding = 0;                  ///< half a unit of the last printed digit
  std::optional<double> ours;           ///< absent if the reproduced value is text or not available
  std::string words;                    ///< the reproduced value, if it is not a number
  std::optional<double> spread;         ///< standard deviation or error of the reproduced value, as stated by the table
  std::optional<std::pair<double, double>>
      range;  ///< range of the reproduced value within the rounding of the inputs, low and high
  Agreement agreement = Agreement::not_compared;

  /// Reproduced − printed, if both are numbers.
  [[nodiscard]] std::optional<double> difference() const {
    if (!ours || !printed_value) return {};
    return *ours - *printed_value;
  }
};

struct ReproducedColumn {
  std::string name;
  std::string unit;  ///< may be empty
  int decimals = 2;  ///< number of decimals if nothing is printed
};

struct ReproducedRow {
  std::string name;
  std::vector<ReproducedCell> cells;  ///< one for each column
};

/// A printed and a reproduced table, cell by cell.
struct ReproducedTable {
  std::string id;  ///< key of the printed cells: "3.6"; with a suffix if an exhibit has several
  std::string title;
  Provenance provenance = Provenance::recomputed;
  std::string what_rows_are;  ///< "participant"
  std::string spread_is;      ///< "standard error over four trials"; empty: no cell has one
  std::vector<ReproducedColumn> columns;
  std::vector<ReproducedRow> rows;
  std::string erratum;  ///< id of the erratum that explains differing cells; empty: none
};

/// One item of the source, reproduced: a table, a figure, an erratum, a question or a piece of future work.
struct Exhibit {
  enum class Kind { table, figure, erratum, question, future_work };
  std::string id;     ///< "table-3.6", "figure-4.3", "erratum-1", "question-2", "future-work-4"
  std::string title;  ///< title in our words
  Kind kind = Kind::table;
  int chapter = 0;  ///< 3 to 6; 0: an appendix
  Provenance provenance = Provenance::recomputed;
  std::vector<std::string> text;      ///< paragraphs: method, findings, or why it is not available
  std::vector<std::string> commands;  ///< commands that reproduce it, as typed
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

/// The reproduced parts of a source.
struct Reproduction {
  std::string source;  ///< the reproduced source
  std::vector<Exhibit> exhibits;

  /// Number of printed cells with this agreement. Each has one agreement, so these add up to printed().
  [[nodiscard]] int count(Agreement agreement) const {
    return count_printed(
        [&](const ReproducedTable&, const ReproducedCell& cell) { return cell.agreement == agreement; });
  }

  [[nodiscard]] int printed() const {
    return count_printed([](const ReproducedTable&, const ReproducedCell&) { return true; });
  }

  /// Number of printed cells beside simulated numbers, which are not compared.
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
