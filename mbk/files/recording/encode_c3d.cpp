#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/core/version.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/encode.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxInC3dArray = 255;  ///< the byte of a dimension; the rest goes to NAME2, NAME3, …
constexpr std::size_t kMaxC3dText = 127;     ///< [bytes]: programs read that byte with or without a sign
constexpr std::size_t kMaxC3dBlocks = 255;   ///< of the parameters
constexpr double kUnevenInC3d = 0.01;        ///< intervals: what the rest of mbk calls jitter
constexpr double kMaxC3dWord = 65535.0;
constexpr double kMillimetres = 1000.0;
constexpr std::string_view kOtherFormats = "write .h5, .mat or .csv instead";

std::string c3d_word(std::size_t value) {
  return {static_cast<char>(value & 0xFFu), static_cast<char>(value >> 8u & 0xFFu)};
}

void append_real(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xFFu);
}

std::string c3d_real(double value) {
  std::string bytes;
  append_real(bytes, value);
  return bytes;
}

std::string exact_number(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

/// The longest beginning of at most `size` bytes that ends with a whole character.
std::string_view whole_characters(std::string_view text, std::size_t size) {
  if (text.size() <= size) return text;
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0u) == 0x80u) --size;
  return text.substr(0, size);
}

/// Whether readers get this text back: they remove spaces around it.
bool is_c3d_text(std::string_view text) {
  return !text.empty() && text.size() <= kMaxC3dText && text.front() != ' ' && text.back() != ' ';
}

/// The records of a parameter section. Parameters belong to the last group.
class C3dRecords {
 public:
  void group(std::string_view name) {
    ++group_;
    bytes_ += static_cast<char>(name.size());
    bytes_ += static_cast<char>(-group_);
    bytes_ += std::string(name) + c3d_word(3) + '\0';  // the next record follows an empty description
  }

  void word(std::string_view name, std::size_t value) { record(name, 2, {}, c3d_word(value)); }
  void real(std::string_view name, double value) { record(name, 4, {}, c3d_real(value)); }
  void text(std::string_view name, std::string_view value) { record(name, -1, {value.size()}, std::string(value)); }

  void texts(std::string_view name, std::span<const std::string> values) {
    std::size_t longest = 1;
    for (const std::string& value : values) longest = std::max(longest, value.size());
    std::string data;
    for (const std::string& value : values) data += value + std::string(longest - value.size(), ' ');
    array(name, -1, {longest}, values.size(), data);
  }

  /// `count` elements of the dimensions `each`, in arrays of at most 255.
  void array(std::string_view name, int type, std::vector<std::size_t> each, std::size_t count, std::string_view data) {
    const std::size_t size = count > 0 ? data.size() / count : 0;
    for (std::size_t begin = 0, part = 1; part == 1 || begin < count; begin += kMaxInC3dArray, ++part) {
      const std::size_t here = std::min(count - begin, kMaxInC3dArray);
      auto dimensions = each;
      dimensions.push_back(here);
      record(part == 1 ? std::string(name) : fmt::format("{}{}", name, part), type, dimensions,
             data.substr(begin * size, here * size));
    }
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void record(std::string_view name, int type, const std::vector<std::size_t>& dimensions, std::string_view data) {
    std::string content{static_cast<char>(type), static_cast<char>(dimensions.size())};
    for (const std::size_t one : dimensions) content += static_cast<char>(one);
    content += data;
    content += '\0';  // no description
    bytes_ += static_cast<char>(name.size());
    bytes_ += static_cast<char>(group_);
    bytes_ += std::string(name) + c3d_word(2 + content.size()) + content;
  }

  std::string bytes_;
  int group_ = 0;
};

/// The even clock that stands for the times of a recording.
struct C3dClock {
  double start = 0.0, rate_hz = 0.0;
  double deviation = 0.0;  ///< [s] of the times from it, at most
};

/// @fails  data: loads without time; fewer than two samples; times that are not even
Result<C3dClock> c3d_clock(const Recording& recording) {
  const Vector& time = recording.time;
  const Index last = time.size() - 1;
  if (recording.untimed)
    return bad_data("C3D needs a sample rate, but the rows have no time", std::string(kOtherFormats));
  if (last < 1) return bad_data("C3D needs a sample rate, which one sample does not have", std::string(kOtherFormats));
  C3dClock clock{time[0], static_cast<double>(last) / (time[last] - time[0])};
  // A rate of few digits is meant if it is off by no more than the last time may be rounded.
  const std::string digits = fmt::format("{:.6g}", clock.rate_hz);
  double nominal = 0.0;
  std::from_chars(digits.data(), digits.data() + digits.size(), nominal);
  if (std::abs(nominal / clock.rate_hz - 1.0) * static_cast<double>(last) <= 1e-3) clock.rate_hz = nominal;
  for (Index k = 0; k <= last; ++k) {
    const double off = std::abs(time[k] - (time[0] + static_cast<double>(k) / clock.rate_hz));
    clock.deviation = off <= clock.deviation ? clock.deviation : off;  // also NaN
    if (clock.rate_hz > 0.0 && std::isfinite(clock.rate_hz) && off * clock.rate_hz <= kUnevenInC3d) continue;
    return bad_data(
        fmt::format("C3D stores no times, only a sample rate, but sample {} is not on an even clock", k + 1),
        "write .h5, .mat or .csv, which keep each time");
  }
  return clock;
}

/// The hand as a marker: its coordinates, which are positions of a length; empty if there are not at least x and y.
std::vector<const Channel*> hand_of(const Recording& recording) {
  std::vector<const Channel*> hand;
  for (const char* const name : {"hand_x", "hand_y", "hand_z"}) {
    const Channel* const found = recording.find(name);
    if (found == nullptr || found->unit != "m") break;
    hand.push_back(found);
  }
  if (hand.size() < 2) hand.clear();
  return hand;
}

/// Whether C3D can store the time of an event.
bool has_time(const Event& event) {
  return std::isfinite(event.time);
}

std::string label_of(const Event& event) {
  return std::string(whole_characters(event.name, kMaxC3dText));
}

/// @fails  data: a name or unit that would not come back
Result<void> check_texts(const Recording& recording, const std::map<std::string, std::string>& metadata) {
  const auto refused = [](std::string_view what, const std::string& text) {
    return bad_data(fmt::format("{} '{}' cannot be written in a C3D file", what, printable(text)),
                    fmt::format("use 1 to {} bytes without spaces around them", kMaxC3dText));
  };
  for (const Channel& channel : recording.channels) {
    if (!is_c3d_text(channel.name)) return refused("channel", channel.name);
    if (!channel.unit.empty() && !is_c3d_text(channel.unit)) return refused("unit", channel.unit);
  }
  for (const auto& [key, value] : metadata) {
    if (!is_c3d_text(key)) return refused("metadata", key);
  }
  return {};
}

/// @fails  data: a number beyond those of 32 bits
Result<void> check_numbers(const Recording& recording) {
  constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max()) / kMillimetres;
  for (const Channel& channel : recording.channels) {
    for (Index k = 0; k < channel.values.size(); ++k) {
      if (!std::isfinite(channel.values[k]) || std::abs(channel.values[k]) <= kLargest) continue;
      return bad_data(fmt::format("{} is {:.3g} at sample {}, which is too large for the single precision of C3D",
                                  channel.name, channel.values[k], k + 1),
                      std::string(kOtherFormats));
    }
  }
  return {};
}

void add_points(C3dRecords& records, const C3dClock& clock, std::size_t points, Index frames, std::size_t data_block) {
  const auto whole = static_cast<std::size_t>(frames);
  const std::vector<std::string> labels(points, "hand"), descriptions(points, "hand position, robot base frame");
  records.group("POINT");
  records.word("USED", points);
  records.real("SCALE", -1.0);  // negative: the numbers are reals
  records.real("RATE", clock.rate_hz);
  records.word("DATA_START", data_block);
  records.word("FRAMES", std::min<std::size_t>(whole, 65535));
  if (static_cast<double>(frames) > kMaxC3dWord) records.real("LONG_FRAMES", static_cast<double>(frames));
  records.text("UNITS", "mm");
  records.texts("LABELS", labels);
  records.texts("DESCRIPTIONS", descriptions);
  records.group("TRIAL");
  records.array("ACTUAL_START_FIELD", 2, {}, 2, c3d_word(1) + c3d_word(0));
  records.array("ACTUAL_END_FIELD", 2, {}, 2, c3d_word(whole & 0xFFFFu) + c3d_word(whole >> 16u));
}

void add_analog(C3dRecords& records, const C3dClock& clock, const std::vector<const Channel*>& channels) {
  std::vector<std::string> labels, units, descriptions;
  std::string scales, offsets;
  for (const Channel* const channel : channels) {
    labels.push_back(channel->name);
    units.push_back(channel->unit);
    descriptions.push_back(channel->frame.empty() ? "" : channel->frame + " frame");
    append_real(scales, 1.0);
    offsets += c3d_word(0);
  }
  records.group("ANALOG");
  records.word("USED", channels.size());
  records.real("RATE", clock.rate_hz);
  records.real("GEN_SCALE", 1.0);
  records.text("FORMAT", "SIGNED");
  records.texts("LABELS", labels);
  records.texts("UNITS", units);
  records.texts("DESCRIPTIONS", descriptions);
  records.array("SCALE", 4, {}, channels.size(), scales);
  records.array("OFFSET", 2, {}, channels.size(), offsets);
}

void add_events(C3dRecords& records, const C3dClock& clock, const std::vector<Event>& events,
                std::vector<std::string>& values) {
  std::vector<std::string> labels;
  std::string times;
  for (const Event& event : events) {
    if (!has_time(event)) continue;
    const double after = event.time - clock.start, minutes = std::trunc(after / 60.0);
    append_real(times, minutes);
    append_real(times, after - 60.0 * minutes);
    labels.push_back(label_of(event));
    values.push_back(exact_number(event.value));
  }
  const std::size_t count = labels.size();
  const std::vector<std::string> none(count);
  records.group("EVENT");
  records.word("USED", count);
  records.texts("CONTEXTS", none);  // neither left nor right
  records.texts("LABELS", labels);
  records.texts("DESCRIPTIONS", none);
  records.texts("SUBJECTS", none);
  records.array("TIMES", 4, {2}, count, times);
  records.array("ICON_IDS", 2, {}, count, std::string(2 * count, '\0'));
  records.array("GENERIC_FLAGS", 1, {}, count, std::string(count, '\1'));
}

/// The group that only mbk knows (take_own_group in c3d.cpp).
void add_own(C3dRecords& records, const C3dClock& clock, const std::vector<std::string>& values,
             const std::map<std::string, std::string>& metadata) {
  std::vector<std::string> keys, rows;  // a row without a key continues the value
  for (const auto& [key, value] : metadata) {
    std::string_view left = value;
    do {
      const std::string_view row = whole_characters(left, kMaxC3dText - 2);
      keys.push_back(row.data() == value.data() ? key : "");
      rows.push_back(fmt::format("\"{}\"", row));
      left.remove_prefix(row.size());
    } while (!left.empty());
  }
  records.group(kOwnC3dGroup);
  records.text("RATE", exact_number(clock.rate_hz));
  if (clock.start != 0.0) records.text("START", exact_number(clock.start));
  records.texts("EVENT_VALUES", values);
  records.texts("KEYS", keys);
  records.texts("VALUES", rows);
}

std::string c3d_parameters(const Recording& recording, const C3dClock& clock, std::size_t points,
                           const std::map<std::string, std::string>& metadata, std::size_t data_block) {
  C3dRecords records;
  std::vector<std::string> values;
  add_points(records, clock, points, recording.samples(), data_block);
  add_analog(records, clock, in_order(recording.channels));
  add_events(records, clock, recording.events, values);
  records.group("MANUFACTURER");
  records.text("SOFTWARE", "mbk");
  records.text("VERSION", version());
  add_own(records, clock, values, metadata);
  return records.bytes() + '\0';
}

std::string c3d_header(const C3dClock& clock, std::size_t points, std::size_t channels, Index frames,
                       std::size_t data_block) {
  constexpr std::size_t kFourLetterEvents = 12345;  // the key of events in the header, which has none
  std::string header = "\x02\x50" + c3d_word(points) + c3d_word(channels) + c3d_word(1);
  header += c3d_word(static_cast<std::size_t>(std::min(static_cast<double>(frames), kMaxC3dWord))) + c3d_word(0);
  header += c3d_real(-1.0) + c3d_word(data_block) + c3d_word(1) + c3d_real(clock.rate_hz);
  header.resize(c3d_header_word(150));
  header += c3d_word(kFourLetterEvents);
  header.resize(kC3dBlock);
  return header;
}

void append_data(std::string& bytes, const std::vector<const Channel*>& hand,
                 const std::vector<const Channel*>& channels, Index frames) {
  for (Index k = 0; k < frames; ++k) {
    if (!hand.empty()) {
      const bool seen = std::ranges::all_of(hand, [&](const Channel* one) { return std::isfinite(one->values[k]); });
      for (std::size_t axis = 0; axis < 3; ++axis) {
        append_real(bytes, seen && axis < hand.size() ? kMillimetres * hand[axis]->values[k] : 0.0);
      }
      append_real(bytes, seen ? 0.0 : -1.0);
    }
    for (const Channel* const channel : channels) {
      append_real(bytes, std::isfinite(channel->values[k]) ? channel->values[k] : kNaN);
    }
  }
}

}  // namespace

Result<std::string> encode_c3d(const Recording& recording) {
  const auto metadata = metadata_with_joints(recording);
  const C3dClock clock = MBK_TRY(c3d_clock(recording));
  MBK_TRY(check_texts(recording, metadata));
  MBK_TRY(check_numbers(recording));
  const std::vector<const Channel*> hand = hand_of(recording);
  const std::size_t points = hand.empty() ? 0 : 1;
  const auto parameters = [&](std::size_t data_block) {
    return c3d_parameters(recording, clock, points, metadata, data_block);
  };
  const std::size_t size = 4 + parameters(0).size(), blocks = (size + kC3dBlock - 1) / kC3dBlock;
  if (blocks > kMaxC3dBlocks) {
    return bad_data(fmt::format("names, units, events and metadata take {} bytes; a C3D file has room for {}", size,
                                kMaxC3dBlocks * kC3dBlock),
                    std::string(kOtherFormats));
  }
  const std::size_t data_block = 2 + blocks;
  std::string bytes = c3d_header(clock, points, recording.channels.size(), recording.samples(), data_block);
  bytes += {1, 0x50, static_cast<char>(blocks), static_cast<char>(C3dProcessor::intel)};
  bytes += parameters(data_block);
  bytes.resize((data_block - 1) * kC3dBlock);
  bytes.reserve(bytes.size() +
                4 * static_cast<std::size_t>(recording.samples()) * (recording.channels.size() + 4 * points));
  // No padding behind the data: some programs, which read POINT:FRAMES as a signed word, read to the end of the file.
  append_data(bytes, hand, in_order(recording.channels), recording.samples());
  return bytes;
}

std::vector<std::string> lost_in_c3d(const Recording& recording) {
  std::vector<std::string> lost;
  const auto clock = c3d_clock(recording);
  constexpr double kRounded = 1e-6;  // intervals
  if (clock && clock->deviation * clock->rate_hz > kRounded) {
    lost.push_back(
        fmt::format("the times: samples at {:.9g} Hz replace them, from which they deviate by up to {:.2g} s",
                    clock->rate_hz, clock->deviation));
  }
  for (const Channel& channel : recording.channels) {
    const Index missing = channel.values.size() - channel.values.array().isFinite().cast<Index>().sum();
    if (missing == 0) continue;
    lost.push_back(
        fmt::format("{} of {} values of {}, which are missing or infinite: NaN stands for them, which some "
                    "C3D programs misread",
                    missing, channel.values.size(), channel.name));
  }
  const auto timeless = std::ranges::count_if(recording.events, [](const Event& event) { return !has_time(event); });
  if (timeless > 0) lost.push_back(fmt::format("{} events without a time", timeless));
  const auto renamed = std::ranges::count_if(
      recording.events, [](const Event& event) { return has_time(event) && !is_c3d_text(event.name); });
  if (renamed > 0) {
    lost.push_back(fmt::format("{} event names as they are: C3D stores 1 to {} bytes without spaces around them",
                               renamed, kMaxC3dText));
  }
  return lost;
}

}  // namespace mbk::recording
