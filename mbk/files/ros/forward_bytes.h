#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Bytes that are read sequentially, with only the last piece in memory.
class ForwardBytes {
 public:
  virtual ~ForwardBytes() = default;

  /// The next `count` bytes, or fewer at the end. They are valid until the next call.
  /// @fails  data: they cannot be read, or cannot be unpacked
  [[nodiscard]] Result<std::span<const std::byte>> take(std::size_t count);
  /// Skips bytes. False if the end comes first.
  [[nodiscard]] Result<bool> skip(std::uint64_t count);

  [[nodiscard]] std::uint64_t position() const { return position_; }  ///< bytes taken or skipped
  /// CRC-32 (that of zlib) of the bytes taken or skipped since `restart_crc`.
  [[nodiscard]] std::uint32_t crc() const { return crc_; }
  void restart_crc() { crc_ = 0; }

 protected:
  ForwardBytes() = default;
  ForwardBytes(const ForwardBytes&) = default;
  ForwardBytes& operator=(const ForwardBytes&) = default;
  /// The result of `take`.
  [[nodiscard]] virtual Result<std::span<const std::byte>> next(std::size_t count) = 0;

 private:
  std::uint64_t position_ = 0;
  std::uint32_t crc_ = 0;
};

/// Bytes that are in memory.
class GivenBytes : public ForwardBytes {
 public:
  explicit GivenBytes(std::span<const std::byte> bytes) : bytes_(bytes) {}

 private:
  Result<std::span<const std::byte>> next(std::size_t count) override;
  std::span<const std::byte> bytes_;
};

/// Those of a file.
class PassingBytes : public ForwardBytes {
 public:
  explicit PassingBytes(FileInPassing& file) : file_(&file) {}

 private:
  Result<std::span<const std::byte>> next(std::size_t count) override;
  FileInPassing* file_;
};

/// The next `size` bytes of others.
class PartOfBytes : public ForwardBytes {
 public:
  PartOfBytes(ForwardBytes& whole, std::uint64_t size) : whole_(&whole), left_(size) {}
  [[nodiscard]] std::uint64_t left() const { return left_; }

 private:
  Result<std::span<const std::byte>> next(std::size_t count) override;
  ForwardBytes* whole_;
  std::uint64_t left_;
};

/// Larger messages are omitted.
inline constexpr std::uint64_t kLargestMessage = std::uint64_t{64} << 20;
/// Remedy for a damaged file.
inline constexpr std::string_view kCopyAgain = "copy the file again from where it was recorded";

/// Compression of chunks of bags and MCAP files.
enum class Packing { none, zstd, lz4, bz2 };

/// The unpacked bytes, piece by piece, without relying on any stated size.
/// @param packed  must outlive it
[[nodiscard]] std::unique_ptr<ForwardBytes> unpacked(Packing packing, ForwardBytes& packed);

}  // namespace mbk::recording
