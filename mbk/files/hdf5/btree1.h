#pragma once

#include <functional>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// What a B-tree of version 1 sorts.
enum class BTree1 : std::uint8_t { group = 0, chunks = 1 };

/// Calls use(key, child) for every entry of the leaves, in order (specification, III.A.1).
/// @param key_size  [bytes]
/// @fails  a node is broken, or not of that kind; `use` fails.
[[nodiscard]] Result<void> for_each_child(File& file, std::uint64_t root, BTree1 kind, std::size_t key_size,
                                          const std::function<Result<void>(Cursor key, std::uint64_t child)>& use);

}  // namespace mbk::hdf5
