#pragma once

#include <string>
#include <vector>

#include "mbk/files/hdf5/object_header.h"

namespace mbk::hdf5 {

/// An entry of a group.
struct Link {
  enum class Kind {
    hard,      ///< to an object
    soft,      ///< to a path in this file
    external,  ///< to a path in another file
    other,     ///< of a kind that some program made up
  };
  std::string name;
  Kind kind = Kind::hard;
  std::uint64_t address = kUndefined;  ///< of an object header, where it is hard
  std::string path = {};               ///< where it is soft or external
  std::string file = {};               ///< where it is external
};

[[nodiscard]] bool is_group(const ObjectHeader& header);

/// All entries of a group: from its symbol table, from its link messages, or from its fractal heap.
/// @fails  a structure on the way is broken.
[[nodiscard]] Result<std::vector<Link>> read_links(File& file, const ObjectHeader& header);

}  // namespace mbk::hdf5
