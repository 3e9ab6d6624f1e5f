#pragma once

#include "mbk/files/hdf5/chunk_filters.h"
#include "mbk/files/hdf5/elements.h"
#include "mbk/files/hdf5/hdf5_layout.h"

namespace mbk::hdf5 {

/// Reads the elements of a dataset that is stored in chunks.
/// @param filters  all of them such as are read
/// @fails  the chunks do not fit the dataset, are damaged, or do not cover it.
[[nodiscard]] Result<void> read_chunks(File& file, const ChunkIndex& index, const Filters& filters,
                                       const Dataspace& space, Elements& elements);

}  // namespace mbk::hdf5
