#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/text_lines.h"

namespace mbk::recording {

// Shared by the readers of text tables other than CSV.

inline constexpr std::size_t kMaxTextColumns = 10'000;
inline constexpr std::string_view kWriteAgain = "write it again with the program that made it";

/// Without blanks around it.
[[nodiscard]] std::string in_lower_case(std::string_view text);
[[nodiscard]] std::string line_place(std::size_t line);
[[nodiscard]] bool is_blank(std::string_view cell);
/// Whether a line contains only separators and quotes, like a blank line saved by a spreadsheet.
[[nodiscard]] bool is_empty_row(std::string_view line);
/// Without blanks and quotes around it, printable.
[[nodiscard]] std::string label_of(std::string_view cell);

[[nodiscard]] std::string_view text_of(std::span<const std::byte> file);

/// The separator of the cells of a line: a tab; a semicolon or comma from a spreadsheet; or blanks.
[[nodiscard]] char separator_of(std::string_view line);
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, char separator);
/// The same without empty ones at the end.
[[nodiscard]] std::vector<std::string_view> filled_cells_of(std::string_view line, char separator);

/// The cells of a line of names, which may be quoted and then contain separators.
[[nodiscard]] std::vector<std::string> labels_of(std::string_view line, char separator);

[[nodiscard]] std::optional<double> positive_number(std::string_view text);

/// Whether the last line was not written completely.
[[nodiscard]] bool is_cut(const TextLine& line, std::size_t cells, std::size_t columns);
[[nodiscard]] std::string note_of_cut(const TextLine& line);

/// Notes "the header states 100 rows, but there are 98" if they differ.
void compare_counts(const std::optional<double>& said, std::size_t there, std::string_view what, Contents& contents);

/// "RB#2" for a second RB in a file.
void number_repeated(std::vector<std::string>& names);

/// "columns with vectors were ignored: …", for those with an obstacle.
void note_obstacles(std::string_view what, Contents& contents);

/// Rows of numbers, each as long as there are columns.
class TextRows {
 public:
  /// @param bytes  of the file, which bounds the number of numbers
  TextRows(std::size_t columns, std::size_t bytes);

  /// A row; cells that are missing at its end are NaN. With decimal commas numbers have no points.
  /// @fails  data: a cell is neither a number nor a vector; the rows are so short that most of the table is empty.
  Result<void> add(const TextLine& line, std::span<const std::string_view> cells, bool decimal_commas = false);

  [[nodiscard]] std::size_t count() const { return numbers_.empty() ? 0 : numbers_.front().size(); }
  [[nodiscard]] std::span<const double> column(std::size_t c) const { return numbers_[c]; }
  /// Why a column has no numbers.
  [[nodiscard]] const std::optional<Error>& obstacle(std::size_t c) const { return obstacles_[c]; }
  /// Its numbers, or why there are none, as values or obstacle of an array. They are moved out.
  void give(std::size_t c, Array& array);

 private:
  std::vector<std::vector<double>> numbers_;
  std::vector<std::optional<Error>> obstacles_;  ///< of columns of vectors
  std::size_t most_;                             ///< rows
};

/// Adds a row with any decimal separator.
Result<void> add_row(TextRows& rows, const TextLine& line, char separator, std::size_t columns);

/// An array without numbers yet.
Array& add_array(Contents& contents, std::string name, std::string unit, double rate_hz);

}  // namespace mbk::recording
