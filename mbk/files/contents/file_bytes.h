#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/base/system/files.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::recording {

/// Returns bytes to their allocator.
struct FreeBytes {
  std::size_t mapped = 0;  ///< bytes; 0 where they are of the heap
  void operator()(std::byte* bytes) const;
};

/// Owned bytes that are not zeroed first. Many of them come from the system, and go back to it.
struct Buffer {
  using Free = FreeBytes;
  std::unique_ptr<std::byte[], Free> data;
  std::size_t size = 0;

  Buffer() = default;
  explicit Buffer(std::size_t n);
  [[nodiscard]] std::span<const std::byte> bytes() const { return {data.get(), size}; }
};

/// Largest file that is read: 8 GiB.
inline constexpr std::uint64_t kLargestFile = std::uint64_t{8} << 30;

/// Maximum memory [bytes] that contents of this size may claim. Deflate cannot expand by more than 1032.
[[nodiscard]] constexpr std::uint64_t largest_claim(std::uint64_t bytes) {
  return 1100 * bytes + (1 << 20);
}

/// The same for an archive, which is unpacked completely before it is examined: data that expand by more than 50 to
/// more than 512 MiB are not a recording, because their samples would hardly change.
[[nodiscard]] constexpr std::uint64_t largest_unpacked(std::uint64_t bytes) {
  constexpr std::uint64_t kAnyway = std::uint64_t{512} << 20;
  return std::min(largest_claim(bytes), std::max(kAnyway, 50 * bytes));
}

/// A file that is read sequentially, with only the current part in memory. The bytes are contiguous, as if all of them
/// were present.
class FileInPassing {
 public:
  static constexpr std::size_t kPiece = std::size_t{4} << 20;  ///< that is read at a time

  FileInPassing(FileInPassing&& other) noexcept;
  FileInPassing(const FileInPassing&) = delete;
  FileInPassing& operator=(const FileInPassing&) = delete;
  FileInPassing& operator=(FileInPassing&&) = delete;
  ~FileInPassing();

  [[nodiscard]] std::size_t size() const { return size_; }  ///< of the file
  /// What was read so far; what was forgotten of it is not to be read.
  [[nodiscard]] std::string_view text() const { return {data_, read_}; }
  /// Reads one piece more.
  /// @fails  data: the file cannot be read, or became shorter
  [[nodiscard]] Result<void> read_on();
  /// Releases the bytes before that position, except for the first piece.
  void forget(std::size_t before);

 private:
  friend class OpenFile;
  FileInPassing(int descriptor, std::size_t size, char* data, std::shared_ptr<Sha256> sum)
      : descriptor_(descriptor), size_(size), data_(data), sum_(std::move(sum)) {}
  /// Reads the next piece and adds it to the sum, beside whoever works on what is there.
  void read_ahead();
  void use_spare();

  int descriptor_;  ///< of the OpenFile
  std::size_t size_, read_ = 0, forgotten_ = kPiece;
  char* data_;             ///< as much room as the file needs, of which only what is written to takes memory
  char* spare_ = nullptr;  ///< a piece that was forgotten, in memory
  std::shared_ptr<Sha256> sum_;
  std::future<Result<void>> ahead_;  ///< of the piece behind what was read
};

/// A regular file that is opened only once. For one thread at a time.
class OpenFile {
 public:
  static constexpr std::size_t kBegin = std::size_t{64} << 10;

  /// @fails  data: missing, a folder or device, not readable, empty, larger than kLargestFile.
  [[nodiscard]] static Result<OpenFile> open(const std::filesystem::path& file);
  OpenFile(OpenFile&& other) noexcept;
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  OpenFile& operator=(OpenFile&&) = delete;
  ~OpenFile();

  [[nodiscard]] std::size_t size() const { return size_; }
  /// The first kBegin bytes, or all where there are fewer.
  [[nodiscard]] std::string_view begin() const { return begin_; }
  [[nodiscard]] std::span<const std::byte> begin_bytes() const { return std::as_bytes(std::span(begin_)); }

  /// The whole file, which stays in memory until `take` or the end of this.
  /// @fails  data: it cannot be read, became shorter, or there is not enough memory.
  [[nodiscard]] Result<std::shared_ptr<Buffer>> bytes();
  /// The same, so that it goes when its last user lets it go.
  [[nodiscard]] Result<std::shared_ptr<Buffer>> take();
  /// The file from its first byte on. This object must outlive it.
  /// @fails  data: it cannot be read.
  [[nodiscard]] Result<FileInPassing> in_passing();

  /// 64 hexadecimal digits, of bytes that were read to the end; "" before.
  [[nodiscard]] const std::string& sha256();

  /// Closes the file until it is read again: for callers with hundreds of files.
  void rest();

 private:
  OpenFile() = default;
  [[nodiscard]] Result<void> wake();

  std::filesystem::path path_;
  system::OpenFile file_;
  std::size_t size_ = 0;
  std::string begin_;
  std::shared_ptr<Buffer> bytes_;
  std::shared_ptr<Sha256> passing_sum_;
  std::string sum_;
};

/// The whole file.
/// @fails  as OpenFile
[[nodiscard]] Result<Buffer> read_file(const std::filesystem::path& file);

}  // namespace mbk::recording
