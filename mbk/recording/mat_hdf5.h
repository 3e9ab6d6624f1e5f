#pragma once

#include <filesystem>
#include <span>

#include "mbk/core/result.h"
#include "mbk/recording/contents.h"

namespace mbk::recording {

/// True where the bytes hold an HDF5 signature where a MAT v7.3 file has it: after a header of 512 bytes.
[[nodiscard]] bool looks_like_mat_hdf5(std::span<const std::byte> file);

/// Decodes a MAT file v7.3: HDF5 whose datasets carry an attribute MATLAB_class and dimensions in reverse order. Real
/// numeric matrices and those in structures come out as arrays; everything else is named in a note.
/// Length, number types, chunks and sizes are checked here, but the tree of a damaged file is walked by the HDF5
/// library, and 1.10.8 can read beyond its buffers, or crash, on damaged metadata (about one in several thousand random
/// changes to a file full of attributes). A truncated file is always refused.
/// @param file   where the bytes came from: the HDF5 library reads it itself
/// @fails  the file is shorter than its superblock says; a dataset claims more than the file can hold or was never
///         written; HDF5 cannot read it.
[[nodiscard]] Result<Contents> decode_mat_hdf5(const std::filesystem::path& file, std::span<const std::byte> bytes);

}  // namespace mbk::recording
