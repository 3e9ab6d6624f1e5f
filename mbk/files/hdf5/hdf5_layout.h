#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/files/hdf5/bytes.h"

namespace mbk::hdf5 {

/// How the chunks of a dataset are found.
struct ChunkIndex {
  enum class Kind { btree1, single, implicit, fixed_array, extensible_array, btree2 };
  Kind kind = Kind::btree1;
  std::uint64_t address = kUndefined;  ///< of the index; of the chunks themselves where they are single or implicit
  std::vector<std::uint64_t> chunk;    ///< shape of a chunk, as that of the dataset
  std::uint64_t element_size = 0;      ///< [bytes]
  bool whole_edges = true;             ///< whether chunks that reach beyond the dataset are packed too
  std::optional<std::uint64_t> single_size;  ///< [bytes] of a single chunk that is packed
  std::uint32_t single_skipped = 0;          ///< filters that were not applied to it
};

/// Where the elements of a dataset stand.
struct Layout {
  enum class Kind { compact, contiguous, chunked, unread };
  Kind kind = Kind::unread;
  Bytes compact;
  std::uint64_t address = kUndefined;  ///< contiguous
  std::uint64_t size = 0;              ///< [bytes], contiguous; kUndefined: what the elements take
  ChunkIndex chunks;
  std::string what;  ///< of what is not read
};

/// A data layout message (specification, IV.A.2.i), versions 1 to 4; others are `unread`.
/// @fails  it is broken.
[[nodiscard]] Result<Layout> read_layout(Cursor in);

}  // namespace mbk::hdf5
