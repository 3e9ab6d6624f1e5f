#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/ros/stream.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kCdrHeader = 4;
constexpr std::size_t kCdrPadding = 8;  ///< what may follow the fields

/// Reads a message from its begin to its end. Once it has failed, whatever it gives says nothing.
class Cursor {
 public:
  Cursor(std::span<const std::byte> message, Dialect dialect) : bytes_(message), cdr_(dialect == Dialect::ros2) {
    if (!cdr_) return;
    // Plain CDR: 0, then the byte order.
    const bool plain = bytes_.size() >= kCdrHeader && bytes_[0] == std::byte{0} && bytes_[1] <= std::byte{1};
    failed_ = !plain;
    swapped_ = plain && bytes_[1] == std::byte{0};
    if (plain) bytes_ = bytes_.subspan(kCdrHeader);
  }

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] bool is_whole() const { return !failed_ && left() < (cdr_ ? kCdrPadding : 1); }

  void align(std::size_t size) {
    if (cdr_) leave_out((size - at_ % size) % size);
  }
  void leave_out(std::uint64_t count) {
    failed_ = failed_ || count > left();
    if (!failed_) at_ += static_cast<std::size_t>(count);
  }

  template <class Stored>
  Stored number() {
    align(sizeof(Stored));
    failed_ = failed_ || sizeof(Stored) > left();
    if (failed_) return Stored{};
    std::byte raw[sizeof(Stored)];
    std::memcpy(raw, bytes_.data() + at_, sizeof raw);
    if (swapped_) std::reverse(raw, raw + sizeof raw);
    at_ += sizeof raw;
    Stored value;
    std::memcpy(&value, raw, sizeof raw);
    return value;
  }

  std::string_view text() {
    const auto size = number<std::uint32_t>();
    failed_ = failed_ || size > left();
    if (failed_) return {};
    std::string_view text(reinterpret_cast<const char*>(bytes_.data() + at_), size);
    at_ += size;
    if (cdr_ && text.ends_with('\0')) text.remove_suffix(1);
    return text;
  }

  /// [ns]
  std::int64_t time(bool is_signed) {
    const auto seconds = number<std::uint32_t>();
    const auto nanoseconds = number<std::uint32_t>();
    const bool negative = is_signed || cdr_;  // ROS 2 counts both from a signed second
    const std::int64_t whole =
        negative ? std::int64_t{static_cast<std::int32_t>(seconds)} : static_cast<std::int64_t>(seconds);
    const std::int64_t part = is_signed && !cdr_ ? std::int64_t{static_cast<std::int32_t>(nanoseconds)}
                                                 : static_cast<std::int64_t>(nanoseconds);
    return whole * kSecond + part;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool cdr_, swapped_ = false, failed_ = false;
};

/// Leaves out what fields hold.
class Skipping {
 public:
  Skipping(const MessageDefinition& definition, Cursor& cursor) : definition_(definition), cursor_(cursor) {}

  void field(const MessageField& field) { elements(field, count_of(field)); }

  std::uint64_t count_of(const MessageField& field) {
    return field.count == MessageField::Count::counted ? cursor_.number<std::uint32_t>() : field.elements;
  }

  /// Whether the rest can contain that many elements.
  [[nodiscard]] bool can_hold(const MessageField& field, std::uint64_t count) const {
    const std::uint64_t least = min_bytes(definition_, field);
    return least == 0 || count <= cursor_.left() / least;
  }

  void elements(const MessageField& field, std::uint64_t count) {
    if (!can_hold(field, count)) cursor_.leave_out(cursor_.left() + 1);
    if (cursor_.failed() || count == 0) return;
    if (const std::size_t size = number_size(field.type); size > 0) {
      cursor_.align(size);
      cursor_.leave_out(count * size);
      return;
    }
    if (min_bytes(definition_, field) == 0) return;  // nothing is in it, however many there are
    for (std::uint64_t k = 0; k < count && !cursor_.failed(); ++k) element(field);
  }

 private:
  void element(const MessageField& field) {
    if (field.type == FieldType::message) {
      for (const MessageField& inner : definition_.messages[static_cast<std::size_t>(field.message)].fields) {
        this->field(inner);
      }
    } else if (field.type == FieldType::text || field.type == FieldType::wide_text) {
      cursor_.text();
    } else {
      cursor_.time(false);
    }
  }

  const MessageDefinition& definition_;
  Cursor& cursor_;
};

/// One field, or one element of it, as the first message had it.
struct Node {
  std::vector<Node> children;  ///< fields of a message, elements of an array
  std::string path = {};       ///< of an array
  std::uint64_t length = 0;    ///< of an array
  int column = -1;
  bool known = false;  ///< the first message made it
  bool aside = false;  ///< its contents are not columns: header.stamp, header.frame_id, a discarded array
};

class StreamOfBytes : public MessageStream {
 public:
  explicit StreamOfBytes(std::shared_ptr<const MessageDefinition> definition) : definition_(std::move(definition)) {
    by_joint_ = definition_->messages.front().name == kJointState;
  }

  bool add(std::span<const std::byte> message, std::int64_t log_time) override {
    if (definition_->messages.front().min_bytes > message.size()) return false;
    if (by_joint_ && !order_joints(message)) return false;
    Cursor cursor(message, definition_->dialect);
    cursor_ = &cursor;
    stamp_.reset();
    take_message(root_, 0, "");
    if (!cursor.is_whole()) return false;
    log_times.push_back(log_time);
    if (stamp_) stamps.push_back(*stamp_);
    first_ = false;
    return true;
  }

 private:
  bool order_joints(std::span<const std::byte> message) {
    auto names = joint_names(*definition_, message);
    if (!names) return false;
    if (first_) set_joints(*names);
    if (joints.empty() || *names == order_of_) return true;
    order_.clear();
    for (const std::string& name : *names) {
      order_.push_back(static_cast<std::size_t>(std::ranges::find(joints, name) - joints.begin()));
    }
    order_of_ = std::move(*names);
    std::vector<std::size_t> each = order_;
    std::ranges::sort(each);
    return each.size() == joints.size() && std::ranges::adjacent_find(each) == each.end() &&
           each.back() < joints.size();
  }

  int new_column(std::string path, int element, std::string array) {
    if (columns.size() >= kMaxColumns) {
      bulky.insert(array.empty() ? path : array);
      return -1;
    }
    columns.push_back({printable(std::move(path)), element, printable(std::move(array)), joint_, true, {}});
    return static_cast<int>(columns.size()) - 1;
  }

  void make_children(Node& node, std::size_t count) {
    node.children.resize(count);
    nodes_ += count;
  }

  /// @param path  only in the first message
  void take_message(Node& node, int message, const std::string& path) {
    const std::vector<MessageField>& fields = definition_->messages[static_cast<std::size_t>(message)].fields;
    if (!node.known) make_children(node, fields.size());
    node.known = true;
    for (std::size_t k = 0; k < fields.size() && !cursor_->failed(); ++k) {
      const std::string name = !first_ ? std::string() : path.empty() ? fields[k].name : path + "." + fields[k].name;
      if (fields[k].count == MessageField::Count::one) {
        take_one(node.children[k], fields[k], name, -1, "");
      } else {
        take_array(node.children[k], fields[k], name);
      }
    }
  }

  void take_array(Node& node, const MessageField& field, const std::string& path) {
    Skipping skipping(*definition_, *cursor_);
    const std::uint64_t count = skipping.count_of(field);
    if (!skipping.can_hold(field, count)) cursor_->leave_out(cursor_->left() + 1);
    if (cursor_->failed()) return;
    const bool full = columns.size() >= kMaxColumns || nodes_ > 10 * kMaxColumns;
    const bool texts = field.type == FieldType::text || field.type == FieldType::wide_text;
    if (!node.known) {
      node.known = true;
      node.length = count;
      const bool bulk = full || count > (number_size(field.type) == 1 ? kLongestBytes : kLongestArray);
      if (bulk && !texts) bulky.insert(printable(path));
      node.aside = bulk || texts || min_bytes(*definition_, field) == 0;
      if (!node.aside) make_children(node, static_cast<std::size_t>(count));
      node.path = path;
    } else if (!node.aside && count != node.length) {
      changing.insert(printable(node.path));
      forget(node);
      node.aside = true;
    }
    if (node.aside) {
      skipping.elements(field, count);
      return;
    }
    const bool joint = !order_.empty() && count == order_.size() && is_joint_array(node.path);
    for (std::size_t k = 0; k < count && !cursor_->failed(); ++k) {
      const std::size_t at = joint ? order_[k] : k;
      std::string name;
      if (first_) name = joint ? fmt::format("{}.{}", path, joints[at]) : fmt::format("{}[{}]", path, k);
      if (first_ && joint) joint_ = printable(joints[at]);
      take_one(node.children[at], field, name, static_cast<int>(at), path);
    }
    joint_.clear();
  }

  void forget(Node& node) {
    if (node.column >= 0) {
      columns[static_cast<std::size_t>(node.column)].kept = false;
      columns[static_cast<std::size_t>(node.column)].numbers.clear();
    }
    for (Node& child : node.children) forget(child);
    node.children.clear();
  }

  void take_one(Node& node, const MessageField& field, const std::string& path, int element, const std::string& array) {
    switch (field.type) {
      case FieldType::boolean:
        return keep(node, cursor_->number<std::uint8_t>(), path, element, array);
      case FieldType::int8:
        return keep(node, cursor_->number<std::int8_t>(), path, element, array);
      case FieldType::uint8:
        return keep(node, cursor_->number<std::uint8_t>(), path, element, array);
      case FieldType::int16:
        return keep(node, cursor_->number<std::int16_t>(), path, element, array);
      case FieldType::uint16:
        return keep(node, cursor_->number<std::uint16_t>(), path, element, array);
      case FieldType::int32:
        return keep(node, cursor_->number<std::int32_t>(), path, element, array);
      case FieldType::uint32:
        return keep(node, cursor_->number<std::uint32_t>(), path, element, array);
      case FieldType::int64:
        return keep(node, cursor_->number<std::int64_t>(), path, element, array);
      case FieldType::uint64:
        return keep(node, cursor_->number<std::uint64_t>(), path, element, array);
      case FieldType::float32:
        return keep(node, cursor_->number<float>(), path, element, array);
      case FieldType::float64:
        return keep(node, cursor_->number<double>(), path, element, array);
      case FieldType::text:
      case FieldType::wide_text:
        return take_text(node, cursor_->text(), path);
      case FieldType::time:
        return take_time(node, cursor_->time(false), path, element, array);
      case FieldType::duration:
        return keep(node, static_cast<double>(cursor_->time(true)) / static_cast<double>(kSecond), path, element,
                    array);
      case FieldType::message:
        if (min_bytes(*definition_, field) > 0) take_message(node, field.message, path);
        return;
    }
  }

  template <class Number>
  void keep(Node& node, Number value, const std::string& path, int element, const std::string& array) {
    if (cursor_->failed()) return;
    if (!node.known) {
      node.known = true;
      node.column = new_column(path, element, array);
    }
    const auto number = static_cast<double>(value);
    if constexpr (sizeof(Number) == 8 && std::is_integral_v<Number>) {
      constexpr Number kExact = Number{1} << 53;
      rounded = rounded || value > kExact || (std::is_signed_v<Number> && value < Number{} - kExact);
    }
    if (node.column >= 0) columns[static_cast<std::size_t>(node.column)].numbers.add(number);
  }

  void take_time(Node& node, std::int64_t time, const std::string& path, int element, const std::string& array) {
    if (first_ && path == "header.stamp") node.aside = true;  // the clock, and no column
    if (node.aside) {
      stamp_ = time;
    } else {
      keep(node, static_cast<double>(time) / static_cast<double>(kSecond), path, element, array);
    }
  }

  void take_text(Node& node, std::string_view text, const std::string& path) {
    if (first_) node.aside = path == "header.frame_id";
    if (!node.aside || frames.size() >= kMaxFrames || cursor_->failed()) return;
    if (frames.empty() || *frames.rbegin() != text) frames.insert(printable(std::string(text)));
  }

  std::shared_ptr<const MessageDefinition> definition_;
  Node root_;
  bool first_ = true, by_joint_ = false;
  std::vector<std::string> order_of_;  ///< names of the joints, as the last message had them
  std::vector<std::size_t> order_;     ///< and which ones of `joints` they are
  std::string joint_;                  ///< whose number is taken
  std::optional<std::int64_t> stamp_;
  std::size_t nodes_ = 0;
  Cursor* cursor_ = nullptr;
};

}  // namespace

bool is_joint_array(std::string_view field) {
  return field == "position" || field == "velocity" || field == "effort";
}

void MessageStream::set_joints(const std::vector<std::string>& names) {
  if (std::ranges::all_of(names, &std::string::empty)) return;  // unnamed
  joints_repeat = std::set(names.begin(), names.end()).size() < names.size();
  if (!joints_repeat) joints = names;
}

std::unique_ptr<MessageStream> stream_of_bytes(std::shared_ptr<const MessageDefinition> definition) {
  return std::make_unique<StreamOfBytes>(std::move(definition));
}

std::optional<std::vector<std::string>> joint_names(const MessageDefinition& definition,
                                                    std::span<const std::byte> message) {
  Cursor cursor(message, definition.dialect);
  Skipping skipping(definition, cursor);
  for (const MessageField& field : definition.messages.front().fields) {
    if (field.name != "name" || field.type != FieldType::text || field.count == MessageField::Count::one) {
      skipping.field(field);
      continue;
    }
    const std::uint64_t count = skipping.count_of(field);
    if (cursor.failed() || !skipping.can_hold(field, count)) return std::nullopt;
    std::vector<std::string> names;
    for (std::uint64_t k = 0; k < count && !cursor.failed(); ++k) names.emplace_back(cursor.text());
    if (cursor.failed()) return std::nullopt;
    return names;
  }
  return std::nullopt;
}

std::optional<Event> event_of(std::span<const std::byte> message) {
  Cursor cursor(message, Dialect::ros2);
  Event event;
  event.time = cursor.number<double>();
  event.value = cursor.number<double>();
  event.name = cursor.text();
  if (!cursor.is_whole()) return std::nullopt;
  return event;
}

}  // namespace mbk::recording
