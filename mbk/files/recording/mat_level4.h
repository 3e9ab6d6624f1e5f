#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// True where the bytes begin with a plausible v4 header. The format has no signature: a small number and a name.
[[nodiscard]] bool looks_like_mat_level4(std::span<const std::byte> file);

/// Decodes a MAT file of level 4 (also SIMULINK's and QUARC's "To File"), in either byte order. Full real matrices come
/// out as arrays; text, sparse and complex ones are named in a note.
/// @fails  a header is not possible; the file ends within a variable.
[[nodiscard]] Result<Contents> decode_mat_level4(std::span<const std::byte> file);

}  // namespace mbk::recording
