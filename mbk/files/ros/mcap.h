#pragma once

#include <span>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// Whether the bytes have an MCAP signature.
[[nodiscard]] bool looks_like_mcap(std::span<const std::byte> begin);

/// Reads an MCAP file (mcap.dev/spec): every number of the messages of ROS 1, ROS 2 and JSON as an array
/// "topic.field.path" with the clock of its topic. It is read sequentially, without its index. A truncated file is read
/// as far as possible, with a note.
/// @fails  data: a checksum is wrong, a chunk cannot be unpacked, a record is malformed.
[[nodiscard]] Result<Contents> decode_mcap(std::span<const std::byte> file);

/// The same while the file is being read, with only a part of it in memory; all of it is read.
[[nodiscard]] Result<Contents> decode_mcap(FileInPassing& file);

/// The name of the metadata record that marks files written by mbk up to version 0.1, and of the record with their
/// metadata.
inline constexpr std::string_view kMcapLayoutRecord = "mbk.recording", kMcapMetadataRecord = "mbk.metadata";
/// Magic bytes at the start and end of an MCAP file.
inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// The kinds of records that are read.
enum class McapRecord : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  metadata = 0x0C,
  data_end = 0x0F,
};

}  // namespace mbk::recording
