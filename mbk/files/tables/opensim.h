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
/// case are missing. Where the header says inDegrees=yes, columns that are angles are in degrees
/// (Contents::units).
/// Columns of vectors ("0.52,0.43,0.1,0.7") are left aside with a note. Tabs may have become semicolons or commas.
/// @fails  data: no labels, or no rows; a line with more or fewer numbers than there are labels; what is not a number.
[[nodiscard]] Result<Contents> decode_opensim(std::span<const std::byte> file);

/// A .trc file: the places of markers.
[[nodiscard]] bool looks_like_trc(std::string_view text);

/// Reads the markers as columns "NAME.x", "NAME.y" and "NAME.z", in the unit and at the rate that the file says. Blank
/// cells and NaN in any case are missing. As OpenSim does, it reads headers that lack a key, count markers wrongly or
/// number the axes otherwise, and says so.
/// @fails  data: the header is not that of such a file; axes in another order; what is not a number; a line with more
///         numbers than there are columns.
[[nodiscard]] Result<Contents> decode_trc(std::span<const std::byte> file);

}  // namespace mbk::recording
