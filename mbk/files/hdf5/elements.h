#pragma once

#include "mbk/files/hdf5/dataspace.h"
#include "mbk/files/hdf5/datatype.h"
#include "mbk/files/hdf5/file.h"
#include "mbk/files/hdf5/global_heap.h"
#include "mbk/files/hdf5/tree.h"

namespace mbk::hdf5 {

/// The elements of one dataset or attribute, decoded as their bytes come in, in whatever order.
class Elements {
 public:
  /// @param type  of a kind that is read; must outlive this
  Elements(File& file, GlobalHeap& heap, const Datatype& type);

  /// Makes room. @fails  the budget does not allow so many elements.
  [[nodiscard]] Result<void> allocate(std::uint64_t count);

  [[nodiscard]] std::uint64_t bytes_each() const { return type_.size; }

  /// Decodes whole elements.
  /// @param first  index of the first of them, in the order of the file; all lie within the allocated count
  [[nodiscard]] Result<void> put(std::uint64_t first, Bytes bytes);

  /// What was decoded: Numbers or Texts; where the elements are arrays, with their dimensions behind the shape's.
  /// References come out as null; `addresses` says where they point.
  [[nodiscard]] Value value(std::vector<std::uint64_t> shape);
  /// What was decoded of a compound type, column by column. Columns of references are not read.
  [[nodiscard]] Group table(const std::vector<std::uint64_t>& shape);
  [[nodiscard]] std::vector<std::uint64_t> addresses() { return std::move(addresses_); }

 private:
  Result<void> put_texts(std::size_t first, Bytes bytes);
  Result<void> put_columns(std::uint64_t first, Bytes bytes);
  Result<std::string> long_text(Bytes element);

  File& file_;
  GlobalHeap& heap_;
  const Datatype& type_;
  Vector numbers_;
  Rests rests_;
  Texts texts_;
  std::vector<std::uint64_t> addresses_;
  std::vector<Elements> columns_;    ///< of a compound type, in the order of its members
  std::vector<std::byte> gathered_;  ///< bytes of one column
};

}  // namespace mbk::hdf5
