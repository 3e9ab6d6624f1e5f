#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// What reading a file may cost.
struct ReadLimits {
  std::uint64_t bytes = 0;  ///< of memory for the tree, and of one buffer beside it; work is bounded by a multiple
  std::uint64_t available = std::numeric_limits<std::uint64_t>::max();  ///< memory that there is; beyond it is refused
  int objects = 100'000;                                                ///< groups, datasets and attributes
  int depth = 16;                                                       ///< groups within groups
};

/// Whether an HDF5 signature stands where one may: at byte 0, 512, 1024, 2048, …
[[nodiscard]] bool looks_like_hdf5(std::span<const std::byte> file);

/// Reads a whole HDF5 file (HDF5 File Format Specification 1.0 to 3.0): superblocks 0 to 3, groups old and new,
/// attributes, datasets that are compact, contiguous or in chunks, packed by deflate, shuffle and fletcher32.
/// Numbers, texts and references to objects are read; every other value, and a link to elsewhere, is `Unread`.
/// Every size is checked against the bytes before it is believed. Safe to call from several threads.
/// @fails  data: the file is shorter than it says, damaged, or left open by its writer; a part of a dataset was never
///         written; groups contain each other; the limits are passed. `where` is the path of the object.
[[nodiscard]] Result<Group> read(std::span<const std::byte> file, const ReadLimits& limits);

}  // namespace mbk::hdf5
