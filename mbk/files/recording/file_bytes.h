#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Owned bytes that are not zeroed first.
struct Buffer {
  std::unique_ptr<std::byte[]> data;
  std::size_t size = 0;

  Buffer() = default;
  explicit Buffer(std::size_t n) : data(std::make_unique_for_overwrite<std::byte[]>(n)), size(n) {}
  [[nodiscard]] std::span<const std::byte> bytes() const { return {data.get(), size}; }
};

/// Largest file that is read: 8 GiB.
inline constexpr std::uint64_t kLargestFile = std::uint64_t{8} << 30;

/// The most memory [bytes] that contents of so many bytes may claim. Deflate cannot expand by more than 1032.
[[nodiscard]] constexpr std::uint64_t largest_claim(std::uint64_t bytes) {
  return 1100 * bytes + (1 << 20);
}

/// The whole file.
/// @fails  data: missing, a directory or device, not readable, empty, larger than kLargestFile.
[[nodiscard]] Result<Buffer> read_file(const std::filesystem::path& file);

}  // namespace mbk::recording
