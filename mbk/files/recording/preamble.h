#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/files/recording/csv_text.h"
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {

/// Statements about the numbers of a table in the text lines above it.
struct Preamble {
  std::optional<double> rate_hz;   ///< nothing if no line states one, or if two lines differ
  std::string rate_from;           ///< "line 1, 'Fs,1000'"
  std::vector<const Unit*> units;  ///< at most one per dimension: of all columns of that dimension
  std::vector<std::string> notes;  ///< lines that were used, and similar lines that were not
};

/// Reads "SampleRate=500", "Sampling frequency: 500 Hz", "Fs,1000", "dt = 2 ms", "inDegrees=yes", "Units: mm",
/// "Position units,mm,Force units,N", "angles are in degrees". Other lines that look like a rate, a unit, a gain or a
/// date are listed in a note, and so are contradictory rates or units.
[[nodiscard]] Preamble read_preamble(std::span<const CsvLine> lines);

/// The note on such a comment among the rows, which may apply to some of them only.
[[nodiscard]] std::optional<std::string> unread_statement(const CsvLine& line);

/// Whether a line states one of these in a form that no header has.
[[nodiscard]] bool is_statement(const CsvLine& line);

}  // namespace mbk::recording
