#pragma once

#include <map>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// Where texts of variable length are kept (specification, III.E). Every collection is taken apart once.
class GlobalHeap {
 public:
  /// @fails  the collection is broken, or holds no object of that number.
  [[nodiscard]] Result<Bytes> object(File& file, std::uint64_t collection, std::uint64_t number);

 private:
  using Collection = std::map<std::uint64_t, Bytes>;

  static Result<Collection> read(File& file, std::uint64_t address);

  std::map<std::uint64_t, Collection> collections_;
};

}  // namespace mbk::hdf5
