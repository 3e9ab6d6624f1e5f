#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// Limits on the cost of reading a file.
struct ReadLimits {
  std::uint64_t bytes = 0;  ///< of memory for the tree, and of one buffer beside it; work is bounded by a multiple
  std::uint64_t available = std::numeric_limits<std::uint64_t>::max();  ///< available memory; more is refused
  int objects = 100'000;                                                ///< groups, datasets and attributes
  int depth = 16;                                                       ///< groups within groups
};

/// Whether an HDF5 signature stands where one may: at byte 0, 512, 1024, 2048, …
[[nodiscard]] bool looks_like_hdf5(std::span<const std::byte> file);

/// Reads a whole HDF5 file (HDF5 File Format Specification 1.0 to 3.0): superblocks 0 to 3, groups old and new,
/// attributes, links (hard, and soft ones within the file), datasets that are compact, contiguous or in chunks, packed
/// by deflate, LZF, shuffle and fletcher32. Numbers, texts, references to objects and tables (datasets of a compound
/// type, as groups of their columns) are read; every other value, a link to another file and a link from a group to one
/// that contains it is `Unread`. So is a dataset that is damaged or of which a part was never written, with
/// Unread::damaged, and nothing else of the file is lost by it; a group that is damaged says so in Group::damage.
/// Every size is checked against the bytes before it is used. Safe to call from several threads.
/// @fails  data: the file is shorter than it states, or was not closed by its writer; its root is damaged; the limits
/// are exceeded. `where` is the path of the object.
[[nodiscard]] Result<Group> read(std::span<const std::byte> file, const ReadLimits& limits);

}  // namespace mbk::hdf5
