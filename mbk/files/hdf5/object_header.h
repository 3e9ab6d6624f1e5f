#pragma once

#include <vector>

#include "mbk/files/hdf5/file.h"

namespace mbk::hdf5 {

/// Types of messages (specification, IV.A.2).
enum class MessageType : std::uint16_t {
  dataspace = 0x01,
  link_info = 0x02,
  datatype = 0x03,
  link = 0x06,
  external_files = 0x07,
  layout = 0x08,
  group_info = 0x0A,
  filters = 0x0B,
  attribute = 0x0C,
  continuation = 0x10,
  symbol_table = 0x11,
  attribute_info = 0x15,
};

/// One statement about an object.
struct Message {
  MessageType type{};
  bool shared = false;  ///< the body says where the statement stands
  Bytes body;
};

/// The messages of one object, continuations followed.
struct ObjectHeader {
  std::vector<Message> messages;

  [[nodiscard]] const Message* find(MessageType type) const;
};

/// @fails  the header is broken, one of its checksums is wrong, or it continues in itself.
[[nodiscard]] Result<ObjectHeader> read_object_header(File& file, std::uint64_t address);

/// The body of a message, fetched from where it is shared: a datatype with a name of its own.
/// @param body  what stands in its place
/// @fails  it is shared in a way that is not read.
[[nodiscard]] Result<Bytes> shared_body(File& file, MessageType type, Bytes body);

}  // namespace mbk::hdf5
