#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/ros/stream.h"

namespace mbk::recording {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestObject = 16;
constexpr std::size_t kLongestJson = std::size_t{1} << 20;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// The number that a text is, as protocol buffers write large ones, NaN and infinity; nothing where it is none.
std::optional<double> number_in(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || stop != end) return std::nullopt;
  return value;
}

bool begins_as_a_number(std::string_view text) {
  text = trimmed(text);
  return !text.empty() && std::string_view("0123456789+-.,").find(text.front()) != std::string_view::npos;
}

class StreamOfJson : public MessageStream {
 public:
  explicit StreamOfJson(bool joint_states) : joint_states_(joint_states) {}

  bool add(std::span<const std::byte> message, std::int64_t log_time) override {
    if (message.size() > kLongestJson) return false;
    const auto* const begin = reinterpret_cast<const char*>(message.data());
    const Json object = Json::parse(begin, begin + message.size(), nullptr, false);
    if (!object.is_object()) return false;
    take_header(object);
    take_names(object);
    for (const auto& [key, value] : object.items()) {
      if (joint_states_ && key == "name") continue;
      if (!names_.empty() && is_joint_array(key) && value.is_array() && value.size() == names_.size()) {
        take_joints(value, key);
      } else {
        take(value, key, -1, "", 0);
      }
    }
    log_times.push_back(log_time);
    for (NumberColumn& column : columns) {
      if (column.kept && column.numbers.size() < log_times.size()) leave_out(column);
    }
    return true;
  }

 private:
  /// The names of the joints of this message; none if it is not a JointState, or its first message named none.
  void take_names(const Json& object) {
    names_.clear();
    if (!joint_states_) return;
    const auto names = object.find("name");
    if (names == object.end() || !names->is_array()) return;
    for (const Json& name : *names) names_.push_back(name.is_string() ? printable(name.get<std::string>()) : "");
    if (log_times.empty()) set_joints(names_);
    if (joints.empty()) names_.clear();
  }

  void take_joints(const Json& values, const std::string& array) {
    for (std::size_t k = 0; k < names_.size(); ++k) {
      joint_ = names_[k];
      const auto at = std::ranges::find(joints, joint_) - joints.begin();
      take(values[k], fmt::format("{}.{}", array, joint_), static_cast<int>(at), array, 1);
    }
    joint_.clear();
  }

  void take_header(const Json& object) {
    stamps.push_back(0);
    const auto header = object.find("header");
    if (header == object.end() || !header->is_object()) return;
    if (const auto frame = header->find("frame_id"); frame != header->end() && frame->is_string()) {
      if (frames.size() < kMaxFrames) frames.insert(printable(frame->get<std::string>()));
    }
    const auto stamp = header->find("stamp");
    if (stamp == header->end() || !stamp->is_object()) return;
    const auto part = [&](std::initializer_list<const char*> names) -> std::optional<std::int64_t> {
      for (const char* name : names) {
        const auto found = stamp->find(name);
        if (found == stamp->end()) continue;
        if (found->is_number_integer()) return found->get<std::int64_t>();
        const auto in_text = found->is_string() ? number_in(found->get<std::string>()) : std::nullopt;
        if (in_text && std::abs(*in_text) < 1e15) return static_cast<std::int64_t>(*in_text);
      }
      return std::nullopt;
    };
    const auto seconds = part({"sec", "secs"}), nanoseconds = part({"nanosec", "nsec", "nsecs"});
    constexpr std::int64_t kMaxSeconds = std::numeric_limits<std::uint32_t>::max();
    if (!seconds || !nanoseconds || std::abs(*seconds) > kMaxSeconds || std::abs(*nanoseconds) > 4 * kSecond) return;
    stamps.back() = *seconds * kSecond + *nanoseconds;
  }

  void take(const Json& value, const std::string& path, int element, const std::string& array, int depth) {
    if (value.is_number() || value.is_boolean() || value.is_null()) {
      if (path.starts_with("header.stamp.")) return;
      keep(value, path, element, array);
    } else if (value.is_string()) {
      take_text(value.get_ref<const std::string&>(), path, element, array);
    } else if (value.is_object() && depth < kDeepestObject) {
      for (const auto& [key, inner] : value.items()) take(inner, path + "." + key, -1, "", depth + 1);
    } else if (value.is_array() && depth < kDeepestObject) {
      take_array(value, path, depth);
    }
  }

  void take_text(const std::string& value, const std::string& path, int element, const std::string& array) {
    if (path.starts_with("header.")) return;
    const std::string name = printable(array.empty() ? path : array);
    const auto number = number_in(value);
    if (number) {
      constexpr double kExact = 9007199254740992.0;  // 2⁵³
      rounded = rounded || (std::abs(*number) > kExact && value.find_first_of(".eEiI") == value.npos);
      if (from_text.size() < kMaxColumns) from_text.insert(name);
      keep(Json(*number), path, element, array);
    } else if (begins_as_a_number(value) && only_text.size() < kMaxColumns) {
      only_text.insert(name);
    }
  }

  void take_array(const Json& value, const std::string& path, int depth) {
    const std::string name = printable(path);
    if (!log_times.empty() && !lengths_.contains(path)) {
      if (changing.size() < kMaxColumns) changing.insert(name);
      return;
    }
    const auto [known, fresh] = lengths_.try_emplace(path, value.size());
    if (fresh && value.size() > kLongestArray) bulky.insert(name);
    if (bulky.contains(name) || changing.contains(name)) return;
    if (known->second != value.size()) {
      changing.insert(name);
      for (NumberColumn& column : columns) {
        if (column.path.starts_with(name + "[")) leave_out(column);
      }
      return;
    }
    for (std::size_t k = 0; k < value.size(); ++k) {
      take(value[k], fmt::format("{}[{}]", path, k), static_cast<int>(k), path, depth + 1);
    }
  }

  double number_of(const Json& value) {
    constexpr std::int64_t kExact = std::int64_t{1} << 53;
    if (value.is_null()) return kMissing;
    if (value.is_boolean()) return static_cast<double>(value.get<bool>());
    if (value.is_number_unsigned()) {
      rounded = rounded || value.get<std::uint64_t>() > static_cast<std::uint64_t>(kExact);
    } else if (value.is_number_integer()) {
      rounded = rounded || value.get<std::int64_t>() < -kExact;
    }
    return value.get<double>();
  }

  void keep(const Json& value, const std::string& path, int element, const std::string& array) {
    if (const auto found = by_path_.find(path); found != by_path_.end()) {
      NumberColumn& column = columns[found->second];
      if (column.kept && column.numbers.size() == log_times.size()) column.numbers.add(number_of(value));
      return;
    }
    if (value.is_null()) return;
    std::set<std::string>& why = log_times.empty() ? bulky : changing;
    if (!log_times.empty() || columns.size() >= kMaxColumns) {
      if (why.size() < kMaxColumns) why.insert(printable(array.empty() ? path : array));
      return;
    }
    by_path_.emplace(path, columns.size());
    columns.push_back({printable(path), element, printable(array), joint_, true, {}});
    columns.back().numbers.add(number_of(value));
  }

  /// One that not every message has.
  void leave_out(NumberColumn& column) {
    changing.insert(column.array.empty() ? column.path : column.array);
    column.kept = false;
    column.numbers.clear();
  }

  std::map<std::string, std::size_t> by_path_, lengths_;
  bool joint_states_;
  std::vector<std::string> names_;  ///< of the joints of this message
  std::string joint_;               ///< whose number is taken
};

}  // namespace

std::unique_ptr<MessageStream> stream_of_json(bool joint_states) {
  return std::make_unique<StreamOfJson>(joint_states);
}

}  // namespace mbk::recording
