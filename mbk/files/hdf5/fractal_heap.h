#pragma once

#include <map>
#include <vector>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// Where the links of large groups and many attributes are kept (specification, III.G).
class FractalHeap {
 public:
  /// @fails  the heap's header is broken, or its objects are packed by filters.
  [[nodiscard]] static Result<FractalHeap> open(File& file, std::uint64_t address);

  /// The object of an identifier.
  /// @fails  the identifier leads nowhere; a block on the way is broken.
  [[nodiscard]] Result<Bytes> object(File& file, Cursor id);

  [[nodiscard]] std::size_t id_size() const { return id_size_; }

 private:
  [[nodiscard]] bool plausible() const;
  Result<Bytes> managed(File& file, Cursor id);
  Result<Bytes> huge(File& file, Cursor id) const;
  Result<const std::vector<std::uint64_t>*> children(File& file, std::uint64_t address, std::uint64_t rows);
  Result<Bytes> direct_block(File& file, std::uint64_t address, std::uint64_t size);

  std::size_t id_size_ = 0;
  bool has_checksums_ = false;  ///< of direct blocks
  std::uint64_t largest_ = 0;   ///< [bytes] of a managed object
  std::uint64_t huge_tree_ = kUndefined;
  std::uint64_t width_ = 0;       ///< blocks in a row
  std::uint64_t start_ = 0;       ///< [bytes] of a block of the first row
  std::uint64_t max_direct_ = 0;  ///< [bytes] of the largest direct block
  unsigned bits_ = 0;             ///< of an offset into the heap
  std::uint64_t root_ = kUndefined;
  std::uint64_t rows_ = 0;                                        ///< of the root; 0: it is a direct block
  std::map<std::uint64_t, std::vector<std::uint64_t>> children_;  ///< of indirect blocks that were read
  std::map<std::uint64_t, Bytes> blocks_;                         ///< direct blocks that were read
};

}  // namespace mbk::hdf5
