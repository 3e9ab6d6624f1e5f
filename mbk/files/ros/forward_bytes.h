#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Bytes that are read from their begin to their end, of which only what was taken last is in memory.
class ForwardBytes {
 public:
  virtual ~ForwardBytes() = default;

  /// The next `count` bytes, or those that are left where the end comes first. They stand until more is taken.
  /// @fails  data: they cannot be read, or cannot be unpacked
  [[nodiscard]] Result<std::span<const std::byte>> take(std::size_t count);
  /// Leaves bytes out. False where the end comes first.
  [[nodiscard]] Result<bool> skip(std::uint64_t count);

  [[nodiscard]] std::uint64_t position() const { return position_; }  ///< bytes that were taken or left out
  /// CRC-32 (that of zlib) of what was taken or left out since `restart_crc`.
  [[nodiscard]] std::uint32_t crc() const { return crc_; }
  void restart_crc() { crc_ = 0; }

 protected:
  ForwardBytes() = default;
  ForwardBytes(const ForwardBytes&) = default;
  ForwardBytes& operator=(const ForwardBytes&) = default;
  /// What `take` gives.
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

/// Messages that are larger are left out.
inline constexpr std::uint64_t kLargestMessage = std::uint64_t{64} << 20;
/// What to do about a damaged file.
inline constexpr std::string_view kCopyAgain = "copy the file again from where it was recorded";

/// How chunks of bags and MCAP files are packed.
enum class Packing { none, zstd, lz4, bz2 };

/// What the bytes unpack to, piece by piece: no size that anything claims is believed.
/// @param packed  must outlive it
[[nodiscard]] std::unique_ptr<ForwardBytes> unpacked(Packing packing, ForwardBytes& packed);

}  // namespace mbk::recording
