#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace mbk::recording {

/// SHA-256 of the bytes (FIPS 180-4, 2015, §6.2) as 64 hexadecimal digits. Uses the processor's SHA instructions where
/// it has them.
[[nodiscard]] std::string sha256(std::span<const std::byte> bytes);

/// The same of bytes that come piece by piece.
class Sha256 {
 public:
  void add(std::span<const std::byte> bytes);
  /// Of all that was added, which nothing can be added to afterwards.
  [[nodiscard]] std::string hex();

 private:
  // First 32 bits of the fractional parts of the square roots of the first 8 primes (§5.3.3).
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, 64> pending_{};  ///< what is left of a whole block
  std::uint64_t bytes_ = 0;
};

namespace detail {
/// The same by plain arithmetic, on any processor.
[[nodiscard]] std::string sha256_portable(std::span<const std::byte> bytes);
}  // namespace detail

}  // namespace mbk::recording
