#include "mbk/files/hdf5/btree1.h"

#include <fmt/format.h>

namespace mbk::hdf5 {
namespace {

constexpr int kMaxLevels = 32;  ///< every level holds at least two entries more

struct Walk {
  File& file;
  BTree1 kind;
  std::size_t key_size;
  const std::function<Result<void>(Cursor, std::uint64_t)>& use;

  /// @param expected_level  -1: whatever the root says
  Result<void> node(std::uint64_t address, int expected_level) {
    const auto broken = [&] { return damaged(fmt::format("the B-tree node at byte {} is broken", address)); };
    const std::size_t prefix_size = 8 + 2 * file.sizes.address;
    const auto prefix = MBK_TRY(file.block(address, prefix_size, "a B-tree node"));
    Cursor head = file.cursor(prefix);
    const bool known = head.is("TREE") && head.byte() == static_cast<std::uint8_t>(kind);
    const int level = head.byte();
    const std::uint64_t entries = head.word();
    if (!known || level > kMaxLevels || (expected_level >= 0 && level != expected_level)) return broken();
    const auto block =
        MBK_TRY(file.block(address + prefix_size, entries * (key_size + file.sizes.address), "a B-tree node"));
    Cursor in = file.cursor(block);
    for (std::uint64_t i = 0; i < entries; ++i) {
      const Cursor key = file.cursor(in.take(key_size));
      const std::uint64_t child = in.address();
      MBK_TRY(level > 0 ? node(child, level - 1) : use(key, child));
    }
    return {};
  }
};

}  // namespace

Result<void> for_each_child(File& file, std::uint64_t root, BTree1 kind, std::size_t key_size,
                            const std::function<Result<void>(Cursor, std::uint64_t)>& use) {
  return Walk{file, kind, key_size, use}.node(root, -1);
}

}  // namespace mbk::hdf5
