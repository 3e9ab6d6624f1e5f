#include "mbk/files/hdf5/chunk_array.h"

#include <fmt/format.h>

#include <bit>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr unsigned kMaxPageBits = 32;

constexpr std::string_view kWhat = "an index of chunks";

tl::unexpected<Error> broken_array(std::uint64_t address) {
  return damaged(fmt::format("the index of chunks at byte {} is broken", address));
}

unsigned log2_of(std::uint64_t value) {
  return static_cast<unsigned>(std::bit_width(value)) - 1;
}

/// Which pages of a data block were written: a bit for each, from the highest of each byte.
struct Pages {
  Bytes bits;
  std::uint64_t first = 0;  ///< bit of the block's first page

  [[nodiscard]] bool has(std::uint64_t page) const {
    const std::uint64_t at = first + page;
    if (at / 8 >= bits.size()) return false;
    return (std::to_integer<unsigned>(bits[static_cast<std::size_t>(at / 8)]) >> (7 - at % 8) & 1u) != 0;
  }
};

/// Shared by both kinds of arrays: blocks of elements; large ones are split into pages with a checksum each.
struct Array {
  File& file;
  bool packed;
  const ArrayElement& use;
  std::size_t element_size = 0;
  unsigned page_bits = 0;       ///< a page holds two to this elements
  std::size_t bitmap_size = 0;  ///< [bytes] that say which pages were written, where the data block holds them

  /// The next fields of a block: its signature, its version, and whose elements these are.
  [[nodiscard]] bool begins(Cursor& in, std::string_view signature) const {
    return in.is(signature) && in.byte() == 0 && in.byte() == (packed ? 1 : 0);
  }
  /// [bytes] of `begins` and of the address of the header, which follows in every block but the header.
  [[nodiscard]] std::size_t prefix_size() const { return 6 + file.sizes.address; }
  [[nodiscard]] bool element_size_is_possible() const {
    const std::size_t address = file.sizes.address;
    return packed ? element_size > address + 4 && element_size <= address + 12 : element_size == address;
  }

  Result<void> elements(Cursor& in, std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      MBK_TRY(use(first + i, file.cursor(in.take(element_size))));
    }
    return {};
  }

  /// A data block: in one piece, or in pages.
  /// @param extra    [bytes] between the prefix and the elements, or the pages
  /// @param written  which pages were written; empty: stated in the data block
  Result<void> data_block(std::uint64_t address, std::string_view signature, std::size_t extra, std::uint64_t first,
                          std::uint64_t count, Pages written) {
    const std::uint64_t per_page = std::uint64_t{1} << page_bits;
    const bool paged = count > per_page;
    const std::size_t head_size = prefix_size() + extra;
    std::uint64_t bytes = 0;
    if (!multiply(paged ? 0 : count, element_size, bytes) || bytes > file.bytes.size()) {
      return broken_array(address);
    }
    const auto block = MBK_TRY(file.checked_block(address, head_size + bytes + kChecksumSize, kWhat));
    Cursor in = file.cursor(block);
    if (!begins(in, signature)) return broken_array(address);
    in.skip(head_size - in.at());
    if (!paged) return elements(in, first, count);
    if (written.bits.empty()) written = {block.subspan(head_size - bitmap_size), 0};
    std::uint64_t page_address = address + head_size + kChecksumSize;
    for (std::uint64_t page = 0; page * per_page < count; ++page) {
      const std::uint64_t here = std::min(per_page, count - page * per_page);
      const std::uint64_t page_bytes = here * element_size + kChecksumSize;
      if (written.has(page)) {
        const auto stored = MBK_TRY(file.checked_block(page_address, page_bytes, kWhat));
        Cursor page_in = file.cursor(stored);
        MBK_TRY(elements(page_in, first + page * per_page, here));
      }
      page_address += page_bytes;
    }
    return {};
  }
};

struct FixedArray : Array {
  Result<void> read(std::uint64_t address) {
    const std::size_t size = 4 + 1 + 1 + 1 + 1 + file.sizes.length + file.sizes.address + kChecksumSize;
    const auto block = MBK_TRY(file.checked_block(address, size, kWhat));
    Cursor in = file.cursor(block);
    const bool known = begins(in, "FAHD");
    element_size = in.byte();
    page_bits = in.byte();
    const std::uint64_t count = in.length();
    const std::uint64_t data = in.address();
    if (!known || !element_size_is_possible() || page_bits > kMaxPageBits || count > file.bytes.size()) {
      return broken_array(address);
    }
    if (data == kUndefined) return {};
    const std::uint64_t per_page = std::uint64_t{1} << page_bits;
    const std::uint64_t pages = count > per_page ? (count - 1) / per_page + 1 : 0;
    bitmap_size = static_cast<std::size_t>((pages + 7) / 8);
    return data_block(data, "FADB", bitmap_size, 0, count, {});
  }
};

/// Super block u has 2^⌊u/2⌋ data blocks of 2^⌈u/2⌉ times the smallest number of elements.
struct ExtensibleArray : Array {
  unsigned bits = 0;               ///< of the largest index
  std::uint64_t in_index = 0;      ///< elements in the index block
  std::uint64_t least = 0;         ///< elements in the smallest data block
  std::uint64_t min_pointers = 0;  ///< data blocks of the first super block of its own

  Result<void> read(std::uint64_t address) {
    const std::size_t size = 4 + 1 + 1 + 6 + 6 * file.sizes.length + file.sizes.address + kChecksumSize;
    const auto block = MBK_TRY(file.checked_block(address, size, kWhat));
    Cursor in = file.cursor(block);
    const bool known = begins(in, "EAHD");
    element_size = in.byte();
    bits = in.byte();
    in_index = in.byte();
    least = in.byte();
    min_pointers = in.byte();
    page_bits = in.byte();
    in.skip(6 * file.sizes.length);  // statistics
    const std::uint64_t index = in.address();
    if (!known || !element_size_is_possible() || bits == 0 || bits > 64 || page_bits > kMaxPageBits ||
        !std::has_single_bit(least) || !std::has_single_bit(min_pointers) || log2_of(least) > bits) {
      return broken_array(address);
    }
    if (index == kUndefined) return {};
    return index_block(index);
  }

  [[nodiscard]] std::size_t offset_size() const { return (bits + 7) / 8; }
  [[nodiscard]] static std::uint64_t blocks_in(unsigned super) { return std::uint64_t{1} << super / 2; }
  [[nodiscard]] std::uint64_t elements_in(unsigned super) const { return least << (super + 1) / 2; }

  Result<void> index_block(std::uint64_t address) {
    const unsigned supers = 1 + bits - log2_of(least);
    const unsigned direct = std::min(supers, 2 * log2_of(min_pointers));  // super blocks without one of their own
    const std::uint64_t pointers = 2 * (min_pointers - 1) + (supers - direct);
    const std::uint64_t size = prefix_size() + in_index * element_size + pointers * file.sizes.address + kChecksumSize;
    const auto block = MBK_TRY(file.checked_block(address, size, kWhat));
    Cursor in = file.cursor(block);
    if (!begins(in, "EAIB")) return broken_array(address);
    in.address();  // of the header
    MBK_TRY(elements(in, 0, in_index));
    std::uint64_t first = in_index;
    for (unsigned super = 0; super < supers; ++super) {
      if (super >= direct) {
        const std::uint64_t secondary = in.address();
        if (secondary == kUndefined) {
          first += blocks_in(super) * elements_in(super);
        } else
          MBK_TRY(super_block(secondary, super, first));
        continue;
      }
      MBK_TRY(data_blocks(in, super, first, {}));
    }
    return {};
  }

  Result<void> super_block(std::uint64_t address, unsigned super, std::uint64_t& first) {
    const std::uint64_t pages = elements_in(super) >> page_bits;
    const std::uint64_t bitmap = pages > 1 ? (pages + 7) / 8 : 0;
    const std::size_t head_size = prefix_size() + offset_size();
    const std::uint64_t blocks = blocks_in(super);
    std::uint64_t size = 0;
    if (bitmap > file.bytes.size() || !multiply(blocks, bitmap + file.sizes.address, size) ||
        size > file.bytes.size()) {
      return broken_array(address);
    }
    const auto block = MBK_TRY(file.checked_block(address, head_size + size + kChecksumSize, kWhat));
    Cursor in = file.cursor(block);
    if (!begins(in, "EASB")) return broken_array(address);
    in.skip(head_size - in.at());
    return data_blocks(in, super, first, in.take(blocks * bitmap));
  }

  /// The data blocks whose addresses follow; their elements count from `first`, which is advanced.
  /// @param written  the bits of all their pages, without gaps: the room for them is rounded up for every block, but
  ///                 the library fills it from the start
  Result<void> data_blocks(Cursor& addresses, unsigned super, std::uint64_t& first, Bytes written) {
    const std::uint64_t count = elements_in(super);
    const std::uint64_t pages = count >> page_bits;
    for (std::uint64_t k = 0; k < blocks_in(super); ++k, first += count) {
      const std::uint64_t address = addresses.address();
      if (address == kUndefined) continue;
      if (written.empty() && pages > 1) return broken_array(address);
      MBK_TRY(data_block(address, "EADB", offset_size(), first, count, {written, k * pages}));
    }
    return {};
  }
};

}  // namespace

Result<void> for_each_fixed(File& file, std::uint64_t header, bool packed, const ArrayElement& use) {
  return FixedArray{{file, packed, use}}.read(header);
}

Result<void> for_each_extensible(File& file, std::uint64_t header, bool packed, const ArrayElement& use) {
  return ExtensibleArray{{file, packed, use}}.read(header);
}

}  // namespace mbk::hdf5
