#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Whether the file begins as an XDF file does.
[[nodiscard]] bool looks_like_xdf(std::span<const std::byte> file);

/// Reads an XDF file (Extensible Data Format 1.0), as LabRecorder writes it of the streams of Lab Streaming Layer.
///
/// A stream of numbers gives a clock of its name, an array STREAM.LABEL for each channel with the unit that its header
/// says, and STREAM.raw_time, its time stamps as they stand in the file. Channels without a label are called channel_1,
/// channel_2, …; names that repeat get #2, #3, …. A stream of texts gives events.
///
/// The clock of a stream is what its raw stamps become by these steps, each of which is reported in Contents::notes:
/// 1. A stamp that is missing is the last one plus 1/nominal rate.
/// 2. Groups of samples that are out of order are sorted (`order_by_stamps`), in a stream with a nominal rate.
/// 3. The clock offsets put the stamps on the recorder's clock, segment by segment between resets of the sender's
/// clock,
///    and without the steps of either (`synchronise`). Samples that may be on either side of a step are left out.
/// 4. The stamps of a stream with a nominal rate become evenly spaced between its breaks (`dejitter`), unless its
///    header says that it can drop samples.
///
/// Notes of what may be wrong stand before the others.
///
/// Behind damage the file is read on from the next boundary chunk; a note says how many bytes were lost.
///
/// @fails  data: it does not begin as XDF; there is no stream, or none with samples.
[[nodiscard]] Result<Contents> decode_xdf(std::span<const std::byte> file);

}  // namespace mbk::recording
