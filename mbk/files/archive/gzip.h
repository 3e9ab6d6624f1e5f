#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Whether the file begins as one that gzip packed (RFC 1952).
[[nodiscard]] bool looks_like_gzip(std::span<const std::byte> file);

/// What gzip packed, in one member or in several, one behind the other. Checksums are checked.
/// @fails  data: the file is damaged or cut short, something else follows a member, it unpacks to nothing or to more
///         than a file of this length can (`largest_claim`) or than memory holds.
[[nodiscard]] Result<Buffer> gunzip(std::span<const std::byte> file);

}  // namespace mbk::recording
