#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Error code of a text without a line of numbers.
inline constexpr std::string_view kNoTable = "no-table";

/// UTF-16 with a byte order mark, as spreadsheets write it.
[[nodiscard]] bool looks_like_utf16(std::span<const std::byte> file);

/// Reads a table of numbers. Cells are separated by commas, semicolons, tabs, vertical bars or blanks: whichever makes
/// most cells numbers, or as given by a first line "sep=;". Lines of text above the table, comments after # or %, a
/// header (also in the comment just above, where it holds names of channels) and a line of units under it are found;
/// names and numbers may be quoted; the text is UTF-8, Latin-1 or, with a byte order mark, UTF-16. Empty cells and
/// "nan" are NaN. Times of day and dates (ISO 8601) become seconds since the midnight before the first, and decimal
/// commas decimal points. Each of these is reported in a note. Lines are counted from 1, as in editors. A column with
/// other contents is ignored with a note; its Array::obstacle gives the place. Tolerated with a note: a separator at
/// the end of every line; an incomplete last line (it is ignored).
/// @fails  a line has more or fewer cells than the first; a header does not fit the columns; no line or no column of
///         numbers; two readings are possible: commas that may be decimal, column or thousands separators; numbers
///         above the header; different units in a name and in the line of units.
[[nodiscard]] Result<Contents> decode_csv(std::span<const std::byte> file);

/// The same while the file is being read, with only a part of it in memory.
/// @param file  with at least one piece read
/// @fails  and if the rest of the file cannot be read.
[[nodiscard]] Result<Contents> decode_csv(FileInPassing& file);

}  // namespace mbk::recording
