#pragma once

#include <string>
#include <vector>

#include "mbk/files/hdf5/output.h"

namespace mbk::hdf5 {

/// A child of a node in a B-tree of version 1, and the key to its left.
struct TreeEntry {
  std::string key;
  std::uint64_t child = 0;
};

enum class TreeOf : unsigned { symbols = 0, chunks = 1 };

/// Bytes of one node of at most so many children, with keys of so many bytes.
[[nodiscard]] constexpr std::size_t tree_node_bytes(std::size_t most, std::size_t key) {
  return 24 + most * 8 + (most + 1) * key;
}

/// Appends a tree over entries in order, level by level from the leaves; the address of its root.
std::uint64_t append_tree(Output& out, TreeOf type, std::size_t most, std::vector<TreeEntry> entries,
                          const std::string& last_key);

}  // namespace mbk::hdf5
