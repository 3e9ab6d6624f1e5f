#include "mbk/files/hdf5/chunk_filters.h"

#include <fmt/format.h>
#include <zlib.h>

#include "mbk/files/hdf5/checksum.h"

namespace mbk::hdf5 {
namespace {

constexpr unsigned kDeflate = 1, kShuffle = 2, kFletcher32 = 3, kSzip = 4, kFirstNamed = 256;

/// Adds one filter; false where there are several of the kind.
bool add(Filters& filters, Filters::Kind kind, std::uint32_t element_size = 0) {
  for (const auto& step : filters.steps) {
    if (step.kind == kind) return false;
  }
  filters.steps.push_back({kind, element_size});
  return true;
}

}  // namespace

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
    } else {
      filters.unread = id == kSzip ? "packed by szip" : fmt::format("packed by filter {}", id);
    }
    if (!once) filters.unread = fmt::format("packed by filter {} twice", id);
  }
  return filters;
}

Result<Bytes> Unpacker::unpack(Bytes stored, std::uint32_t skipped) {
  Bytes bytes = stored;
  for (std::size_t i = filters_.steps.size(); i-- > 0;) {
    if ((skipped >> i & 1u) != 0) continue;
    const auto undone = undo(filters_.steps[i], bytes);
    if (!undone) return undone;
    bytes = *undone;
  }
  if (bytes.size() != chunk_bytes_) {
    return damaged(fmt::format("a chunk holds {} bytes where it should hold {}", bytes.size(), chunk_bytes_));
  }
  return bytes;
}

Result<Bytes> Unpacker::undo(const Filters::Step& step, Bytes bytes) {
  if (step.kind == Filters::Kind::deflate) return inflate(bytes);
  if (step.kind == Filters::Kind::shuffle) return unshuffle(bytes, step.element_size);
  if (bytes.size() < kChecksumSize) return damaged("a chunk is shorter than its checksum");
  const Bytes body = bytes.first(bytes.size() - kChecksumSize);
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  if (Cursor(bytes.subspan(body.size())).dword() != fletcher32(body)) return damaged("a chunk has a wrong checksum");
#endif
  return body;
}

Result<Bytes> Unpacker::inflate(Bytes bytes) {
  inflated_.resize(chunk_bytes_ + kChecksumSize);  // a checksum may have been packed with it
  uLongf size = inflated_.size();
  const int status = ::uncompress(reinterpret_cast<Bytef*>(inflated_.data()), &size,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  if (status != Z_OK) {
    return damaged(status == Z_BUF_ERROR ? "the compressed data of a chunk ends early, or holds more than the chunk"
                                         : "the compressed data of a chunk is damaged");
  }
  return Bytes(inflated_).first(size);
}

/// Shuffled, the first bytes of all elements stand first, then all the second bytes. Bytes that fill no element follow
/// as they are.
Bytes Unpacker::unshuffle(Bytes bytes, std::size_t element_size) {
  if (element_size <= 1 || bytes.size() / element_size <= 1) return bytes;
  const std::size_t count = bytes.size() / element_size;
  ordered_.assign(bytes.begin(), bytes.end());
  for (std::size_t k = 0; k < element_size; ++k) {
    const Bytes plane = bytes.subspan(k * count, count);
    for (std::size_t i = 0; i < count; ++i) ordered_[i * element_size + k] = plane[i];
  }
  return ordered_;
}

}  // namespace mbk::hdf5
