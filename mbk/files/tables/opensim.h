#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A .sto or .mot file: a header up to a line "endheader".
[[nodiscard]] bool looks_like_opensim(std::string_view text);

/// Reads such a table, with headers of today ("nRows=100") and old ones ("datarows 100"). Blank cells and NaN in any
/// case are missing. If the header states inDegrees=yes, columns of angles are in degrees
/// (Contents::units).
/// Columns of vectors ("0.52,0.43,0.1,0.7") are ignored with a note. Semicolons or commas may replace tabs.
/// @fails  data: no labels, or no rows; a line with more or fewer numbers than labels; a cell that is not a number.
[[nodiscard]] Result<Contents> decode_opensim(std::span<const std::byte> file);

/// A .trc file: marker positions.
[[nodiscard]] bool looks_like_trc(std::string_view text);

/// Reads the markers as columns "NAME.x", "NAME.y" and "NAME.z", in the unit and at the rate stated in the file. Blank
/// cells and NaN in any case are missing. Like OpenSim, it reads headers that lack a key, count markers wrongly or
/// number the axes differently, with a note.
/// @fails  data: the header is invalid; axes in another order; a cell that is not a number; a line with more numbers
/// than columns.
[[nodiscard]] Result<Contents> decode_trc(std::span<const std::byte> file);

}  // namespace mbk::recording
