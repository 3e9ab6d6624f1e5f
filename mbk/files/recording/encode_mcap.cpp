#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "mbk/base/core/version.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/ros/mcap.h"
#include "mbk/files/ros/mcap_writer.h"
#include "mbk/files/ros/topics.h"

namespace mbk::recording {
namespace {

// What follows a definition that names these types.
constexpr std::string_view kLine = "================================================================================\n";
constexpr std::string_view kHeaderMessage = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr std::string_view kTimeText = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
constexpr std::string_view kVectorText = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

std::string wrench_definition() {
  return fmt::format(
      "std_msgs/Header header\nWrench wrench\n{0}MSG: geometry_msgs/Wrench\nVector3 force\nVector3 torque\n"
      "{0}{1}{0}{2}{0}{3}",
      kLine, kVectorText, kHeaderMessage, kTimeText);
}

std::string pose_definition() {
  return fmt::format(
      "std_msgs/Header header\nPose pose\n{0}MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n"
      "{0}MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
      "{0}MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n{0}{1}{0}{2}",
      kLine, kHeaderMessage, kTimeText);
}

std::string joints_definition() {
  return fmt::format(
      "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n{0}{1}{0}{2}",
      kLine, kHeaderMessage, kTimeText);
}

bool is_field_name(std::string_view name) {
  const auto inner = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return name.size() > 2 && name.front() >= 'a' && name.front() <= 'z' && std::ranges::all_of(name, inner);
}

/// "2024-05-06T07:08:09.123456789Z" → [ns] since 1970; nothing where it is no such time.
std::optional<std::int64_t> start_of(const Recording& recording) {
  const auto found = recording.metadata.find("start");
  if (found == recording.metadata.end()) return std::nullopt;
  const std::string& text = found->second;
  constexpr std::string_view kPattern = "0000-00-00T00:00:00.000000000Z";
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const bool fits = text.size() == kPattern.size() &&
                    std::ranges::equal(text, kPattern, [&](char c, char p) { return p == '0' ? digit(c) : c == p; });
  if (!fits) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t count) { return std::stol(text.substr(at, count)); };
  std::tm date{};
  date.tm_year = static_cast<int>(number(0, 4)) - 1900;
  date.tm_mon = static_cast<int>(number(5, 2)) - 1;
  date.tm_mday = static_cast<int>(number(8, 2));
  date.tm_hour = static_cast<int>(number(11, 2));
  date.tm_min = static_cast<int>(number(14, 2));
  date.tm_sec = static_cast<int>(number(17, 2));
  const std::int64_t seconds{::timegm(&date)};
  if (seconds < 0 || seconds > std::numeric_limits<std::int32_t>::max()) return std::nullopt;  // no stamp holds it
  return seconds * kSecond + number(20, 9);
}

class McapEncoder {
 public:
  explicit McapEncoder(const Recording& recording) : recording_(recording), writer_(fmt::format("mbk {}", version())) {}

  Result<std::string> run() {
    settle_stamps();
    MBK_TRY(add_metadata());
    sort_channels();
    MBK_TRY(add_topics());
    for (Index k = 0; k < recording_.samples(); ++k) {
      MBK_TRY(add_sample(k));
    }
    MBK_TRY(add_events());
    return writer_.finish();
  }

 private:
  /// Where time zero stands among the stamps, of which none is negative.
  void settle_stamps() {
    zero_ = start_of(recording_).value_or(0);
    double first = 0.0;
    const auto add = [&](double time) { first = is_stamp(time) ? std::min(first, time) : first; };
    for (const double time : recording_.time) add(time);
    for (const Event& event : recording_.events) add(event.time);
    zero_ = std::max(zero_, -static_cast<std::int64_t>(std::floor(first)) * kSecond);
  }

  /// Whether a stamp, whose seconds have 31 bits, can hold it. What does not has that of time zero; its exact time
  /// stands in the message.
  [[nodiscard]] bool is_stamp(double time) const {
    constexpr double kLatest = std::numeric_limits<std::int32_t>::max();
    return std::abs(time) < kLatest && static_cast<double>(zero_ / kSecond) + time < kLatest;
  }

  [[nodiscard]] std::int64_t stamp_of(double time) const {
    return is_stamp(time) ? zero_ + std::llround(time * static_cast<double>(kSecond)) : zero_;
  }

  Result<void> add_metadata() {
    auto metadata = MBK_TRY(metadata_with_units(recording_));
    writer_.add_metadata(kMcapLayoutRecord, {{"format", std::string(kLayout)}});
    if (!metadata.empty()) writer_.add_metadata(kMcapMetadataRecord, metadata);
    return {};
  }

  /// Which channels ROS has a type for: both of a vector; joints and torques from the first one on.
  void sort_channels() {
    force_ = both("force_x", "force_y");
    hand_ = both("hand_x", "hand_y");
    joints_ = numbered("joint_");
    torques_ = numbered("torque_");
    if (!joints_.empty() && !torques_.empty() && joints_.size() != torques_.size()) torques_.clear();
    for (const Channel& channel : recording_.channels) {
      const auto is_in = [&](const std::vector<const Channel*>& channels) {
        return std::ranges::find(channels, &channel) != channels.end();
      };
      if (!is_in(force_) && !is_in(hand_) && !is_in(joints_) && !is_in(torques_)) others_.push_back(&channel);
    }
  }

  [[nodiscard]] std::vector<const Channel*> both(std::string_view x, std::string_view y) const {
    if (recording_.find(x) == nullptr || recording_.find(y) == nullptr) return {};
    return {recording_.find(x), recording_.find(y)};
  }

  [[nodiscard]] std::vector<const Channel*> numbered(std::string_view prefix) const {
    std::vector<const Channel*> found;
    for (int k = 1; k <= kMaxJoints; ++k) {
      const Channel* channel = recording_.find(fmt::format("{}{}", prefix, k));
      if (channel == nullptr) break;
      found.push_back(channel);
    }
    return found;
  }

  Result<void> add_topics() {
    if (!force_.empty()) {
      wrench_topic_ = writer_.add_channel("/mbk/wrench", "geometry_msgs/msg/WrenchStamped", wrench_definition());
    }
    if (!hand_.empty()) {
      pose_topic_ = writer_.add_channel("/mbk/pose", "geometry_msgs/msg/PoseStamped", pose_definition());
    }
    if (!joints_.empty() || !torques_.empty()) {
      joints_topic_ = writer_.add_channel("/mbk/joint_states", "sensor_msgs/msg/JointState", joints_definition());
    }
    std::string definition = "float64 time\n";
    for (const Channel* channel : others_) {
      if (!is_field_name(channel->name)) {
        return bad_data(fmt::format("'{}' cannot be the name of a field of ROS", channel->name),
                        "use small letters, digits and _");
      }
      definition += fmt::format("float64 {}\n", channel->name);
    }
    channels_topic_ = writer_.add_channel("/mbk/channels", kChannelsType, definition);
    if (!recording_.events.empty()) {
      events_topic_ = writer_.add_channel("/mbk/events", kEventType, "float64 time\nfloat64 value\nstring name\n");
    }
    return {};
  }

  static void add_values(CdrMessage& message, std::span<const Channel* const> channels, Index k) {
    for (const Channel* channel : channels) message.add(channel->values[k]);
  }

  /// A sequence of them.
  static void add_sequence(CdrMessage& message, std::span<const Channel* const> channels, Index k) {
    message.add(static_cast<std::uint32_t>(channels.size()));
    add_values(message, channels, k);
  }

  Result<void> add_sample(Index k) {
    const double time = recording_.time[k];
    const std::int64_t stamp = stamp_of(time);
    if (!force_.empty()) {
      CdrMessage message;
      message.add_header(stamp, force_.front()->frame);
      add_values(message, force_, k);
      for (int rest = 0; rest < 4; ++rest) message.add(0.0);  // force.z, torque
      MBK_TRY(writer_.add_message(wrench_topic_, stamp, message.bytes()));
    }
    if (!hand_.empty()) {
      CdrMessage message;
      message.add_header(stamp, hand_.front()->frame);
      add_values(message, hand_, k);
      for (int rest = 0; rest < 4; ++rest) message.add(0.0);  // position.z, orientation.x, .y, .z
      message.add(1.0);                                       // orientation.w
      MBK_TRY(writer_.add_message(pose_topic_, stamp, message.bytes()));
    }
    if (!joints_.empty() || !torques_.empty()) {
      CdrMessage message;
      message.add_header(stamp, "");
      const std::size_t count = std::max(joints_.size(), torques_.size());
      message.add(static_cast<std::uint32_t>(count));
      for (std::size_t joint = 1; joint <= count; ++joint) message.add(fmt::format("joint_{}", joint));
      add_sequence(message, joints_, k);
      message.add(std::uint32_t{0});
      add_sequence(message, torques_, k);
      MBK_TRY(writer_.add_message(joints_topic_, stamp, message.bytes()));
    }
    CdrMessage message;
    message.add(time);
    add_values(message, others_, k);
    return writer_.add_message(channels_topic_, stamp, message.bytes());
  }

  Result<void> add_events() {
    for (const Event& event : recording_.events) {
      CdrMessage message;
      message.add(event.time);
      message.add(event.value);
      message.add(event.name);
      MBK_TRY(writer_.add_message(events_topic_, stamp_of(event.time), message.bytes()));
    }
    return {};
  }

  const Recording& recording_;
  McapWriter writer_;
  std::int64_t zero_ = 0;  ///< [ns] of time zero
  std::vector<const Channel*> force_, hand_, joints_, torques_, others_;
  std::uint16_t wrench_topic_ = 0, pose_topic_ = 0, joints_topic_ = 0, channels_topic_ = 0, events_topic_ = 0;
};

}  // namespace

Result<std::string> encode_mcap(const Recording& recording) {
  return McapEncoder(recording).run();
}

}  // namespace mbk::recording
