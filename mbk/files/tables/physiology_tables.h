#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

// Text exports of physiology recorders: rate, names and units are in lines above the numbers.

/// BIOPAC AcqKnowledge: a file name, "1 msec/sample", "2 channels", and a line each for names and units.
[[nodiscard]] bool looks_like_acqknowledge(std::string_view text);

/// Reads the channels. Times are those of the sampling interval; a time column that disagrees with it is kept instead.
/// A channel that was recorded at a lower rate than the others has an obstacle.
/// @fails  data: fewer names than channels; a cell that is not a number; a row with too many cells; no samples.
[[nodiscard]] Result<Contents> decode_acqknowledge(std::span<const std::byte> file);

/// ADInstruments LabChart: lines as "Interval=", "ChannelTitle=" and "UnitName=".
[[nodiscard]] bool looks_like_labchart(std::string_view text);

/// Reads each block as a separate recording, with its comments as events.
/// @returns  at least one record, named "1", "2", …
/// @fails  data: a block without interval or titles; a cell that is not a number; a row with too many or too few cells.
[[nodiscard]] Result<std::vector<NamedContents>> decode_labchart(std::span<const std::byte> file);

/// CED Spike2: sections "INFORMATION", "SUMMARY" and one "CHANNEL" for each.
[[nodiscard]] bool looks_like_spike2(std::string_view text);

/// Reads the waveforms, each with START and interval of its section; waveforms with different times have their own
/// clocks. Other channels, such as events, have an obstacle.
/// @fails  data: a cell of a waveform that is not a number; no waveform.
[[nodiscard]] Result<Contents> decode_spike2(std::span<const std::byte> file);

}  // namespace mbk::recording
