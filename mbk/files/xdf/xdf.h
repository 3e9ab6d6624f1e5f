#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Whether the file has an XDF signature.
[[nodiscard]] bool looks_like_xdf(std::span<const std::byte> file);

/// Reads an XDF file (Extensible Data Format 1.0), as LabRecorder writes streams of Lab Streaming Layer.
///
/// A stream of numbers gives a clock of its name, an array STREAM.LABEL for each channel with the unit in its header,
/// and STREAM.raw_time, its time stamps as stored. Channels without a label are named channel_1, channel_2, …; repeated
/// names get #2, #3, …. A stream of texts gives events.
///
/// The clock of a stream results from its raw stamps by these steps, each reported in Contents::notes:
/// 1. A stamp that is missing is the last one plus 1/nominal rate.
/// 2. Groups of samples that are out of order are sorted (`order_by_stamps`), in a stream with a nominal rate.
/// 3. The clock offsets put the stamps on the recorder's clock, segment by segment between resets of the sender's
/// clock,
///    and without the steps of either (`synchronise`). Samples that may be on either side of a step are omitted.
/// 4. The stamps of a stream with a nominal rate become evenly spaced between its breaks (`dejitter`), unless its
///    header says that it can drop samples.
///
/// Notes on possible problems come first.
///
/// After damage, reading continues at the next boundary chunk; a note gives the number of lost bytes.
///
/// @fails  data: no XDF signature; there is no stream, or none with samples.
[[nodiscard]] Result<Contents> decode_xdf(std::span<const std::byte> file);

}  // namespace mbk::recording
