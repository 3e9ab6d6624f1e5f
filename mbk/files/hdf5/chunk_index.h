#pragma once

#include <functional>
#include <vector>

#include "mbk/files/hdf5/dataspace.h"
#include "mbk/files/hdf5/file.h"
#include "mbk/files/hdf5/hdf5_layout.h"

namespace mbk::hdf5 {

/// A chunk that was written.
struct Chunk {
  std::vector<std::uint64_t> place;  ///< counted in chunks along each dimension
  std::uint64_t address = kUndefined;
  std::uint64_t size = 0;     ///< [bytes] in the file
  std::uint32_t skipped = 0;  ///< bit i: filter i was not applied
};

/// Calls use(chunk) for every chunk of an index, in the order of the index. Chunks beyond the shape can be among them.
/// @param packed       whether the dataset has filters
/// @param chunk_bytes  of a chunk that is not packed
/// @fails  the index is broken; `use` fails.
[[nodiscard]] Result<void> for_each_chunk(File& file, const ChunkIndex& index, const Dataspace& space, bool packed,
                                          std::uint64_t chunk_bytes,
                                          const std::function<Result<void>(const Chunk&)>& use);

}  // namespace mbk::hdf5
