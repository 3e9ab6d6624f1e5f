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
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/ros/stream.h"

namespace mbk::recording {

/// What mbk writes beside what ROS has types for: channels of other kinds with the exact times, and events.
inline constexpr std::string_view kChannelsType = "mbk_msgs/msg/Channels", kEventType = "mbk_msgs/msg/Event";

/// What a file says of the messages of one channel.
struct TopicDescription {
  std::string topic;            ///< "/ft_sensor/wrench"
  std::string type;             ///< "geometry_msgs/msg/WrenchStamped"; "" where nothing says it
  std::string encoding;         ///< of its messages: "cdr", "ros1", "json", …
  std::string schema_encoding;  ///< "ros2msg", "ros1msg", "jsonschema", …
  std::string definition;       ///< the text of the schema
};

/// Gathers the numbers of all topics of a file.
class Topics {
 public:
  /// @param file_size  [bytes], which bounds how many numbers are believed
  explicit Topics(std::uint64_t file_size) : max_numbers_(largest_claim(file_size) / (2 * sizeof(double))) {}

  /// A channel, by the number that the file has for it; one that is known already stays as it is.
  void add(std::uint32_t channel, const TopicDescription& description);
  [[nodiscard]] bool knows(std::uint32_t channel) const { return channels_.contains(channel); }
  /// Whether anything of the channel's messages is kept.
  [[nodiscard]] bool wants(std::uint32_t channel) const;
  /// A message that was left out counts.
  void leave_out(std::uint32_t channel);
  /// @param log_time  [ns] since 1970
  /// @fails  data: the file holds more numbers than one of its size can, or than there is memory for
  [[nodiscard]] Result<void> message(std::uint32_t channel, std::uint64_t log_time, std::span<const std::byte> message);

  /// Arrays, clocks, events, and notes on what they are; afterwards nothing is here.
  /// @param format  "MCAP"    @param exact_times  the file is one of mbk's: times as the recording had them
  [[nodiscard]] Contents contents(std::string format, bool exact_times);

 private:
  /// Messages that belong together: those of a topic, or of one set of joints of it.
  struct Stream {
    std::string name;  ///< of its clock
    std::string key;   ///< the joints
    std::unique_ptr<MessageStream> messages;
    std::set<std::uint32_t> channels = {};  ///< publishers, if the file distinguishes them
    std::uint32_t channel = 0;              ///< of the last message
    bool alternates = false;                ///< publishers take turns
    std::string doubt = {};                 ///< why its numbers are not taken as channels automatically; "": they are
  };
  /// One topic, or one of several types under its name.
  struct Topic {
    TopicDescription description;
    std::string name;
    std::shared_ptr<const MessageDefinition> definition;
    std::string unread = {};  ///< why it is not read; "" where it is
    std::uint64_t count = 0;  ///< messages
    std::vector<Stream> streams;
  };

  Result<void> count(std::size_t numbers);
  static void prepare(Topic& topic);
  static Stream* stream_of(Topic& topic, std::span<const std::byte> message);
  static void doubt(const std::vector<std::pair<Topic*, Stream*>>& streams);
  static void take(Topic& topic, Stream& stream, std::int64_t begin, bool own, Contents& contents);
  static void explain(const Topic& topic, const Stream& stream, Contents& contents);
  void note_topics(Contents& contents) const;

  std::vector<Topic> topics_;
  std::map<std::uint32_t, std::size_t> channels_;  ///< → topics_
  std::vector<Event> events_;
  std::uint64_t max_numbers_, numbers_ = 0;  ///< that are kept
};

}  // namespace mbk::recording
