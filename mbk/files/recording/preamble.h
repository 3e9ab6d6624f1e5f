#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/files/recording/csv_text.h"
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {

/// What the lines of text above a table say about its numbers.
struct Preamble {
  std::optional<double> rate_hz;   ///< nothing where no line says one, or two say different ones
  std::string rate_from;           ///< "line 1, 'Fs,1000'"
  std::vector<const Unit*> units;  ///< at most one for each dimension: of all columns of that dimension
  std::vector<std::string> notes;  ///< what was taken, and which lines speak of such things and were not
};

/// Reads "SampleRate=500", "Sampling frequency: 500 Hz", "Fs,1000", "dt = 2 ms", "inDegrees=yes", "Units: mm",
/// "Position units,mm,Force units,N", "angles are in degrees". Whatever else looks like a rate, a unit, a gain or a
/// date is named in a note: so is a rate or a unit that two lines say differently.
[[nodiscard]] Preamble read_preamble(std::span<const CsvLine> lines);

/// The note of a comment among the rows that speaks of such: it may hold for some of them only.
[[nodiscard]] std::optional<std::string> unread_statement(const CsvLine& line);

/// Whether a line says one of these in a way in which no header does.
[[nodiscard]] bool is_statement(const CsvLine& line);

}  // namespace mbk::recording
