#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Decodes a MAT file of level 5 (v5 and v6 uncompressed, v7 by zlib), in either byte order.
/// (MathWorks, "MAT-File Format", R2023b.) Every size is checked against the bytes before it is used. (matio reads a
/// truncated file as zeros without an error, so it only serves as a reference in tests.) Real two-dimensional numeric
/// matrices, texts and cell arrays of texts are returned, also from structures; everything else is listed in a note.
/// @fails  a tag, checksum, size or dimension contradicts the bytes; the file ends within an element.
[[nodiscard]] Result<Contents> decode_mat_level5(std::span<const std::byte> file);
/// The same without copying doubles: matrices refer to the bytes of the file, or to the inflated bytes.
[[nodiscard]] Result<Contents> decode_mat_level5(std::shared_ptr<Buffer> file);

}  // namespace mbk::recording
