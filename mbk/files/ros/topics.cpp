#include "mbk/files/ros/topics.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/ros/forward_bytes.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxTopics = 4096, kMaxArrays = 20000, kMaxSets = 16, kMaxListed = 12;
constexpr std::int64_t kLatest = std::int64_t{1} << 62;
constexpr std::int64_t kFirstDate = 631152000 * kSecond;  ///< 1990: clocks that count from elsewhere are before it
constexpr std::int64_t kLongLag = 60 * kSecond;

std::string listed(std::vector<std::string> names) {
  const std::size_t more = names.size() > kMaxListed ? names.size() - kMaxListed : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// The vector of a type of message whose x, y and z are channels; z only if three axes are read.
struct VectorMeaning {
  std::string_view type, path, channel, unit;
};

constexpr auto kVectors = std::to_array<VectorMeaning>({
    {"geometry_msgs/WrenchStamped", "wrench.force", "force", "N"},
    {"geometry_msgs/Wrench", "force", "force", "N"},
    {"geometry_msgs/PoseStamped", "pose.position", "hand", "m"},
    {"geometry_msgs/Pose", "position", "hand", "m"},
    {"geometry_msgs/PoseWithCovarianceStamped", "pose.pose.position", "hand", "m"},
    {"geometry_msgs/PointStamped", "point", "hand", "m"},
    {"geometry_msgs/AccelStamped", "accel.linear", "acceleration", "m/s2"},
    {"geometry_msgs/Accel", "linear", "acceleration", "m/s2"},
});

/// The field x of these types is not a channel by that name alone.
bool is_of_ros(std::string_view type) {
  constexpr auto kPackages =
      std::to_array<std::string_view>({"geometry_msgs/", "sensor_msgs/", "nav_msgs/", "std_msgs/", "tf2_msgs/", "tf/",
                                       "trajectory_msgs/", "control_msgs/", "visualization_msgs/", "diagnostic_msgs/",
                                       "rosgraph_msgs/", "rcl_interfaces/", "dynamic_reconfigure/", "foxglove."});
  return std::ranges::any_of(kPackages, [&](std::string_view package) { return type.starts_with(package); });
}

struct Meaning {
  std::string channel;  ///< "" where the type says nothing
  std::string unit;
};

Meaning meaning_of(std::string_view type, const NumberColumn& column) {
  for (const VectorMeaning& vector : kVectors) {
    if (type != vector.type || !column.path.starts_with(vector.path)) continue;
    const std::string_view rest = std::string_view(column.path).substr(vector.path.size());
    if (rest == ".x" || rest == ".y" || rest == ".z") {
      return {fmt::format("{}_{}", vector.channel, rest[1]), std::string(vector.unit)};
    }
  }
  if (type == kJointState && column.element >= 0) {
    if (column.array == "position") return {fmt::format("joint_{}", column.element + 1), ""};
    if (column.array == "effort") return {fmt::format("torque_{}", column.element + 1), ""};
  }
  return {};
}

/// Whether joints have names, but nothing says which one this number belongs to: there are more or fewer of them.
bool is_nobodys(std::string_view type, const MessageStream& messages, const NumberColumn& column) {
  return type == kJointState && !messages.joints.empty() && column.joint.empty();
}

/// [Hz], one over the median interval; 0 if there is none.
double rate_of(const Vector& time) {
  if (time.size() < 2) return 0.0;
  std::vector<double> intervals(static_cast<std::size_t>(time.size() - 1));
  for (Index k = 1; k < time.size(); ++k) intervals[static_cast<std::size_t>(k - 1)] = time[k] - time[k - 1];
  const auto middle = intervals.begin() + std::ssize(intervals) / 2;
  std::ranges::nth_element(intervals, middle);
  return *middle > 0.0 ? 1.0 / *middle : 0.0;
}

/// Unset stamps are not times.
bool has_stamps(const MessageStream& messages) {
  return messages.stamps.size() == messages.log_times.size() &&
         std::ranges::any_of(messages.stamps, [](std::int64_t stamp) { return stamp != 0; });
}

/// The times of a stream, and which of its messages have one.
struct Times {
  const std::vector<std::int64_t>* all = nullptr;
  std::vector<std::size_t> unset = {};  ///< messages with an unset time (0)

  [[nodiscard]] bool is_set(std::size_t message) const { return !std::ranges::binary_search(unset, message); }
};

/// Nodes and recorders that still wait for their clock write 0. A simulation that starts at 0 writes it once, and its
/// next time follows soon.
Times times_of(const MessageStream& messages) {
  constexpr std::int64_t kSoon = 10 * kSecond;
  Times times{has_stamps(messages) ? &messages.stamps : &messages.log_times};
  const std::vector<std::int64_t>& all = *times.all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k] == 0) times.unset.push_back(k);
  }
  const bool begins = times.unset.size() == 1 && all[0] == 0 && (all.size() == 1 || std::abs(all[1]) < kSoon);
  if (begins || times.unset.size() == all.size()) times.unset.clear();
  return times;
}

std::int64_t first_of(const Times& times) {
  std::int64_t first = kLatest;
  for (std::size_t k = 0; k < times.all->size(); ++k) {
    if (times.is_set(k)) first = std::min(first, (*times.all)[k]);
  }
  return first;
}

/// [ns] from stamp to record, the median of all messages.
std::int64_t lag_of(const MessageStream& messages, const Times& times) {
  std::vector<std::int64_t> lags;
  for (std::size_t k = 0; k < messages.stamps.size(); ++k) {
    if (times.is_set(k)) lags.push_back(messages.log_times[k] - messages.stamps[k]);
  }
  const auto middle = lags.begin() + std::ssize(lags) / 2;
  std::ranges::nth_element(lags, middle);
  return *middle;
}

Vector without(Vector values, const std::vector<std::size_t>& rows) {
  if (rows.empty()) return values;
  Vector kept(values.size() - std::ssize(rows));
  Index to = 0;
  for (Index from = 0; from < values.size(); ++from) {
    if (!std::ranges::binary_search(rows, static_cast<std::size_t>(from))) kept[to++] = values[from];
  }
  return kept;
}

bool has_numbers(const MessageStream& messages) {
  return !messages.log_times.empty() && std::ranges::any_of(messages.columns, &NumberColumn::kept);
}

std::string date_of(std::int64_t nanoseconds) {
  const auto seconds = static_cast<std::time_t>(nanoseconds / kSecond);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:09}Z", fmt::gmtime(seconds), nanoseconds % kSecond);
}

/// The frames that the messages name. ROS 1 may write them with a slash.
std::set<std::string> frames_of(const MessageStream& messages) {
  std::set<std::string> frames;
  for (const std::string& frame : messages.frames) {
    if (const std::string name = frame.substr(frame.starts_with('/') ? 1 : 0); !name.empty()) frames.insert(name);
  }
  return frames;
}

std::string frames_text(const std::set<std::string>& frames) {
  std::vector<std::string> names;
  for (const std::string& frame : frames) names.push_back(fmt::format("'{}'", frame));
  return (frames.size() > 1 ? "frames " : "frame ") + listed(std::move(names));
}

const VectorMeaning* vector_of(std::string_view type) {
  const auto found = std::ranges::find(kVectors, plain_type(type), &VectorMeaning::type);
  return found == kVectors.end() ? nullptr : &*found;
}

}  // namespace

void Topics::add(std::uint32_t channel, const TopicDescription& description) {
  if (channels_.contains(channel) || topics_.size() >= kMaxTopics) return;
  const auto same = [&](const Topic& topic) {
    const TopicDescription& other = topic.description;
    return other.topic == description.topic && other.type == description.type &&
           other.encoding == description.encoding && other.definition == description.definition;
  };
  // Several programs may publish one topic.
  const auto known = std::ranges::find_if(topics_, same);
  channels_[channel] = static_cast<std::size_t>(known - topics_.begin());
  if (known != topics_.end()) return;
  Topic topic;
  topic.description = description;
  topic.name = printable(description.topic);
  const auto namesakes =
      std::ranges::count(topics_, description.topic, [](const Topic& other) { return other.description.topic; });
  if (namesakes > 0) topic.name += fmt::format("#{}", namesakes + 1);
  prepare(topic);
  topics_.push_back(std::move(topic));
}

void Topics::prepare(Topic& topic) {
  const TopicDescription& said = topic.description;
  if (said.encoding == "json") return;
  const bool ros1 = said.encoding == "ros1" && said.schema_encoding == "ros1msg";
  if (!ros1 && !(said.encoding == "cdr" && said.schema_encoding == "ros2msg")) {
    topic.unread =
        fmt::format("its messages have encoding '{}' and schema encoding '{}'", said.encoding, said.schema_encoding);
    return;
  }
  auto definition = parse_definition(said.type, said.definition, ros1 ? Dialect::ros1 : Dialect::ros2);
  if (!definition) {
    topic.unread = fmt::format("the definition of {} cannot be parsed: {}", said.type, definition.error().message);
  } else if (definition->wide_texts) {
    topic.unread = "it has wide strings, whose size in bytes differs between programs";
  } else {
    topic.definition = std::make_shared<const MessageDefinition>(std::move(*definition));
  }
}

bool Topics::wants(std::uint32_t channel) const {
  const auto found = channels_.find(channel);
  return found != channels_.end() && topics_[found->second].unread.empty();
}

void Topics::leave_out(std::uint32_t channel) {
  if (const auto found = channels_.find(channel); found != channels_.end()) ++topics_[found->second].count;
}

Topics::Stream* Topics::stream_of(Topic& topic, std::span<const std::byte> message) {
  std::string key;
  if (topic.definition && topic.definition->messages.front().name == kJointState) {
    auto names = joint_names(*topic.definition, message);
    if (!names) return nullptr;
    std::ranges::sort(*names);
    for (const std::string& name : *names) key += name + '\0';
  }
  const auto known = std::ranges::find(topic.streams, key, &Stream::key);
  if (known != topic.streams.end()) return &*known;
  if (topic.streams.size() >= kMaxSets) return nullptr;
  std::string name = topic.name;
  if (!topic.streams.empty()) name += fmt::format("/{}", topic.streams.size() + 1);
  topic.streams.push_back({std::move(name), std::move(key),
                           topic.definition ? stream_of_bytes(topic.definition)
                                            : stream_of_json(plain_type(topic.description.type) == kJointState)});
  return &topic.streams.back();
}

Result<void> Topics::message(std::uint32_t channel, std::uint64_t log_time, std::span<const std::byte> message) {
  Topic& topic = topics_[channels_.at(channel)];
  ++topic.count;
  if (!topic.unread.empty()) return {};
  std::size_t numbers = 2;  // its times
  if (topic.description.type == kEventType) {
    auto event = event_of(message);
    if (event) {
      events_.push_back({event->time, printable(std::move(event->name)), event->value});
    } else {
      topic.unread = fmt::format("message {} does not match its definition", topic.count);
    }
  } else {
    Stream* const stream = stream_of(topic, message);
    const auto time = static_cast<std::int64_t>(std::min<std::uint64_t>(log_time, kLatest));
    if (stream != nullptr && stream->messages->add(message, time)) {
      numbers += stream->messages->columns.size();
      // A restarted node is a new publisher, and the old one does not return.
      stream->alternates |= !stream->channels.insert(channel).second && stream->channel != channel;
      stream->channel = channel;
    } else {
      topic.unread = stream == nullptr && topic.streams.size() >= kMaxSets
                         ? fmt::format("its messages contain more than {} different sets of joints", kMaxSets)
                         : fmt::format("message {} does not match its definition", topic.count);
      topic.streams.clear();
    }
  }
  return count(numbers);
}

Result<void> Topics::count(std::size_t numbers) {
  constexpr std::uint64_t kOften = std::uint64_t{1} << 22;
  if (numbers_ / kOften != (numbers_ + numbers) / kOften) {
    MBK_TRY(check_memory(2 * kOften * sizeof(double)));
  }
  numbers_ += numbers;
  if (numbers_ <= max_numbers_) return {};
  return bad_data(fmt::format("it claims {} numbers, more than a file of its size can contain", numbers_),
                  std::string(kCopyAgain));
}

void Topics::note_topics(Contents& contents) const {
  std::vector<std::string> read;
  for (const Topic& topic : topics_) {
    const std::string type = topic.description.type.empty() ? topic.description.encoding : topic.description.type;
    std::string rates;
    for (const Stream& stream : topic.streams) {
      const auto clock = std::ranges::find(contents.clocks, stream.name, &Clock::name);
      if (clock == contents.clocks.end()) continue;
      rates += fmt::format("{}{:.4g} Hz", rates.empty() ? ", " : " and ", rate_of(clock->time));
    }
    read.push_back(
        fmt::format("{} ({}, {} message{}{})", topic.name, type, topic.count, topic.count == 1 ? "" : "s", rates));
  }
  if (!read.empty()) contents.notes.push_back(printable(fmt::format("topics: {}", fmt::join(read, ", "))));
  for (const Topic& topic : topics_) {
    if (!topic.unread.empty()) {
      contents.notes.push_back(printable(fmt::format("'{}' was not read: {}", topic.name, topic.unread)));
    }
  }
}

void Topics::explain(const Topic& topic, const Stream& stream, Contents& contents) {
  const MessageStream& messages = *stream.messages;
  const std::string type = plain_type(topic.description.type);
  const auto note = [&](std::string text) { contents.notes.push_back(printable(std::move(text))); };
  const VectorMeaning* const vector = vector_of(type);
  if (!stream.doubt.empty()) {
    const std::string channels = vector != nullptr     ? fmt::format(" as {0}_x and {0}_y", vector->channel)
                                 : type == kJointState ? " as joint_1 …, torque_1 …"
                                                       : " as channels";
    note(fmt::format("'{}' was not used{}: {}", stream.name, channels, stream.doubt));
  } else if (vector != nullptr) {
    const std::set<std::string> frames = frames_of(messages);
    note(fmt::format(
        "{0}_x and {0}_y are {1}.x and .y of '{2}', {3}", vector->channel, vector->path, stream.name,
        frames.empty() ? "whose frame is not stated in the messages" : fmt::format("in its {}", frames_text(frames))));
    if (vector->channel == "force") {
      contents.notes.back() += printable(
          fmt::format(", with unchanged sign; mbk needs the force of the hand on the robot, in the base frame of the "
                      "robot: if the sensor has the opposite sign, reverse it with --channels "
                      "Fx=-{0}.{1}.x,Fy=-{0}.{1}.y and name the other channels there too, as x=hand_x,y=hand_y",
                      stream.name, vector->path));
    }
  } else if (type == kJointState && messages.joints.empty()) {
    note(fmt::format(
        "joints and torques are position and effort of '{}' in stored order: its messages do not name the joints",
        stream.name));
  } else if (type == kJointState) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < messages.joints.size(); ++k) {
      names.push_back(fmt::format("{} {}", k + 1, messages.joints[k]));
    }
    note(
        fmt::format("joints and torques are position and effort of '{}', in the order of its first message: {}; if the "
                    "robot description names the joints, they are matched by name",
                    stream.name, listed(std::move(names))));
  }
  for (const auto& [array, channel] : {std::pair("position", "joint_1"), std::pair("effort", "torque_1")}) {
    const auto is_uneven = [&](const NumberColumn& column) {
      return column.array == array && is_nobodys(type, messages, column);
    };
    const char* const why = type != kJointState                 ? nullptr
                            : messages.changing.contains(array) ? "its length changes from message to message"
                            : std::ranges::any_of(messages.columns, is_uneven)
                                ? "its length differs from the number of joint names"
                                : nullptr;
    if (why != nullptr) note(fmt::format("'{}.{}' was not used as {} …: {}", stream.name, array, channel, why));
  }
  const auto list = [&](const std::set<std::string>& paths) {
    std::vector<std::string> names;
    for (const std::string& path : paths) names.push_back(fmt::format("{}.{}", stream.name, path));
    return listed(std::move(names));
  };
  if (!messages.bulky.empty()) {
    note(fmt::format("omitted because they exceed {} numbers or {} bytes per array, or {} numbers per message: {}",
                     kLongestArray, kLongestBytes, kMaxColumns, list(messages.bulky)));
  }
  if (!messages.changing.empty()) {
    note(fmt::format("omitted because their presence or length varies between messages: {}", list(messages.changing)));
  }
  if (!messages.from_text.empty()) {
    note(fmt::format("stored as text and read as numbers: {}", list(messages.from_text)));
  }
  if (!messages.only_text.empty()) note(fmt::format("omitted because they are text: {}", list(messages.only_text)));
  if (messages.rounded) {
    note(fmt::format("'{}' contains integers above 2^53, which were rounded", stream.name));
  }
}

void Topics::take(Topic& topic, Stream& stream, std::int64_t begin, bool own, Contents& contents) {
  MessageStream& messages = *stream.messages;
  Times times = times_of(messages);
  if (own) times.unset.clear();  // its exact times are in the messages
  Vector time(std::ssize(*times.all));
  for (std::size_t k = 0; k < times.all->size(); ++k) {
    time[static_cast<Index>(k)] = static_cast<double>((*times.all)[k] - begin) / static_cast<double>(kSecond);
  }
  const auto clock = static_cast<int>(contents.clocks.size());
  contents.clocks.push_back({stream.name, without(std::move(time), times.unset)});
  if (!times.unset.empty()) {
    contents.notes.push_back(printable(fmt::format(
        "{} of {} messages of '{}' were omitted because the time {} them was not set (0)", times.unset.size(),
        times.all->size(), stream.name, times.all == &messages.stamps ? "in the header of" : "of recording")));
  }
  const std::string type = plain_type(topic.description.type);
  for (NumberColumn& column : messages.columns) {
    if (!column.kept) continue;
    Meaning meaning = meaning_of(type, column);
    if (own && meaning.channel.ends_with("_z")) meaning.channel.clear();  // recordings of mbk had two axes
    Array array;
    array.name = fmt::format("{}.{}", stream.name, column.path);
    array.values = SharedMatrix::of_column(without(column.numbers.take(), times.unset));
    array.unit = std::move(meaning.unit);
    array.signal = true;
    array.clock = clock;
    // In a custom message the name of a separate field determines its meaning.
    const bool by_name = !is_of_ros(type) && column.path.size() > 2 && !column.path.starts_with("time") &&
                         column.path.find_first_of(".[") == std::string::npos;
    if (own && is_of_ros(type) && meaning.channel.empty()) continue;  // it only fills the message
    if (!meaning.channel.empty() && stream.doubt.empty() && !is_nobodys(type, messages, column)) {
      array.means = std::move(meaning.channel);
      if (!own) array.joint = column.joint;  // mbk's own messages count them
    } else if (!by_name || !stream.doubt.empty()) {
      array.means = array.name;
    }
    contents.arrays.push_back(std::move(array));
  }
}

/// Notes why the numbers of a stream cannot be taken as channels without being named.
void Topics::doubt(const std::vector<std::pair<Topic*, Stream*>>& streams) {
  const auto vector_in = [](const Topic& topic) { return vector_of(topic.description.type); };
  const Stream* hand = nullptr;  // whose frame is named
  std::set<std::string> of_hands;
  for (const auto& [topic, stream] : streams) {
    if (vector_in(*topic) == nullptr || vector_in(*topic)->channel != "hand") continue;
    const std::set<std::string> frames = frames_of(*stream->messages);
    if (!frames.empty()) hand = stream;
    of_hands.insert(frames.begin(), frames.end());
  }
  for (const auto& [topic, stream] : streams) {
    const MessageStream& messages = *stream->messages;
    const VectorMeaning* const vector = vector_in(*topic);
    const bool may_be_channels =
        vector != nullptr || plain_type(topic->description.type) == kJointState || !is_of_ros(topic->description.type);
    if (stream->alternates && may_be_channels) {
      stream->doubt = fmt::format("{} publishers alternate in it", stream->channels.size());
    } else if (messages.joints_repeat) {
      stream->doubt = "its messages name a joint twice";
    } else if (vector != nullptr) {
      const std::set<std::string> frames = frames_of(messages);
      if (frames.size() > 1) {
        stream->doubt = fmt::format("its messages are in different frames: {}", frames_text(frames));
      } else if (hand != nullptr && !frames.empty() && !of_hands.contains(*frames.begin())) {
        const std::string source = fmt::format("{}.{}", stream->name, vector->path);
        stream->doubt = fmt::format(
            "it is in {}, but the position of '{}' is in {}; transform it to that frame before recording (tf2) or, if "
            "the axes of both frames are parallel, name it, as in --channels x=hand_x,y=hand_y,{}x={}.x,{}y={}.y{}",
            frames_text(frames), hand->name, frames_text(of_hands), vector->channel == "force" ? 'F' : 'a', source,
            vector->channel == "force" ? 'F' : 'a', source,
            vector->channel == "force"
                ? "; if not, also Fz, and the orientation of that frame as sensor_qx to sensor_qw"
                : "");
      }
    }
  }
}

Contents Topics::contents(std::string format, bool exact_times) {
  Contents contents;
  contents.format = std::move(format);
  std::vector<std::pair<Topic*, Stream*>> streams;
  std::size_t arrays = 0;
  for (Topic& topic : topics_) {
    std::size_t of_topic = 0;
    for (const Stream& stream : topic.streams) {
      of_topic += static_cast<std::size_t>(std::ranges::count(stream.messages->columns, true, &NumberColumn::kept));
    }
    if (arrays + of_topic > kMaxArrays) {
      topic.unread = fmt::format("the messages contain more than {} numbers", kMaxArrays);
      topic.streams.clear();
      continue;
    }
    arrays += of_topic;
    for (Stream& stream : topic.streams) {
      if (has_numbers(*stream.messages)) streams.emplace_back(&topic, &stream);
    }
  }

  std::int64_t begin = kLatest;
  for (const auto& [topic, stream] : streams) begin = std::min(begin, first_of(times_of(*stream->messages)));
  const auto own = std::ranges::find(streams, kChannelsType,
                                     [](const auto& one) { return std::string_view(one.first->description.type); });
  const bool exact = exact_times && own != streams.end() && std::ranges::all_of(streams, [&](const auto& one) {
                       return one.second->messages->log_times == own->second->messages->log_times;
                     });
  std::optional<Vector> times;
  if (exact) {
    auto& columns = own->second->messages->columns;
    const auto time = std::ranges::find(columns, "time", &NumberColumn::path);
    if (time != columns.end() && time->kept) {
      times = time->numbers.take();
      time->kept = false;
    }
  }

  if (!times) doubt(streams);
  std::vector<std::string> stamped, logged;
  for (const auto& [topic, stream] : streams) {
    const bool stamps = has_stamps(*stream->messages);
    (stamps ? stamped : logged).push_back(fmt::format("'{}'", stream->name));
    if (stamps && !exact) {
      const std::int64_t lag = lag_of(*stream->messages, times_of(*stream->messages));
      if (std::abs(lag) > kLongLag) {
        contents.notes.push_back(printable(fmt::format(
            "the stamps of '{}' are {:.6g} s {} their recording time: they come from another clock", stream->name,
            static_cast<double>(std::abs(lag)) / static_cast<double>(kSecond), lag > 0 ? "before" : "after")));
      }
    }
    take(*topic, *stream, begin, times.has_value(), contents);
    if (times) contents.clocks.back().time = *times;
    if (!times) explain(*topic, *stream, contents);
    stream->messages->stamps.clear();
    stream->messages->stamps.shrink_to_fit();
  }
  if (times) {
    contents.events = std::move(events_);
  } else if (!events_.empty()) {
    contents.notes.push_back("its events were omitted because the times of its channels differ");
  }
  if (!streams.empty() && !times) {
    std::string note = "times are relative to the first one";
    if (begin >= kFirstDate) {
      contents.metadata["start"] = date_of(begin);
      note += fmt::format(", {}", contents.metadata["start"]);
    }
    if (!stamped.empty()) note += fmt::format("; header.stamp is used for {}", listed(std::move(stamped)));
    if (!logged.empty()) {
      note +=
          fmt::format("; the recording time is used for {}, whose messages have no stamp", listed(std::move(logged)));
    }
    contents.notes.insert(contents.notes.begin(), printable(std::move(note)));
  }
  note_topics(contents);
  topics_.clear();
  channels_.clear();
  return contents;
}

}  // namespace mbk::recording
