#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Inflates one zlib stream (RFC 1950) that must hold exactly what its first eight bytes claim.
/// Memory grows with the actual output, never with the claim alone.
/// @param claimed_size  from the first 8 inflated bytes: the whole inflated size, at least 8
/// @fails  the stream is broken or truncated; its Adler checksum is wrong; the output is longer or shorter than
/// claimed; bytes
///         follow it; the claim is above largest_claim.
[[nodiscard]] Result<Buffer> inflate_exactly(
    std::span<const std::byte> stream,
    const std::function<Result<std::uint64_t>(std::span<const std::byte, 8>)>& claimed_size);

}  // namespace mbk::recording
