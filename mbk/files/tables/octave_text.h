#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// What Octave's `save` writes where no other format is asked for.
[[nodiscard]] bool looks_like_octave_text(std::string_view text);

/// Reads the variables of such a file: scalars, matrices and ranges of real numbers, logical values and integers,
/// texts, and what stands in structures ("structure.field"). Variables of other kinds are named in a note.
/// @fails  data: a variable is cut short, is larger than the text it stands in, or holds what is not a number.
[[nodiscard]] Result<Contents> decode_octave_text(std::span<const std::byte> file);

}  // namespace mbk::recording
