#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::recording {

/// Whether an HDF5 file follows MATLAB's conventions (v7.3): it begins with MATLAB's header, or something in its root
/// carries the attribute MATLAB_class.
[[nodiscard]] bool is_mat_hdf5(std::span<const std::byte> file, const hdf5::Group& root);

/// Decodes a MAT file v7.3: HDF5 whose datasets carry an attribute MATLAB_class and dimensions in reverse order. Real
/// numeric matrices and those in structures come out as arrays, single lines of text and cell arrays of them as texts;
/// everything else is named in a note.
[[nodiscard]] Contents contents_of_mat_hdf5(hdf5::Group root);

}  // namespace mbk::recording
