#pragma once

#include <filesystem>

#include "mbk/core/result.h"
#include "mbk/trial/recording.h"

namespace mbk::recording {

/// Writes a recording as MAT v5 with compression: the 19×N double matrix `logs` where every channel has a row in it,
/// and otherwise (one axis) one column variable per channel, and `time`. Rows of `logs` that have no channel are NaN,
/// so that nobody takes them for measured zeros. Metadata and events stand beside it as structures (annotations.h),
/// where there are any. The header carries no date: equal recordings give equal bytes. The file appears whole or not at
/// all (write_file).
/// @fails  usage: the file is there and `overwrite` is false.
///         data: what metadata_to_write refuses; no samples, or more than 2³¹ bytes of matrix; a channel has another
///         length than time; the folder cannot be written.
[[nodiscard]] Result<void> write_mat(const Recording& recording, const std::filesystem::path& file, bool overwrite);

}  // namespace mbk::recording
