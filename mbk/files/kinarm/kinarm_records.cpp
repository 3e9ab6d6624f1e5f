#include "mbk/files/kinarm/kinarm_records.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/utf16.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kAgain = "the exam is damaged or truncated: copy it again from where it was recorded";
constexpr std::size_t kWord = 4;

/// Reads a member from its begin to its end. After the first failure everything reads as nothing.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) : view_{bytes, std::endian::native != std::endian::little} {}

  [[nodiscard]] bool failed() const { return !failure_.empty(); }
  [[nodiscard]] bool at_end() const { return at_ == view_.size(); }
  [[nodiscard]] std::size_t left() const { return view_.size() - at_; }
  [[nodiscard]] tl::unexpected<Error> failure() const { return bad_data(failure_, std::string(kAgain)); }

  void refuse(std::string why) {
    if (failed()) return;
    failure_ = std::move(why);
    at_ = view_.size();
  }

  std::int32_t whole(std::string_view what) { return number<std::int32_t>(what); }
  float real(std::string_view what) { return number<float>(what); }
  std::uint8_t byte(std::string_view what) { return number<std::uint8_t>(what); }

  /// A count of elements of `each` bytes that are all there.
  std::size_t count(std::string_view what, std::size_t each) {
    const std::int32_t n = whole(what);
    if (n < 0) {
      refuse(fmt::format("the {} is {}", what, n));
    } else if (static_cast<std::size_t>(n) > left() / each) {
      refuse(fmt::format("the {} is {}, and {} bytes follow", what, n, left()));
    }
    return failed() ? 0 : static_cast<std::size_t>(n);
  }

  std::string text(std::string_view what) {
    const std::size_t units = count(what, sizeof(char16_t));
    std::u16string wide(units, u'\0');
    for (char16_t& unit : wide) unit = number<char16_t>(what);
    while (!wide.empty() && wide.back() == u'\0') wide.pop_back();
    return failed() ? std::string() : printable(utf8_from_utf16(wide));
  }

  void version(std::string_view what, std::initializer_list<std::int32_t> known) {
    const std::int32_t stored = whole("version");
    for (const std::int32_t one : known) {
      if (stored == one) return;
    }
    refuse(fmt::format("version {} of {} is unknown", stored, what));
  }

 private:
  template <class Value>
  Value number(std::string_view what) {
    if (!failed() && left() < sizeof(Value)) refuse(fmt::format("it ends before the {}", what));
    if (failed()) return Value{};
    const auto value = view_.at<Value>(at_);
    at_ += sizeof(Value);
    return value;
  }

  ByteView view_;
  std::size_t at_ = 0;
  std::string failure_;
};

ExamValue value_of(Cursor& cursor, std::string_view name) {
  constexpr std::int32_t kText = 0, kByte = 1, kWhole = 2, kReal = 3;
  const std::int32_t kind = cursor.whole("type of a parameter");
  if (kind < kText || kind > kReal) {
    cursor.refuse(fmt::format("parameter {} is of the unknown type {}", name, kind));
    return {};
  }
  const std::size_t count = cursor.count(fmt::format("count of values of {}", name), kind == kByte ? 1 : kWord);
  ExamValue value;
  value.is_text = kind == kText;
  for (std::size_t k = 0; k < count && !cursor.failed(); ++k) {
    switch (kind) {
      case kText:
        value.texts.push_back(cursor.text("text of a parameter"));
        break;
      case kByte:
        value.numbers.push_back(cursor.byte("value of a parameter"));
        break;
      case kWhole:
        value.numbers.push_back(cursor.whole("value of a parameter"));
        break;
      default:
        value.numbers.push_back(static_cast<double>(cursor.real("value of a parameter")));
    }
  }
  return value;
}

}  // namespace

bool is_status(std::string_view label) {
  return label.ends_with("_FS_Status");
}

Result<KinarmHeader> read_kinarm_header(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  cursor.version("header.bin", {2, 3});
  KinarmHeader header;
  header.frames = cursor.whole("number of frames");
  const std::int32_t kinematics = cursor.whole("number of kinematics");
  const std::int32_t positions = cursor.whole("number of positions");
  header.events = cursor.whole("number of events");
  header.video_frames = cursor.whole("number of video frames");
  header.rate_hz = static_cast<double>(cursor.real("rate"));
  static_cast<void>(cursor.text("name of the file"));  // may name a person
  if (!cursor.failed() && (header.frames < 0 || kinematics < 0 || positions < 0)) {
    cursor.refuse("a count is negative");
  }
  if (!cursor.failed() && !(header.rate_hz >= 0.0 && std::isfinite(header.rate_hz))) {
    cursor.refuse(fmt::format("the rate is {} Hz", header.rate_hz));
  }
  for (std::int32_t k = 0; k < kinematics && !cursor.failed(); ++k) header.kinematics.push_back(cursor.text("label"));
  for (std::int32_t k = 0; k < positions && !cursor.failed(); ++k) header.positions.push_back(cursor.text("label"));
  if (cursor.failed()) return cursor.failure();
  return header;
}

Result<ExamParameters> read_kinarm_parameters(std::span<const std::byte> bytes) {
  constexpr std::int32_t kGroup = 1, kParameter = 2;
  Cursor cursor(bytes);
  cursor.version("parameters.bin", {2, 3});
  ExamParameters parameters;
  std::string group;
  while (!cursor.failed() && !cursor.at_end()) {
    const std::int32_t type = cursor.whole("type of a record");
    if (type == 0) break;
    if (type != kGroup && type != kParameter) cursor.refuse(fmt::format("a record is of the unknown type {}", type));
    std::string name = cursor.text("name of a record");
    static_cast<void>(cursor.text("description of a record"));
    if (cursor.failed()) break;
    if (type == kGroup) {
      group = std::move(name);
      continue;
    }
    ExamValue value = value_of(cursor, name);
    if (!cursor.failed()) parameters.add(group, name, std::move(value));
  }
  if (cursor.failed()) return cursor.failure();
  return parameters;
}

Result<KinarmSignal> read_kinarm_signal(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  cursor.version("a .kinematics", {1});
  KinarmSignal signal;
  signal.label = cursor.text("label");
  static_cast<void>(cursor.text("description"));
  signal.unit = cursor.text("unit");
  const std::size_t count = cursor.count("count of samples", kWord);
  if (cursor.failed()) return cursor.failure();
  MBK_TRY(check_memory(count * sizeof(double)));
  signal.values.resize(static_cast<Index>(count));
  if (is_status(signal.label)) {
    for (double& value : signal.values) value = static_cast<std::uint32_t>(cursor.whole("sample"));
  } else {
    for (double& value : signal.values) value = static_cast<double>(cursor.real("sample"));
  }
  return signal;
}

Result<KinarmPosition> read_kinarm_position(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  cursor.version("a .position", {1});
  KinarmPosition position;
  position.label = cursor.text("label");
  static_cast<void>(cursor.text("description"));
  const std::size_t count = cursor.count("count of samples", 2 * kWord);
  if (cursor.failed()) return cursor.failure();
  MBK_TRY(check_memory(2 * count * sizeof(double)));
  position.x.resize(static_cast<Index>(count));
  position.y.resize(static_cast<Index>(count));
  for (Index i = 0; i < position.x.size(); ++i) {
    position.x[i] = static_cast<double>(cursor.real("sample"));
    position.y[i] = static_cast<double>(cursor.real("sample"));
  }
  return position;
}

Result<std::vector<Event>> read_kinarm_events(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  cursor.version("examevents.bin", {2, 3});
  const std::size_t count = cursor.count("count of events", 3 * kWord);
  std::vector<Event> events;
  for (std::size_t k = 0; k < count && !cursor.failed(); ++k) {
    std::string label = cursor.text("label of an event");
    std::string description = cursor.text("description of an event");
    const auto time = static_cast<double>(cursor.real("time of an event"));
    events.push_back({time, !label.empty()         ? std::move(label)
                            : !description.empty() ? std::move(description)
                                                   : "event"});
  }
  if (cursor.failed()) return cursor.failure();
  return events;
}

Result<Vector> read_kinarm_video_delays(std::span<const std::byte> bytes) {
  Cursor cursor(bytes);
  static_cast<void>(cursor.whole("version"));
  const std::size_t count = cursor.count("count of video frames", 2 * kWord);
  if (cursor.failed()) return cursor.failure();
  Vector delays(static_cast<Index>(count));
  for (double& delay : delays) {
    const auto sent = static_cast<double>(cursor.real("time of a video frame"));
    const auto acknowledged = static_cast<double>(cursor.real("time of a video frame"));
    delay = acknowledged - sent;
  }
  return delays;
}

}  // namespace mbk::recording
