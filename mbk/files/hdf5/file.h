#pragma once

#include "mbk/files/hdf5/bytes.h"
#include "mbk/files/hdf5/read_hdf5.h"

namespace mbk::hdf5 {

/// What reading one file may still cost. Structures of a damaged file can point at each other, so every byte looked at
/// and every byte kept counts.
class Budget {
 public:
  explicit Budget(const ReadLimits& limits);

  /// Memory that the tree takes: `count` things of `each` bytes.
  [[nodiscard]] Result<void> keep(std::uint64_t count, std::uint64_t each);
  /// Memory that is given back soon.
  [[nodiscard]] Result<void> borrow(std::uint64_t bytes) const;
  /// Bytes looked at, or made by a filter.
  [[nodiscard]] Result<void> work(std::uint64_t bytes);
  /// One object more.
  /// @param path_size  [bytes]
  [[nodiscard]] Result<void> object(std::uint64_t path_size);
  /// Whether it is used up, so that nothing more of the file can be read, whatever its state.
  [[nodiscard]] bool is_spent() const { return spent_; }

 private:
  std::uint64_t limit_;
  std::uint64_t memory_, available_;
  std::uint64_t work_;
  int objects_;
  int max_objects_;
  bool spent_ = false;
};

/// The bytes of a file between its base address and its end, and what reading them has cost.
struct File {
  Bytes bytes;
  Sizes sizes;
  Budget budget;

  /// The `size` bytes at an address.
  /// @param what  for the message: "the object header"
  [[nodiscard]] Result<Bytes> block(std::uint64_t address, std::uint64_t size, std::string_view what);

  /// The bytes from an address to the end of the file, of which the caller knows only later how many it needs. Only
  /// `least` are counted as work.
  [[nodiscard]] Result<Bytes> from(std::uint64_t address, std::uint64_t least, std::string_view what);

  /// A block whose last four bytes are the checksum of the others, without them.
  [[nodiscard]] Result<Bytes> checked_block(std::uint64_t address, std::uint64_t size, std::string_view what);

  [[nodiscard]] Cursor cursor(Bytes block) const { return Cursor(block, sizes); }
};

}  // namespace mbk::hdf5
