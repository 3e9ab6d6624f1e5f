#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// How messages stand in bytes, and with it what the words of their definitions mean.
enum class Dialect { ros1, ros2 };

/// What a field, or one element of it, is.
enum class FieldType {
  boolean,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  text,       ///< string
  wide_text,  ///< wstring of ROS 2
  time,       ///< seconds and nanoseconds
  duration,   ///< the same, with a sign
  message,    ///< fields of its own
};

/// One field of a message.
struct MessageField {
  enum class Count { one, fixed, counted };  ///< of its elements; counted: each message says how many

  std::string name;
  FieldType type = FieldType::uint8;
  int message = -1;  ///< of FieldType::message: an index into MessageDefinition::messages
  Count count = Count::one;
  std::uint64_t elements = 1;  ///< where they are fixed
};

/// One type of message.
struct MessageType {
  std::string name;  ///< "geometry_msgs/Vector3", without the "msg/" of ROS 2
  std::vector<MessageField> fields;
  std::uint64_t min_bytes = 0;  ///< that a message of it takes, whatever it holds; no padding is counted
};

/// A type of message with all that are within it.
struct MessageDefinition {
  Dialect dialect = Dialect::ros2;
  std::vector<MessageType> messages;  ///< the first is that of the topic
  bool wide_texts = false;            ///< some field is a wide text
};

/// Of a number in bytes; 0 where the type is no number.
[[nodiscard]] std::size_t number_size(FieldType type);

/// [bytes] of an element at least.
[[nodiscard]] std::uint64_t min_bytes(const MessageDefinition& definition, const MessageField& field);

/// "geometry_msgs/msg/Vector3" → "geometry_msgs/Vector3".
[[nodiscard]] std::string plain_type(std::string_view type);

/// Reads the text of a definition (ros1msg, ros2msg): fields, constants, comments, default values, bounds, and the
/// types within it, each behind a line of equal signs and "MSG: package/Type". What every robot has may be left out:
/// Header, Time, Duration.
/// @param type  of the topic, as "geometry_msgs/msg/WrenchStamped"
/// @fails  data: a line that is not one of these, a type that is not defined, or that contains itself.
[[nodiscard]] Result<MessageDefinition> parse_definition(std::string_view type, std::string_view text, Dialect dialect);

}  // namespace mbk::recording
