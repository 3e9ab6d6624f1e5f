#include "mbk/files/hdf5/write_tree.h"

#include <algorithm>

namespace mbk::hdf5 {

std::uint64_t append_tree(Output& out, TreeOf type, std::size_t most, std::vector<TreeEntry> entries,
                          const std::string& last_key) {
  const std::size_t bytes = tree_node_bytes(most, last_key.size());
  for (unsigned level = 0;; ++level) {
    out.align();
    const std::uint64_t first = out.bytes.size();
    const std::size_t nodes = std::max<std::size_t>(1, (entries.size() + most - 1) / most);
    std::vector<TreeEntry> above;
    for (std::size_t n = 0; n < nodes; ++n) {
      const std::size_t end = std::min((n + 1) * most, entries.size());
      Output node;
      node.put_text("TREE");
      node.put_u8(static_cast<unsigned>(type));
      node.put_u8(level);
      node.put_u16(end - n * most);
      node.put_u64(n == 0 ? kNoAddress : first + (n - 1) * bytes);
      node.put_u64(n + 1 == nodes ? kNoAddress : first + (n + 1) * bytes);
      for (std::size_t i = n * most; i < end; ++i) {
        node.put_text(entries[i].key);
        node.put_u64(entries[i].child);
      }
      node.put_text(end < entries.size() ? entries[end].key : last_key);
      node.put_zeros(bytes - node.bytes.size());
      above.push_back({entries.empty() ? last_key : entries[n * most].key, first + n * bytes});
      out.append(std::move(node));
    }
    if (nodes == 1) return first;
    entries = std::move(above);
  }
}

}  // namespace mbk::hdf5
