#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// True if the bytes begin with a plausible v4 header. The format has no signature, only a small number and a name.
[[nodiscard]] bool looks_like_mat_level4(std::span<const std::byte> file);

/// Decodes a MAT file of level 4 (also SIMULINK's and QUARC's "To File"), in either byte order. Full real matrices come
/// out as arrays; text, sparse and complex ones are listed in a note.
/// @fails  an invalid header; the file ends within a variable.
[[nodiscard]] Result<Contents> decode_mat_level4(std::span<const std::byte> file);

}  // namespace mbk::recording
