#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

// Information about a recording apart from its channels is stored in a MAT file as two structures:
//   metadata            one field of text for each key; `unit_<channel>` is the SI unit of a channel
//                       that differs from the one implied by its place in the file (reference_x in N),
//                       `joint_of_<channel>` the name of the joint that a channel belongs to
//   events              fields `time` [s] and `value`, N×1, and `name`, a cell array N×1 of texts

/// "unit_reference_x"
[[nodiscard]] std::string unit_key(std::string_view channel);

/// "joint_of_torque_1"
[[nodiscard]] std::string joint_key(std::string_view channel);

/// Moves the texts `metadata.KEY` into `metadata`, and `events.time`, `.name`, `.value` into `events` where they are N
/// numbers, N texts, N numbers; an `events` of another shape is unchanged. Every other text, and every entry of several
/// lines, is reported in a note.
void take_annotations(Contents& contents);

/// The note on metadata with several lines in the file, which are joined into one.
[[nodiscard]] std::string several_lines_note(std::string_view key, std::size_t lines);

inline constexpr std::size_t kLongestMatlabName = 63;  ///< characters

/// A letter, then letters, digits and _; kLongestMatlabName at most.
[[nodiscard]] bool is_matlab_name(std::string_view name);

/// The metadata of a recording, and the names of joints.
[[nodiscard]] std::map<std::string, std::string> metadata_with_joints(const Recording& recording);

/// The same, and the units of channels.
/// @fails  data: a unit that another entry contradicts.
[[nodiscard]] Result<std::map<std::string, std::string>> metadata_with_units(const Recording& recording);

/// The structure `metadata` of a MAT file.
/// @fails  as metadata_with_units; data: a key that is not a valid MATLAB field name.
[[nodiscard]] Result<std::map<std::string, std::string>> metadata_to_write(const Recording& recording);

}  // namespace mbk::recording
