#pragma once

#include <string>
#include <vector>

#include "mbk/files/hdf5/object_header.h"

namespace mbk::hdf5 {

/// An entry of a group.
struct Link {
  std::string name;
  std::uint64_t address = kUndefined;  ///< of an object header; undefined where it leads elsewhere
};

[[nodiscard]] bool is_group(const ObjectHeader& header);

/// All entries of a group: from its symbol table, from its link messages, or from its fractal heap.
/// @fails  a structure on the way is broken.
[[nodiscard]] Result<std::vector<Link>> read_links(File& file, const ObjectHeader& header);

}  // namespace mbk::hdf5
