#include "mbk/files/hdf5/chunk_filters.h"

#include <fmt/format.h>
#include <libdeflate.h>

extern "C" {  // its author's header leaves that to who includes it
#include <liblzf/lzf.h>
}

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <new>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr unsigned kDeflate = 1, kShuffle = 2, kFletcher32 = 3, kSzip = 4, kFirstNamed = 256, kLzf = 32000;

/// Adds one filter; false if there are several of the kind.
bool add(Filters& filters, Filters::Kind kind, std::uint32_t element_size = 0) {
  for (const auto& step : filters.steps) {
    if (step.kind == kind) return false;
  }
  filters.steps.push_back({kind, element_size});
  return true;
}

constexpr std::size_t kUnsignedMost = std::numeric_limits<unsigned>::max();
constexpr std::size_t kDouble = 8, kTogether = 16;

typedef unsigned char Bytes16 __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

/// a0 b0 a1 b1 …: the lower and the upper half of it.
struct Interleaved {
  Bytes16 low, high;
  Interleaved(const Bytes16& a, const Bytes16& b)
      : low(__builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)),
        high(__builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)) {}
};

/// In shuffled data the first bytes of all elements come first, then all second bytes. Of elements of eight bytes,
/// sixteen at a time: planes that are four apart are interleaved, then those two apart, then neighbours.
/// @returns how many elements are done, a multiple of sixteen
std::size_t unshuffle_doubles(const std::byte* from, std::size_t count, std::byte* to) {
  std::size_t i = 0;
  for (; i + kTogether <= count; i += kTogether) {
    Bytes16 plane[kDouble], next[kDouble];
    for (std::size_t k = 0; k < kDouble; ++k) std::memcpy(&plane[k], from + k * count + i, kTogether);
    for (std::size_t step = kDouble / 2; step > 0; step /= 2) {
      // plane[k] holds, for a part of the elements, every byte whose number is k modulo 2·step
      for (std::size_t part = 0; part < kDouble / (2 * step); ++part) {
        for (std::size_t k = 0; k < step; ++k) {
          const Interleaved both(plane[part * 2 * step + k], plane[part * 2 * step + k + step]);
          next[2 * part * step + k] = both.low;
          next[(2 * part + 1) * step + k] = both.high;
        }
      }
      std::copy(std::begin(next), std::end(next), std::begin(plane));
    }
    for (std::size_t k = 0; k < kDouble; ++k) std::memcpy(to + (i * kDouble + k * kTogether), &plane[k], kTogether);
  }
  return i;
}

}  // namespace

std::span<std::byte> Unpacker::Room::of(std::size_t bytes) {
  if (size < bytes) {
    data = std::make_unique_for_overwrite<std::byte[]>(bytes);
    size = bytes;
  }
  return {data.get(), bytes};
}

Unpacker::Unpacker(const Filters& filters, std::size_t chunk_bytes)
    : filters_(filters), chunk_bytes_(chunk_bytes), decompressor_(nullptr, libdeflate_free_decompressor) {}

Result<Filters> read_filters(Cursor in) {
  const int version = in.byte();
  const unsigned count = in.byte();
  if (version == 1) in.skip(6);
  if ((version != 1 && version != 2) || count > 32) return damaged("its filters are broken");
  Filters filters;
  for (unsigned i = 0; i < count; ++i) {
    const unsigned id = in.word();
    const std::uint64_t name_size = version == 1 || id >= kFirstNamed ? in.word() : 0;
    in.skip(2);  // whether it may be left out
    const unsigned values = in.word();
    in.skip(version == 1 ? (name_size + 7) / 8 * 8 : name_size);
    const std::uint32_t first_value = values > 0 ? in.dword() : 0;
    in.skip(values > 0 ? 4 * (std::uint64_t{values} - 1) : 0);
    if (version == 1 && values % 2 == 1) in.skip(4);
    if (!in.ok()) return damaged("its filters are broken");
    bool once = true;
    if (id == kDeflate) {
      once = add(filters, Filters::Kind::deflate);
    } else if (id == kShuffle) {
      once = add(filters, Filters::Kind::shuffle, first_value);
    } else if (id == kFletcher32) {
      once = add(filters, Filters::Kind::fletcher32);
    } else if (id == kLzf) {
      once = add(filters, Filters::Kind::lzf);
    } else {
      filters.unread = id == kSzip ? "compressed with szip" : fmt::format("compressed with filter {}", id);
    }
    if (!once) filters.unread = fmt::format("compressed with filter {} twice", id);
  }
  return filters;
}

Result<Bytes> Unpacker::unpack(Bytes stored, std::uint32_t skipped) {
  Bytes bytes = stored;
  for (std::size_t i = filters_.steps.size(); i-- > 0;) {
    if ((skipped >> i & 1u) != 0) continue;
    bytes = MBK_TRY(undo(filters_.steps[i], bytes));
  }
  if (bytes.size() != chunk_bytes_) {
    return damaged(fmt::format("a chunk contains {} bytes instead of {}", bytes.size(), chunk_bytes_));
  }
  return bytes;
}

Result<Bytes> Unpacker::undo(const Filters::Step& step, Bytes bytes) {
  if (step.kind == Filters::Kind::deflate) return inflate(bytes);
  if (step.kind == Filters::Kind::lzf) return expand(bytes);
  if (step.kind == Filters::Kind::shuffle) return unshuffle(bytes, step.element_size);
  if (bytes.size() < kChecksumSize) return damaged("a chunk is shorter than its checksum");
  const Bytes body = bytes.first(bytes.size() - kChecksumSize);
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  if (Cursor(bytes.subspan(body.size())).dword() != fletcher32(body)) return damaged("a chunk has a wrong checksum");
#endif
  return body;
}

Result<Bytes> Unpacker::inflate(Bytes bytes) {
  if (decompressor_ == nullptr) decompressor_.reset(libdeflate_alloc_decompressor());
  if (decompressor_ == nullptr) throw std::bad_alloc();
  const auto inflated = inflated_.of(chunk_bytes_ + kChecksumSize);  // a checksum may have been packed with it
  std::size_t read = 0, size = 0;
  switch (libdeflate_zlib_decompress_ex(decompressor_.get(), bytes.data(), bytes.size(), inflated.data(),
                                        inflated.size(), &read, &size)) {
    case LIBDEFLATE_SUCCESS:
      return inflated.first(size);
    case LIBDEFLATE_INSUFFICIENT_SPACE:
      return damaged("the compressed data of a chunk expands beyond the chunk size");
    default:
      return damaged("the compressed data of a chunk is damaged or truncated");
  }
}

/// LZF, as h5py packs.
Result<Bytes> Unpacker::expand(Bytes bytes) {
  const auto expanded = expanded_.of(chunk_bytes_ + kChecksumSize);
  const unsigned size = bytes.size() > kUnsignedMost || expanded.size() > kUnsignedMost
                            ? 0
                            : lzf_decompress(bytes.data(), static_cast<unsigned>(bytes.size()), expanded.data(),
                                             static_cast<unsigned>(expanded.size()));
  if (size == 0)
    return damaged("the compressed data of a chunk is damaged, truncated, or expands beyond the chunk size");
  return expanded.first(size);
}

Bytes Unpacker::unshuffle(Bytes bytes, std::size_t element_size) {
  if (element_size <= 1 || bytes.size() / element_size <= 1) return bytes;
  const std::size_t count = bytes.size() / element_size;
  const auto ordered = ordered_.of(bytes.size());
  std::size_t done = element_size == kDouble ? unshuffle_doubles(bytes.data(), count, ordered.data()) : 0;
  for (; done < count; ++done) {
    for (std::size_t k = 0; k < element_size; ++k) ordered[done * element_size + k] = bytes[k * count + done];
  }
  const std::size_t elements = count * element_size;
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(elements), bytes.end(),
            ordered.begin() + static_cast<std::ptrdiff_t>(elements));
  return ordered;
}

}  // namespace mbk::hdf5
