#pragma once

#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {

/// Assigns the arrays of a file to channels in SI units. See `read` for the rules and failures.
[[nodiscard]] Result<Recording> assemble(Contents contents, const ReadOptions& options);

/// Whether channels are recognised by their names: without a map, with a map that names only time and schedule, and if
/// some are requested.
[[nodiscard]] bool leaves_names(const ReadOptions& options);

/// The trials from which a channel map leaves the choice (slices.h): "1", "2", …; none if every slice names its own.
[[nodiscard]] std::vector<TrialName> trials_of_map(const Contents& contents, const std::vector<ChannelSource>& map);

}  // namespace mbk::recording
