#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

// Tables of text that programs of motion and EMG laboratories export. Their header says names in several rows, so that
// no reader of plain tables finds them. Missing markers are NaN; a name that stands twice becomes NAME#2.

/// A CSV file of Vicon Nexus: sections "Trajectories", "Devices", "Model Outputs", … with a rate, names, axes and units
/// each, below a row that begins with "Frame, Sub Frame".
[[nodiscard]] bool looks_like_vicon(std::string_view text);

/// Reads all sections as columns "SUBJECT:MARKER.x", "DEVICE.Fx", each at the rate of its section. Sections without
/// frames, as that of events, are left out with a note.
/// @fails  data: frames are missing, or two sections begin at different ones; no section; what is not a number.
[[nodiscard]] Result<Contents> decode_vicon(std::span<const std::byte> file);

/// A CSV file of OptiTrack Motive ("Format Version,1.23,…").
[[nodiscard]] bool looks_like_motive(std::string_view text);

/// Reads positions as "NAME.x" in the unit of the file, rotations as "NAME.rotation.x" (in degrees, or as a
/// quaternion), anything else as "NAME.KIND".
/// @fails  data: no row of axes; what is not a number; a row with too many cells.
[[nodiscard]] Result<Contents> decode_motive(std::span<const std::byte> file);

/// A TSV file of Qualisys Track Manager with markers or bodies.
[[nodiscard]] bool looks_like_qualisys(std::string_view text);

/// Reads markers as "NAME.x" in mm, with frame and time or without. Markers at exactly 0, 0, 0 are missing: QTM writes
/// them so.
/// @fails  data: it holds no markers (6D, skeletons); rows do not fit the names; what is not a number.
[[nodiscard]] Result<Contents> decode_qualisys(std::span<const std::byte> file);

}  // namespace mbk::recording
