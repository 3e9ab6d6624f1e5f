#pragma once

#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// How a bag of ROS 1 begins.
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Whether the bytes begin as a bag of ROS 1 does, of whatever version.
[[nodiscard]] bool looks_like_bag(std::span<const std::byte> begin);

/// Reads a bag of ROS 1 (wiki.ros.org/Bags/Format/2.0): as decode_mcap. It is read from begin to end, so that it needs
/// no index; one that was not closed is read as far as it goes, with a note.
/// @fails  data: another version; it is encrypted; a chunk cannot be unpacked, a record is not what it says.
[[nodiscard]] Result<Contents> decode_bag(std::span<const std::byte> file);

/// The same while the file is read, of which a part is in memory; all of it is read.
[[nodiscard]] Result<Contents> decode_bag(FileInPassing& file);

}  // namespace mbk::recording
