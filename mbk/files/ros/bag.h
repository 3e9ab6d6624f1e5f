#pragma once

#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Signature of a ROS 1 bag.
inline constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";

/// Whether the bytes have the signature of a ROS 1 bag of any version.
[[nodiscard]] bool looks_like_bag(std::span<const std::byte> begin);

/// Reads a bag of ROS 1 (wiki.ros.org/Bags/Format/2.0): as decode_mcap. It is read sequentially and needs no index; one
/// that was not closed is read as far as possible, with a note.
/// @fails  data: another version; it is encrypted; a chunk cannot be unpacked, a record is malformed.
[[nodiscard]] Result<Contents> decode_bag(std::span<const std::byte> file);

/// The same while the file is being read, with only a part of it in memory; all of it is read.
[[nodiscard]] Result<Contents> decode_bag(FileInPassing& file);

}  // namespace mbk::recording
