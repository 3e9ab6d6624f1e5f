#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Whether the file begins as one that gzip packed (RFC 1952).
[[nodiscard]] bool looks_like_gzip(std::span<const std::byte> file);

/// The first bytes of what gzip packed: `count` of them, or as many as `file`, which may be cut short, gives.
[[nodiscard]] std::string gunzip_begin(std::span<const std::byte> file, std::size_t count);

/// What gzip packed, in one member or in several, one behind the other. Checksums are checked.
/// @fails  data: the file is damaged or cut short, something else follows a member, it unpacks to nothing or to more
///         than a file of this length can (`largest_unpacked`) or than memory holds.
[[nodiscard]] Result<Buffer> gunzip(std::span<const std::byte> file);

}  // namespace mbk::recording
