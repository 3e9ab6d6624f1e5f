#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Whether the file has a gzip signature (RFC 1952).
[[nodiscard]] bool looks_like_gzip(std::span<const std::byte> file);

/// The first `count` unpacked bytes, or fewer if `file` is truncated.
[[nodiscard]] std::string gunzip_begin(std::span<const std::byte> file, std::size_t count);

/// The unpacked bytes of all members. Checksums are checked.
/// @fails  data: the file is damaged or truncated, other data follow a member, it unpacks to nothing, or to more than a
/// file of this size can (`largest_unpacked`) or than fits into memory.
[[nodiscard]] Result<Buffer> gunzip(std::span<const std::byte> file);

}  // namespace mbk::recording
