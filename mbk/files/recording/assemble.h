#pragma once

#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {

/// Gives the arrays of a file their meaning: which is which channel, in SI. See `read` for the rules and failures.
[[nodiscard]] Result<Recording> assemble(Contents contents, const ReadOptions& options);

/// Whether channels are recognised by their names: without a map, beside one that names no more than the time, as to
/// say its unit, and a schedule, and where some are requested.
[[nodiscard]] bool leaves_names(const ReadOptions& options);

/// The trials that a channel map leaves to be chosen (slices.h): "1", "2", …; none where every slice names its own.
[[nodiscard]] std::vector<TrialName> trials_of_map(const Contents& contents, const std::vector<ChannelSource>& map);

}  // namespace mbk::recording
