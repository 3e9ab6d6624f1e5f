#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/c3d/c3d_parameters.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// The group of parameters of files that mbk wrote (recording/encode.h).
inline constexpr std::string_view kOwnC3dGroup = "MBK";

/// Whether the file has a C3D signature.
[[nodiscard]] bool looks_like_c3d(std::span<const std::byte> file);

/// Reads a C3D file (The C3D File Format, User Guide, Motion Lab Systems, 2008 and c3d.org): written on Intel, DEC or
/// SGI processors, with integers or reals, up to 65535 points and channels, and any number of frames (c3d_layout.h).
///
/// A point gives the arrays LABEL.x, LABEL.y and LABEL.z in POINT:UNITS, or in the units of its type (ANGLES and
/// ANGLE_UNITS, …); they are NaN where the point is marked invalid. An analog channel gives the array LABEL with
/// (stored − OFFSET)·SCALE·GEN_SCALE in its ANALOG:UNITS. Missing labels become point_7 or analog_7; repeated ones
/// become LABEL#1, LABEL#2, …. Arrays have their rate. Events come from the header and from the groups EVENT and
/// EVENTS, on a clock that is 0 at the first frame of the file. Contents::notes lists anything unusual.
///
/// A file that mbk wrote also gives metadata, values of events, its exact rate, and the array `time` if it does not
/// begin at 0.
///
/// Arrays whose scale is 0, or differs between header and parameters, have an obstacle instead of values.
///
/// @fails  data: an unknown processor; a damaged parameter section; no layout (c3d_layout.h); the file ends before the
/// last frame.
[[nodiscard]] Result<Contents> decode_c3d(std::span<const std::byte> file);

/// Only the parameters of a C3D file. They refer to its bytes; those before the data suffice.
/// @fails  data: an unknown processor; a damaged parameter section, or one that extends beyond the given bytes.
[[nodiscard]] Result<C3dParameters> decode_c3d_parameters(std::span<const std::byte> file);

/// Extent of a C3D file; the bytes before its data suffice.
struct C3dLength {
  std::uint64_t frames = 0;
  double rate_hz = 0.0;  ///< of the frames; 0 if not stated
};
/// @param size  [bytes] of the whole file
/// @fails  data: as decode_c3d, but the data may be missing.
[[nodiscard]] Result<C3dLength> decode_c3d_length(std::span<const std::byte> file, std::uint64_t size);

}  // namespace mbk::recording
