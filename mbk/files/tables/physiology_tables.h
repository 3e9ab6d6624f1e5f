#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

// Text that the recorders of physiology laboratories export: the rate, names and units stand in lines above the
// numbers.

/// BIOPAC AcqKnowledge: a file name, "1 msec/sample", "2 channels", and a line each for names and units.
[[nodiscard]] bool looks_like_acqknowledge(std::string_view text);

/// Reads the channels. Times are those of the sampling interval; a time column that disagrees with it is kept instead.
/// A channel that was recorded at a lower rate than the others has an obstacle.
/// @fails  data: fewer names than channels; what is not a number; a row with too many cells; no samples.
[[nodiscard]] Result<Contents> decode_acqknowledge(std::span<const std::byte> file);

/// ADInstruments LabChart: lines as "Interval=", "ChannelTitle=" and "UnitName=".
[[nodiscard]] bool looks_like_labchart(std::string_view text);

/// Reads each block as a recording of its own, with its comments as events.
/// @returns  at least one record, named "1", "2", …
/// @fails  data: a block says no interval or no titles; what is not a number; a row with too many or too few cells.
[[nodiscard]] Result<std::vector<NamedContents>> decode_labchart(std::span<const std::byte> file);

/// CED Spike2: sections "INFORMATION", "SUMMARY" and one "CHANNEL" for each.
[[nodiscard]] bool looks_like_spike2(std::string_view text);

/// Reads the waveforms, each from the START and by the interval that its section says; waveforms with other times have
/// clocks of their own. Other channels, as events, have an obstacle.
/// @fails  data: what is not a number in a waveform; no waveform.
[[nodiscard]] Result<Contents> decode_spike2(std::span<const std::byte> file);

}  // namespace mbk::recording
