#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace mbk::recording {

/// SHA-256 of the bytes (FIPS 180-4, 2015, §6.2) as 64 hexadecimal digits. Uses the processor's SHA instructions where
/// it has them.
[[nodiscard]] std::string sha256(std::span<const std::byte> bytes);

namespace detail {
/// The same by plain arithmetic, on any processor.
[[nodiscard]] std::string sha256_portable(std::span<const std::byte> bytes);
}  // namespace detail

}  // namespace mbk::recording
