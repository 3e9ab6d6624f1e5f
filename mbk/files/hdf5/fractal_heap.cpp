#include "mbk/files/hdf5/fractal_heap.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "mbk/files/hdf5/btree2.h"
#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

unsigned log2_of(std::uint64_t value) {
  return static_cast<unsigned>(std::bit_width(value)) - 1;
}

tl::unexpected<Error> broken() {
  return damaged("a fractal heap is broken");
}

/// The checksum of a direct block precedes its objects and is that of the whole block with zeros in its place.
bool own_checksum_is_right([[maybe_unused]] Bytes block, [[maybe_unused]] Cursor at_checksum) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  return true;
#else
  const std::size_t at = at_checksum.at();
  const std::uint32_t stored = at_checksum.dword();
  if (!at_checksum.ok()) return false;
  std::vector<std::byte> cleared(block.begin(), block.end());
  std::fill_n(cleared.begin() + static_cast<std::ptrdiff_t>(at), kChecksumSize, std::byte{0});
  return lookup3(cleared) == stored;
#endif
}

/// A table of blocks: `width` of them in a row, those of the first two rows equally large, then twice as large in
/// every row.
struct Place {
  std::uint64_t row;
  std::uint64_t column;
  std::uint64_t block_start;  ///< [bytes] from the start of the table
  std::uint64_t block_size;
};

Place place_of(std::uint64_t offset, std::uint64_t width, std::uint64_t start) {
  const std::uint64_t first_row = width * start;
  if (offset < first_row) return {0, offset / start, offset / start * start, start};
  const unsigned doublings = log2_of(offset / first_row);
  const std::uint64_t row_start = first_row << doublings;
  const std::uint64_t size = start << doublings;
  const std::uint64_t column = (offset - row_start) / size;
  return {doublings + std::uint64_t{1}, column, row_start + column * size, size};
}

}  // namespace

Result<FractalHeap> FractalHeap::open(File& file, std::uint64_t address) {
  const Sizes sizes = file.sizes;
  const std::size_t size =
      4 + 1 + 2 + 2 + 1 + 4 + 12 * sizes.length + 3 * sizes.address + 2 + 2 + 2 + 2 + kChecksumSize;
  const auto prefix = MBK_TRY(file.from(address, size, "a fractal heap"));
  Cursor in = file.cursor(prefix);
  FractalHeap heap;
  const bool known = in.is("FRHP") && in.byte() == 0;
  heap.id_size_ = in.word();
  const bool filtered = in.word() != 0;
  heap.has_checksums_ = (in.byte() & 2u) != 0;
  if (!known) return broken();
  if (filtered)
    return bad_data("a fractal heap is compressed with filters, which is not supported", "write it without filters");
  if (!checksum_is_right(prefix.first(size))) return damaged("a fractal heap has a wrong checksum");
  heap.largest_ = in.dword();
  in.length();  // the next huge object
  heap.huge_tree_ = in.address();
  in.length();                // free space
  in.address();               // its manager
  in.skip(8 * sizes.length);  // statistics
  heap.width_ = in.word();
  heap.start_ = in.length();
  heap.max_direct_ = in.length();
  heap.bits_ = in.word();
  in.skip(2);  // rows at the start
  heap.root_ = in.address();
  heap.rows_ = in.word();
  if (!heap.plausible()) return broken();
  return heap;
}

bool FractalHeap::plausible() const {
  std::uint64_t first_row = 0;
  return std::has_single_bit(width_) && std::has_single_bit(start_) && std::has_single_bit(max_direct_) &&
         max_direct_ >= start_ && bits_ > 0 && bits_ <= 64 && rows_ <= 64 && id_size_ > 1 &&
         multiply(width_, start_, first_row);
}

Result<Bytes> FractalHeap::object(File& file, Cursor id) {
  constexpr unsigned kManaged = 0, kHuge = 1;
  const unsigned first = id.byte();
  const unsigned kind = first >> 4u & 3u;
  if (first >> 6u != 0) return broken();
  if (kind == kManaged) return managed(file, id);
  if (kind == kHuge) return huge(file, id);
  return broken();  // links and attributes are never so small that they fit into their identifiers
}

Result<Bytes> FractalHeap::managed(File& file, Cursor id) {
  const std::uint64_t offset = id.number((bits_ + 7) / 8);
  const std::size_t length_size = std::min<std::size_t>((log2_of(max_direct_) + 7) / 8, bytes_for(largest_));
  const std::uint64_t length = id.number(length_size);
  if (!id.ok() || root_ == kUndefined) return broken();
  std::uint64_t address = root_;
  std::uint64_t inside = offset;  // the block at `address`
  std::uint64_t size = start_;
  const std::uint64_t direct_rows = log2_of(max_direct_ / start_) + std::uint64_t{2};
  for (std::uint64_t rows = rows_; rows > 0;) {
    const Place place = place_of(inside, width_, start_);
    if (place.row >= rows) return broken();
    const auto blocks = MBK_TRY(children(file, address, rows));
    address = (*blocks)[static_cast<std::size_t>(place.row * width_ + place.column)];
    inside -= place.block_start;
    size = place.block_size;
    if (place.row < direct_rows) break;
    if (size < width_ * start_) return broken();
    rows = log2_of(size) - log2_of(width_ * start_) + std::uint64_t{1};  // fewer than before: this ends
  }
  if (inside > size || length > size - inside) return broken();
  const auto block = MBK_TRY(direct_block(file, address, size));
  return block.subspan(static_cast<std::size_t>(inside), static_cast<std::size_t>(length));
}

Result<const std::vector<std::uint64_t>*> FractalHeap::children(File& file, std::uint64_t address, std::uint64_t rows) {
  if (const auto known = children_.find(address); known != children_.end()) {
    if (known->second.size() != rows * width_) return broken();
    return &known->second;
  }
  const std::size_t prefix = 4 + 1 + file.sizes.address + (bits_ + 7) / 8;
  const std::uint64_t size = prefix + rows * width_ * file.sizes.address + kChecksumSize;
  const auto block = MBK_TRY(file.checked_block(address, size, "a block of a fractal heap"));
  Cursor in = file.cursor(block);
  const bool known = in.is("FHIB") && in.byte() == 0;
  if (!known) return broken();
  in.skip(prefix - 5);
  std::vector<std::uint64_t>& found = children_[address];
  while (found.size() < rows * width_) found.push_back(in.address());
  return &found;
}

Result<Bytes> FractalHeap::direct_block(File& file, std::uint64_t address, std::uint64_t size) {
  if (const auto known = blocks_.find(address); known != blocks_.end()) {
    if (known->second.size() != size) return broken();
    return known->second;
  }
  const auto block = file.block(address, size, "a block of a fractal heap");
  if (!block) return block;
  Cursor in = file.cursor(*block);
  const bool known = in.is("FHDB") && in.byte() == 0;
  in.skip(file.sizes.address + (bits_ + 7) / 8);
  if (!known || (has_checksums_ && !own_checksum_is_right(*block, in))) return broken();
  blocks_.emplace(address, *block);
  return block;
}

Result<Bytes> FractalHeap::huge(File& file, Cursor id) const {
  const Sizes sizes = file.sizes;
  if (id_size_ > sizes.address + sizes.length) {  // the identifier has room to say where it is
    const std::uint64_t address = id.address();
    return file.block(address, id.length(), "a large object of a fractal heap");
  }
  const std::uint64_t requested = id.number(std::min(id_size_ - 1, sizes.length));
  std::uint64_t address = kUndefined;
  std::uint64_t length = 0;
  MBK_TRY(for_each_record(file, huge_tree_, [&](BTree2 kind, Cursor record) -> Result<void> {
    const std::uint64_t at = record.address();
    const std::uint64_t size = record.length();
    if (kind != BTree2::huge_objects) return broken();
    if (record.length() == requested && record.ok()) address = at, length = size;
    return {};
  }));
  return file.block(address, length, "a large object of a fractal heap");
}

}  // namespace mbk::hdf5
