#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::recording {

/// Gives bytes back to where they came from.
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

/// The most memory [bytes] that contents of so many bytes may claim. Deflate cannot expand by more than 1032.
[[nodiscard]] constexpr std::uint64_t largest_claim(std::uint64_t bytes) {
  return 1100 * bytes + (1 << 20);
}

/// A file that is read from its begin to its end, of which only the part that is worked on is in memory. The bytes
/// stand one behind the other, as if all of them were there.
class FileInPassing {
 public:
  static constexpr std::size_t kPiece = std::size_t{4} << 20;  ///< that is read at a time

  /// @fails  as read_file
  [[nodiscard]] static Result<FileInPassing> open(const std::filesystem::path& file);
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
  /// The bytes before that place are needed no more, but for the first piece.
  void forget(std::size_t before);
  /// Of the whole file, which must have been read.
  [[nodiscard]] std::string sha256() { return sum_->hex(); }

 private:
  FileInPassing(int descriptor, std::size_t size, char* data) : descriptor_(descriptor), size_(size), data_(data) {}
  /// Reads the next piece and adds it to the sum, beside whoever works on what is there.
  void read_ahead();
  void use_spare();

  int descriptor_;
  std::size_t size_, read_ = 0, forgotten_ = kPiece;
  char* data_;             ///< as much room as the file needs, of which only what is written to takes memory
  char* spare_ = nullptr;  ///< a piece that was forgotten, in memory
  std::unique_ptr<Sha256> sum_ = std::make_unique<Sha256>();
  std::future<Result<void>> ahead_;  ///< of the piece behind what was read
};

/// The first bytes of a file, or as many as it has; none of what is no file, or cannot be read.
[[nodiscard]] std::string begin_of(const std::filesystem::path& file, std::size_t count);

/// The whole file.
/// @fails  data: missing, a directory or device, not readable, empty, larger than kLargestFile.
[[nodiscard]] Result<Buffer> read_file(const std::filesystem::path& file);

}  // namespace mbk::recording
