#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mbk/files/hdf5/bytes.h"

struct libdeflate_decompressor;

namespace mbk::hdf5 {

/// How the chunks of a dataset are packed.
struct Filters {
  enum class Kind { deflate, shuffle, fletcher32, lzf };
  struct Step {
    Kind kind;
    std::uint32_t element_size;  ///< of shuffle
  };
  std::vector<Step> steps;  ///< in the order of writing
  std::string unread;       ///< of unsupported filters: "compressed with filter 32001"
};

/// A filter pipeline message (specification, IV.A.2.l).
/// @fails  it is broken.
[[nodiscard]] Result<Filters> read_filters(Cursor in);

/// Unpacks chunks of one dataset, one after the other, in buffers of its own.
class Unpacker {
 public:
  Unpacker(const Filters& filters, std::size_t chunk_bytes);

  /// The `chunk_bytes` of a chunk; they stay until the next call, in `stored` or here.
  /// @param skipped  bit i: filter i was not applied
  /// @fails  a checksum is wrong, the compressed data is broken, or more or less comes out.
  [[nodiscard]] Result<Bytes> unpack(Bytes stored, std::uint32_t skipped);

 private:
  Result<Bytes> undo(const Filters::Step& step, Bytes bytes);
  Result<Bytes> inflate(Bytes bytes);
  Result<Bytes> expand(Bytes bytes);
  Bytes unshuffle(Bytes bytes, std::size_t element_size);

  const Filters& filters_;
  std::size_t chunk_bytes_;
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor_;
  /// Bytes that are not zeroed first.
  struct Room {
    std::unique_ptr<std::byte[]> data;
    std::size_t size = 0;
    /// At least so many, with whatever stands there.
    std::span<std::byte> of(std::size_t bytes);
  };
  Room inflated_, expanded_, ordered_;
};

}  // namespace mbk::hdf5
