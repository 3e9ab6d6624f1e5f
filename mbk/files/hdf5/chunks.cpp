#include "mbk/files/hdf5/chunks.h"

#include <fmt/format.h>

#include <algorithm>

#include "mbk/files/hdf5/chunk_index.h"

namespace mbk::hdf5 {
namespace {

/// Deflate cannot expand by more than 1032.
constexpr std::uint64_t kMaxExpansion = 1100;
constexpr std::uint64_t kSlack = 256;  ///< [bytes] of compressed data that say nothing

class ChunkReader {
 public:
  ChunkReader(File& file, const ChunkIndex& index, const Filters& filters, const Dataspace& space, Elements& elements)
      : file_(file), index_(index), filters_(filters), space_(space), elements_(elements) {}

  Result<void> read() {
    MBK_TRY(measure());
    MBK_TRY(for_each_chunk(file_, index_, space_, !filters_.steps.empty(), chunk_bytes_,
                           [&](const Chunk& c) { return add(c); }));
    if (chunks_.size() != seen_.size()) return damaged("a part of it was never written");
    MBK_TRY(elements_.allocate(space_.count));
    Unpacker unpacker(filters_, static_cast<std::size_t>(chunk_bytes_));
    for (const Chunk& chunk : chunks_) {
      MBK_TRY(unpack(chunk, unpacker));
    }
    return {};
  }

 private:
  /// The shape of the chunks, and how many there must be.
  Result<void> measure() {
    const std::size_t rank = space_.shape.size();
    if (index_.chunk.size() != rank || index_.element_size != elements_.bytes_each()) {
      return damaged("its chunks do not match its shape and type");
    }
    chunk_bytes_ = index_.element_size;
    std::uint64_t total = 1;
    bool fits = true;
    for (std::size_t i = 0; i < rank; ++i) {
      along_.push_back((space_.shape[i] - 1) / index_.chunk[i] + 1);
      fits = fits && multiply(total, along_[i], total) && multiply(chunk_bytes_, index_.chunk[i], chunk_bytes_);
    }
    // Every chunk has at least a byte in the file, or an entry in the index.
    if (!fits || total > file_.bytes.size())
      return damaged("it claims more chunks than a file of this size can contain");
    MBK_TRY(file_.budget.borrow(chunk_bytes_));
    seen_.resize(static_cast<std::size_t>(total));
    return {};
  }

  Result<void> add(const Chunk& chunk) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < along_.size(); ++i) {
      if (chunk.place[i] >= along_[i]) return {};  // of a time when the dataset was larger
      number = number * along_[i] + chunk.place[i];
    }
    if (seen_[static_cast<std::size_t>(number)]) return damaged("a chunk occurs twice");
    seen_[static_cast<std::size_t>(number)] = true;
    if (chunk_bytes_ / kMaxExpansion > chunk.size + kSlack)
      return damaged("a chunk claims more bytes than its chunk size allows");
    chunks_.push_back(chunk);
    return {};
  }

  Result<void> unpack(const Chunk& chunk, Unpacker& unpacker) {
    const auto stored = MBK_TRY(file_.block(chunk.address, chunk.size, "a chunk"));
    MBK_TRY(file_.budget.work(chunk_bytes_ * (1 + filters_.steps.size())));
    const bool plain_edge = !index_.whole_edges && reaches_beyond(chunk);
    const std::uint32_t skipped = plain_edge ? ~std::uint32_t{0} : chunk.skipped;
    const auto bytes = MBK_TRY(unpacker.unpack(stored, skipped));
    return put(chunk, bytes);
  }

  [[nodiscard]] bool reaches_beyond(const Chunk& chunk) const {
    for (std::size_t i = 0; i < along_.size(); ++i) {
      if ((chunk.place[i] + 1) * index_.chunk[i] > space_.shape[i]) return true;
    }
    return false;
  }

  /// Puts the part of a chunk that lies within the dataset, run by run along the last dimension.
  Result<void> put(const Chunk& chunk, Bytes bytes) {
    const std::size_t rank = along_.size();
    std::vector<std::uint64_t> start(rank);
    std::vector<std::uint64_t> extent(rank);
    for (std::size_t i = 0; i < rank; ++i) {
      start[i] = chunk.place[i] * index_.chunk[i];
      extent[i] = std::min(index_.chunk[i], space_.shape[i] - start[i]);
    }
    const std::size_t run = static_cast<std::size_t>(extent.back() * index_.element_size);
    std::vector<std::uint64_t> at(rank);  // within the chunk
    for (;;) {
      std::uint64_t from = 0;
      std::uint64_t to = 0;
      for (std::size_t i = 0; i < rank; ++i) {
        from = from * index_.chunk[i] + at[i];
        to = to * space_.shape[i] + start[i] + at[i];
      }
      const Bytes elements = bytes.subspan(static_cast<std::size_t>(from * index_.element_size), run);
      MBK_TRY(elements_.put(to, elements));
      std::size_t i = rank - 1;  // the last dimension is done: on in the one before it
      do {
        if (i == 0) return {};
        at[i] = 0;
        --i;
      } while (++at[i] == extent[i]);
    }
  }

  File& file_;
  const ChunkIndex& index_;
  const Filters& filters_;
  const Dataspace& space_;
  Elements& elements_;
  std::uint64_t chunk_bytes_ = 0;
  std::vector<std::uint64_t> along_;  ///< chunks along each dimension
  std::vector<bool> seen_;
  std::vector<Chunk> chunks_;
};

}  // namespace

Result<void> read_chunks(File& file, const ChunkIndex& index, const Filters& filters, const Dataspace& space,
                         Elements& elements) {
  return ChunkReader(file, index, filters, space, elements).read();
}

}  // namespace mbk::hdf5
