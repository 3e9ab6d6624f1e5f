#include "mbk/files/hdf5/chunk_index.h"

#include <algorithm>

#include "mbk/files/hdf5/btree1.h"
#include "mbk/files/hdf5/btree2.h"
#include "mbk/files/hdf5/chunk_array.h"

namespace mbk::hdf5 {
namespace {

using IndexKind = ChunkIndex::Kind;

class IndexReader {
 public:
  IndexReader(File& file, const ChunkIndex& index, const Dataspace& space, bool packed, std::uint64_t chunk_bytes,
              const std::function<Result<void>(const Chunk&)>& use)
      : file_(file), index_(index), space_(space), packed_(packed), chunk_bytes_(chunk_bytes), use_(use) {}

  Result<void> read() {
    switch (index_.kind) {
      case IndexKind::btree1:
        return btree1();
      case IndexKind::btree2:
        return btree2();
      case IndexKind::single:
        return use_({std::vector<std::uint64_t>(rank()), index_.address, index_.single_size.value_or(chunk_bytes_),
                     index_.single_skipped});
      case IndexKind::implicit:
        return implicit();
      case IndexKind::fixed_array:
        number_chunks(rank());
        return for_each_fixed(file_, index_.address, packed_, element());
      case IndexKind::extensible_array:
        number_chunks(static_cast<std::size_t>(std::ranges::find(space_.maximum, kUndefined) - space_.maximum.begin()));
        return for_each_extensible(file_, index_.address, packed_, element());
    }
    return {};
  }

 private:
  [[nodiscard]] std::size_t rank() const { return index_.chunk.size(); }

  static tl::unexpected<Error> broken() { return damaged("its index of chunks is broken"); }

  /// Keys: size, skipped filters, and where the chunk begins, with a 0 for the bytes of an element.
  Result<void> btree1() {
    return for_each_child(file_, index_.address, BTree1::chunks, 8 + 8 * (rank() + 1),
                          [&](Cursor key, std::uint64_t address) -> Result<void> {
                            Chunk chunk;
                            chunk.address = address;
                            chunk.size = key.dword();
                            chunk.skipped = key.dword();
                            for (const std::uint64_t along : index_.chunk) {
                              const std::uint64_t start = key.number(8);
                              if (start % along != 0) return broken();
                              chunk.place.push_back(start / along);
                            }
                            return key.ok() ? use_(chunk) : broken();
                          });
  }

  /// Address, and where chunks are packed size and skipped filters.
  bool read_entry(Cursor& in, std::size_t entry_size, Chunk& chunk) const {
    const std::size_t address_size = file_.sizes.address;
    chunk.address = in.address();
    chunk.size = chunk_bytes_;
    if (!packed_) return in.ok() && entry_size == address_size;
    if (entry_size <= address_size + 4 || entry_size > address_size + 4 + 8) return false;
    chunk.size = in.number(entry_size - address_size - 4);
    chunk.skipped = in.dword();
    return in.ok();
  }

  Result<void> btree2() {
    return for_each_record(file_, index_.address, [&](BTree2 kind, Cursor record) -> Result<void> {
      const std::size_t place_size = 8 * rank();
      if (kind != (packed_ ? BTree2::packed_chunks : BTree2::chunks) || record.left() <= place_size) return broken();
      Chunk chunk;
      if (!read_entry(record, record.left() - place_size, chunk)) return broken();
      for (std::size_t i = 0; i < rank(); ++i) chunk.place.push_back(record.number(8));
      return record.ok() ? use_(chunk) : broken();
    });
  }

  /// Arrays number the chunks as far as the dataset may grow, the last dimension fastest. The one that may grow
  /// without limit counts as the slowest.
  /// @param unlimited  which one that is; the rank where there is none
  void number_chunks(std::size_t unlimited) {
    if (unlimited < rank()) order_.push_back(unlimited);
    for (std::size_t i = 0; i < rank(); ++i) {
      if (i != unlimited) order_.push_back(i);
    }
  }

  [[nodiscard]] std::uint64_t max_along(std::size_t dimension) const {
    const std::uint64_t most = space_.maximum[dimension];
    return most == 0 ? 1 : (most - 1) / index_.chunk[dimension] + 1;
  }

  [[nodiscard]] std::vector<std::uint64_t> place_of(std::uint64_t number) const {
    std::vector<std::uint64_t> place(rank());
    for (std::size_t k = order_.size(); k-- > 1;) {
      place[order_[k]] = number % max_along(order_[k]);
      number /= max_along(order_[k]);
    }
    place[order_.front()] = number;
    return place;
  }

  [[nodiscard]] ArrayElement element() const {
    return [this](std::uint64_t number, Cursor in) -> Result<void> {
      Chunk chunk;
      if (!read_entry(in, in.left(), chunk)) return broken();
      if (chunk.address == kUndefined) return {};
      chunk.place = place_of(number);
      return use_(chunk);
    };
  }

  /// The chunks follow each other in the order of their numbers.
  Result<void> implicit() {
    if (packed_) return broken();
    number_chunks(rank());
    std::uint64_t count = 1;
    for (std::size_t i = 0; i < rank(); ++i) {
      if (!multiply(count, max_along(i), count)) return broken();
    }
    std::uint64_t bytes = 0;
    if (!multiply(count, chunk_bytes_, bytes) || bytes > file_.bytes.size()) {
      return damaged("it claims more chunks than a file of this size can contain");
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      MBK_TRY(use_({place_of(i), index_.address + i * chunk_bytes_, chunk_bytes_, 0}));
    }
    return {};
  }

  File& file_;
  const ChunkIndex& index_;
  const Dataspace& space_;
  bool packed_;
  std::uint64_t chunk_bytes_;
  const std::function<Result<void>(const Chunk&)>& use_;
  std::vector<std::size_t> order_;  ///< dimensions, slowest first
};

}  // namespace

Result<void> for_each_chunk(File& file, const ChunkIndex& index, const Dataspace& space, bool packed,
                            std::uint64_t chunk_bytes, const std::function<Result<void>(const Chunk&)>& use) {
  return IndexReader(file, index, space, packed, chunk_bytes, use).read();
}

}  // namespace mbk::hdf5
