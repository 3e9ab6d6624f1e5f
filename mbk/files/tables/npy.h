#pragma once

#include <cstddef>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

[[nodiscard]] bool looks_like_npy(std::span<const std::byte> file);

/// An archive in which NumPy's `savez` put arrays.
[[nodiscard]] bool looks_like_npz(const ZipArchive& archive);

/// Reads an array as NumPy's `save` writes it (formats 1.0 to 3.0): real numbers, integers and logical values of either
/// byte order, in rows or columns first. The fields of a structured array become columns by their names; dates and
/// durations become times. An array called "array" where it has no fields.
/// @fails  data: it is cut short or damaged; it holds Python objects, complex numbers or nothing else that is read.
[[nodiscard]] Result<Contents> decode_npy(std::span<const std::byte> file);

/// Reads the arrays of an archive under their names, fields as "array.field". What is not read is named in a note, and
/// is an error for whoever asks for it (Array::obstacle).
/// @fails  data: an array is cut short or damaged.
[[nodiscard]] Result<Contents> decode_npz(const ZipArchive& archive);

}  // namespace mbk::recording
