#include "mbk/files/hdf5/btree2.h"

#include <fmt/format.h>

#include <vector>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr std::size_t kMaxDepth = 32;                    ///< levels
constexpr std::size_t kPrefix = 4 + 1 + 1;               ///< [bytes] before the records of a node
constexpr std::size_t kFrame = kPrefix + kChecksumSize;  ///< [bytes] of a node other than records

/// The nodes of one level; level 0 are the leaves.
struct Level {
  std::uint64_t max_records = 0;  ///< in a node
  std::uint64_t max_below = 0;    ///< in a node and everything under it
  std::size_t pointer_size = 0;   ///< [bytes] of a pointer to a child
  std::size_t total_size = 0;     ///< [bytes] of that pointer's last field: records in the child and under it
};

class Walk2 {
 public:
  Walk2(File& file, const std::function<Result<void>(BTree2, Cursor)>& use) : file_(file), use_(use) {}

  Result<void> run(std::uint64_t address) {
    const Sizes sizes = file_.sizes;
    const std::size_t size = 4 + 1 + 1 + 4 + 2 + 2 + 1 + 1 + sizes.address + 2 + sizes.length + kChecksumSize;
    const auto block = MBK_TRY(file_.checked_block(address, size, "a B-tree"));
    Cursor in = file_.cursor(block);
    const bool known = in.is("BTHD") && in.byte() == 0;
    kind_ = static_cast<BTree2>(in.byte());
    node_size_ = in.dword();
    record_size_ = in.word();
    const std::size_t depth = in.word();
    in.skip(2);  // when nodes are split and merged
    const std::uint64_t root = in.address();
    const std::uint64_t records = in.word();
    if (!known || depth > kMaxDepth || record_size_ == 0 || !find_levels(depth)) {
      return damaged(fmt::format("the B-tree at byte {} is broken", address));
    }
    if (root == kUndefined) return {};  // nothing was put into it
    return node(root, depth, records);
  }

 private:
  /// How much the nodes of each level hold; false where that is nothing.
  bool find_levels(std::size_t depth) {
    if (node_size_ < kFrame + record_size_) return false;
    Level leaf;
    leaf.max_records = leaf.max_below = (node_size_ - kFrame) / record_size_;
    levels_ = {leaf};
    const std::size_t count_size = bytes_for(leaf.max_records);
    for (std::size_t i = 1; i <= depth; ++i) {
      const Level& below = levels_.back();
      Level level;
      level.total_size = i > 1 ? bytes_for(below.max_below) : 0;
      level.pointer_size = file_.sizes.address + count_size + level.total_size;
      if (level.total_size > 8 || node_size_ < kFrame + level.pointer_size) return false;
      level.max_records = (node_size_ - kFrame - level.pointer_size) / (record_size_ + level.pointer_size);
      if (level.max_records == 0 || !multiply(level.max_records + 1, below.max_below, level.max_below) ||
          __builtin_add_overflow(level.max_below, level.max_records, &level.max_below)) {
        return false;
      }
      levels_.push_back(level);
    }
    return true;
  }

  Result<void> node(std::uint64_t address, std::size_t depth, std::uint64_t records) {
    const Level& level = levels_[depth];
    const auto broken = [&] { return damaged(fmt::format("the B-tree node at byte {} is broken", address)); };
    if (records > level.max_records) return broken();
    const std::uint64_t pointers = depth > 0 ? (records + 1) * level.pointer_size : 0;
    const auto block =
        MBK_TRY(file_.checked_block(address, kFrame + records * record_size_ + pointers, "a B-tree node"));
    Cursor in = file_.cursor(block);
    const bool known = in.is(depth > 0 ? "BTIN" : "BTLF") && in.byte() == 0 && in.byte() == static_cast<int>(kind_);
    if (!known) return broken();
    Cursor record = file_.cursor(in.take(records * record_size_));
    for (std::uint64_t i = 0; i <= records; ++i) {
      if (depth > 0) {
        const std::uint64_t child = in.address();
        const std::uint64_t in_child = in.number(bytes_for(levels_.front().max_records));
        in.skip(level.total_size);
        MBK_TRY(node(child, depth - 1, in_child));
      }
      if (i == records) break;
      MBK_TRY(use_(kind_, file_.cursor(record.take(record_size_))));
    }
    return {};
  }

  File& file_;
  const std::function<Result<void>(BTree2, Cursor)>& use_;
  BTree2 kind_{};
  std::uint64_t node_size_ = 0;
  std::size_t record_size_ = 0;
  std::vector<Level> levels_;
};

}  // namespace

Result<void> for_each_record(File& file, std::uint64_t header, const std::function<Result<void>(BTree2, Cursor)>& use) {
  return Walk2(file, use).run(header);
}

}  // namespace mbk::hdf5
