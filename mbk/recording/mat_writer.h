#pragma once

#include <filesystem>

#include "mbk/core/result.h"
#include "mbk/trial/recording.h"

namespace mbk::recording {

/// Writes the recording as a 19×N double matrix `logs`, MAT v5 with compression. Rows that have no channel are NaN, so
/// that nobody takes them for measured zeros. The file appears whole or not at all: it is written beside its place,
/// flushed to the disk and renamed.
/// @fails  usage: the file is there and `overwrite` is false; a channel has no row in the layout (position, reaction,
/// …).
///         data: no samples, or more than 2³¹ bytes of matrix; the folder cannot be written.
[[nodiscard]] Result<void> write_logs(const Recording& recording, const std::filesystem::path& file, bool overwrite);

}  // namespace mbk::recording
