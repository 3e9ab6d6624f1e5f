#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Decodes a MAT file of level 5 (v5 and v6 uncompressed, v7 by zlib), in either byte order.
/// (MathWorks, "MAT-File Format", R2023b.) Every claim is checked against the bytes before it is believed: matio reads
/// a truncated file as zeros with success, so that it is only an oracle of the tests. Real numeric matrices of two
/// dimensions, texts and cell arrays of texts come out, also from structures; everything else is named in a note.
/// @fails  a tag, checksum, size or dimension contradicts the bytes; the file ends within an element.
[[nodiscard]] Result<Contents> decode_mat_level5(std::span<const std::byte> file);
/// The same, where doubles are not copied: matrices stand in the bytes of the file, or in those that were inflated.
[[nodiscard]] Result<Contents> decode_mat_level5(std::shared_ptr<Buffer> file);

}  // namespace mbk::recording
