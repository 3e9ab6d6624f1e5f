#pragma once

#include <optional>

#include "mbk/files/hdf5/bytes.h"

namespace mbk::hdf5 {

/// Where the superblock begins, or nothing.
[[nodiscard]] std::optional<std::size_t> find_superblock(Bytes file);

struct Superblock {
  Sizes sizes;
  Bytes contents;          ///< from the base address, from which addresses count, to the end that the file claims
  std::uint64_t root = 0;  ///< address of the object header of the root group
};

/// @fails  no superblock; it is broken or of an unknown version; the file is shorter than it says; it was not closed.
[[nodiscard]] Result<Superblock> read_superblock(Bytes file);

}  // namespace mbk::hdf5
