#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Code of the error of a text in which no line holds numbers.
inline constexpr std::string_view kNoTable = "no-table";

/// UTF-16 with a byte order mark, as spreadsheets write it.
[[nodiscard]] bool looks_like_utf16(std::span<const std::byte> file);

/// Reads a table of numbers as laboratories have them. Between the cells stand commas, semicolons, tabs, vertical bars
/// or blanks: whichever makes most cells numbers, or what a first line "sep=;" says. Lines of text above the table,
/// comments after # or %, a header (also in the comment just above, where it holds names of channels) and a line of
/// units under it are found; quotes may stand around names and numbers; the text is UTF-8, Latin-1 or, with a byte
/// order mark, UTF-16. Empty cells and "nan" are NaN. Times of day and dates (ISO 8601) become seconds since the
/// midnight before the first, and decimal commas decimal points. Each of these is said in a note. Lines are counted
/// from 1, as editors do.
/// A column that holds anything else is left aside with a note; its Array::obstacle says where.
/// Tolerated with a note: a separator at the end of every line; a last line that was not written completely (it is left
/// aside).
/// @fails  a line has more or fewer cells than the first; a header does not fit the columns; no line or no column of
///         numbers; two readings are possible: commas that may stand for decimals, between columns or between
///         thousands; numbers above the header; a name and the line of units that say different units.
[[nodiscard]] Result<Contents> decode_csv(std::span<const std::byte> file);

/// The same while the file is read, of which a part is enough in memory.
/// @param file  of which at least one piece was read
/// @fails  and where the rest of the file cannot be read.
[[nodiscard]] Result<Contents> decode_csv(FileInPassing& file);

}  // namespace mbk::recording
