#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A LabVIEW measurement file (.lvm).
[[nodiscard]] bool looks_like_lvm(std::string_view text);

/// Reads the segments of such a file, of writer versions 0.92 to 2.0 (National Instruments, "Specification for the
/// LabVIEW Measurement File"): any Separator and Decimal_Separator, one header or one for each segment, X_Columns One,
/// Multi or No. Where there is no X column the time comes from Delta_X; where channels have times of their own, each
/// has its clock. A Delta_X of exactly 1 is no rate, since LabVIEW also writes it where it knows none. Segments that
/// follow each other without a pause, by the start times in their headers, become one record; every other one is a
/// record of its own. Under a single header a segment begins where X starts anew or, without X, after as many samples
/// as the header says.
/// @returns  at least one record, named "1", "2", …
/// @fails  data: a header does not end; separator and decimal separator are both commas; a line has too many cells;
///         what is not a number; no samples; far more segments than samples.
[[nodiscard]] Result<std::vector<NamedContents>> decode_lvm(std::span<const std::byte> file);

}  // namespace mbk::recording
