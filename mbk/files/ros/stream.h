#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/contents/contents.h"
#include "mbk/files/ros/column.h"
#include "mbk/files/ros/message_definition.h"

namespace mbk::recording {

/// Longest array whose elements each become an array of the recording; those of single bytes.
inline constexpr std::uint64_t kLongestArray = 128, kLongestBytes = 16;
/// The most numbers of one message that are kept.
inline constexpr std::size_t kMaxColumns = 1000;

/// [ns]
inline constexpr std::int64_t kSecond = 1'000'000'000;

/// One number of every message.
struct NumberColumn {
  std::string path;   ///< "wrench.force.x", "position.elbow", "data[3]"
  int element = -1;   ///< which one of the array that it stands in; −1: in none
  std::string array;  ///< the path of that array
  std::string joint;  ///< of a JointState that names its joints: whose number it is; "" where nothing says it
  bool kept = true;   ///< false: the array's length changed
  Column numbers;
};

/// What the messages of one topic hold, as far as it is numbers.
class MessageStream {
 public:
  virtual ~MessageStream() = default;
  MessageStream(const MessageStream&) = delete;
  MessageStream& operator=(const MessageStream&) = delete;

  /// @param log_time  [ns] since 1970, when it was recorded
  /// @return false: the message is not what the definition says, and nothing more is to be added.
  [[nodiscard]] virtual bool add(std::span<const std::byte> message, std::int64_t log_time) = 0;

  /// Whose columns have as many numbers as there are messages.
  std::vector<NumberColumn> columns;
  std::vector<std::int64_t> log_times;  ///< [ns]
  std::vector<std::int64_t> stamps;     ///< [ns] of header.stamp, 0 where nobody set it; empty: messages have none
  std::set<std::string> frames;         ///< header.frame_id, at most kMaxFrames
  std::vector<std::string> joints;      ///< of a JointState, in the order of its first message
  bool joints_repeat = false;           ///< a JointState names a joint twice; `joints` then is empty
  std::set<std::string> bulky;          ///< arrays that are too long to be kept
  std::set<std::string> changing;       ///< numbers and arrays that not every message has, or not as many of
  std::set<std::string> from_text;      ///< numbers that the messages write as text
  std::set<std::string> only_text;      ///< texts that begin as numbers do and are none
  bool rounded = false;                 ///< whole numbers above 2⁵³ were

  static constexpr std::size_t kMaxFrames = 4;

 protected:
  MessageStream() = default;

  /// Takes the names of the joints of the first message.
  void set_joints(const std::vector<std::string>& names);
};

/// Messages as bytes behind each other, in ROS 1 or as CDR.
/// The arrays of a JointState go by the names of its joints, which all messages must have, in whatever order.
/// @param definition  without wide texts
[[nodiscard]] std::unique_ptr<MessageStream> stream_of_bytes(std::shared_ptr<const MessageDefinition> definition);

inline constexpr std::string_view kJointState = "sensor_msgs/JointState";

/// The names of the joints of a JointState, in the order of this message.
/// @return nothing where the message is not what the definition says
[[nodiscard]] std::optional<std::vector<std::string>> joint_names(const MessageDefinition& definition,
                                                                  std::span<const std::byte> message);

/// What mbk writes of an event: as CDR, float64 time, float64 value, string name.
/// @return nothing where the message is none
[[nodiscard]] std::optional<Event> event_of(std::span<const std::byte> message);

/// Messages that are JSON objects.
/// @param joint_states  they are JointStates, whose arrays go by the names of the joints, as in `stream_of_bytes`
[[nodiscard]] std::unique_ptr<MessageStream> stream_of_json(bool joint_states);

/// Whether the field of a JointState has one number for each joint.
[[nodiscard]] bool is_joint_array(std::string_view field);

}  // namespace mbk::recording
