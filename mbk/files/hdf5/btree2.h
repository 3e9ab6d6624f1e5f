#pragma once

#include <functional>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// What the records of a B-tree of version 2 are.
enum class BTree2 : std::uint8_t {
  huge_objects = 1,  ///< of a fractal heap
  link_names = 5,
  attribute_names = 8,
  chunks = 10,
  packed_chunks = 11,
};

/// Calls use(kind, record) for every record, in order (specification, III.A.2).
/// @fails  a node is broken or its checksum is wrong; `use` fails.
[[nodiscard]] Result<void> for_each_record(File& file, std::uint64_t header,
                                           const std::function<Result<void>(BTree2 kind, Cursor record)>& use);

}  // namespace mbk::hdf5
