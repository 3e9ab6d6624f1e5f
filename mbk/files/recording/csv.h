#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Reads a table of numbers: comma, semicolon or tab between the cells (found from the first lines), comments after #
/// or
/// %, an optional header. Empty cells and "nan" are NaN. Lines are counted from 1, as editors do.
/// Tolerated with a note: a separator at the end of every line; a last line that was not written completely (it is left
/// aside).
/// @fails  a line has more or fewer cells than the first; a header does not fit the columns; a cell is not a number;
///         decimal commas; no line of numbers.
[[nodiscard]] Result<Contents> decode_csv(std::span<const std::byte> file);

/// The same while the file is read, of which a part is enough in memory.
/// @param file  of which at least one piece was read
/// @fails  and where the rest of the file cannot be read.
[[nodiscard]] Result<Contents> decode_csv(FileInPassing& file);

}  // namespace mbk::recording
