#include "mbk/files/xdf/xdf_chunks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/whole_numbers.h"
#include "mbk/files/xdf/xdf.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kMagic = "XDF:";
constexpr std::string_view kBoundary("\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4", 16);
constexpr std::size_t kStampSize = sizeof(double);
constexpr std::size_t kMaxDamageListed = 5;  ///< places of damage that are named one by one

enum class Tag : std::uint16_t { file_header = 1, stream_header, samples, clock_offset, boundary, stream_footer };

struct ValueName {
  std::string_view name;
  XdfValue value;
  std::size_t size;  ///< [bytes]; of a string the least
};
constexpr auto kValues = std::to_array<ValueName>({
    {"int8", XdfValue::int8, 1},
    {"int16", XdfValue::int16, 2},
    {"int32", XdfValue::int32, 4},
    {"int64", XdfValue::int64, 8},
    {"float32", XdfValue::float32, 4},
    {"double64", XdfValue::double64, 8},
    {"string", XdfValue::string, 1},
});

std::size_t size_of(XdfValue value) {
  return std::ranges::find(kValues, value, &ValueName::value)->size;
}

/// Bytes that are read sequentially. Missing bytes make this and all later reads fail.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : view_{bytes, std::endian::native == std::endian::big} {}

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t place() const { return place_; }
  [[nodiscard]] std::size_t left() const { return view_.size() - place_; }

  template <class Value>
  Value take() {
    if (!need(sizeof(Value))) return Value();
    const Value value = view_.at<Value>(place_);
    place_ += sizeof(Value);
    return value;
  }
  /// A number of one, four or eight bytes, behind a byte that says how many.
  std::uint64_t take_length() {
    switch (take<std::uint8_t>()) {
      case 1:
        return take<std::uint8_t>();
      case 4:
        return take<std::uint32_t>();
      case 8:
        return take<std::uint64_t>();
      default:
        failed_ = true;
        return 0;
    }
  }
  std::string_view take_text(std::uint64_t size) {
    if (!need(size)) return {};
    const auto begin = place_;
    place_ += static_cast<std::size_t>(size);
    return {reinterpret_cast<const char*>(view_.bytes.data()) + begin, static_cast<std::size_t>(size)};
  }
  void skip(std::uint64_t size) { take_text(size); }
  void fail() { failed_ = true; }

 private:
  bool need(std::uint64_t size) {
    failed_ = failed_ || size > left();
    return !failed_;
  }

  ByteView view_;
  std::size_t place_ = 0;
  bool failed_ = false;
};

/// @param rounded  by which doubles changed whole numbers, at most
double take_value(Reader& reader, XdfValue value, std::int16_t& rounded) {
  switch (value) {
    case XdfValue::int8:
      return reader.take<std::int8_t>();
    case XdfValue::int16:
      return reader.take<std::int16_t>();
    case XdfValue::int32:
      return reader.take<std::int32_t>();
    case XdfValue::int64: {
      const auto whole = reader.take<std::int64_t>();
      const std::int16_t rest = rest_of(whole);
      rounded = std::max(rounded, static_cast<std::int16_t>(rest < 0 ? -rest : rest));
      return static_cast<double>(whole);
    }
    case XdfValue::float32:
      return static_cast<double>(reader.take<float>());
    case XdfValue::double64:
    case XdfValue::string:
      break;
  }
  return reader.take<double>();
}

/// The stamp of a sample; NaN if it has none, or an invalid one.
double take_stamp(Reader& reader) {
  const auto size = reader.take<std::uint8_t>();
  if (size != 0 && size != kStampSize) reader.fail();
  const double stamp = size == kStampSize ? reader.take<double>() : std::numeric_limits<double>::quiet_NaN();
  return std::abs(stamp) < kLargestTime ? stamp : std::numeric_limits<double>::quiet_NaN();
}

/// One line of text of the file. A comma would end the entry of --channels that names it.
std::string one_line(std::string_view text) {
  std::string line = printable(std::string(trimmed(text)));
  std::ranges::replace(line, ',', ';');
  return line;
}

bool parse(pugi::xml_document& document, std::string_view text) {
  return static_cast<bool>(document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8));
}

class Parser {
 public:
  explicit Parser(std::span<const std::byte> file) : bytes_(file) {}

  Result<XdfFile> run() {
    const std::string_view text = text_of(0, bytes_.size());
    std::size_t place = kMagic.size();
    while (place < bytes_.size()) {
      const std::size_t next = read_chunk(place);
      if (next != 0) {
        place = next;
        continue;
      }
      const auto boundary = text.find(kBoundary, place);
      const std::size_t resume = boundary == text.npos ? bytes_.size() : boundary + kBoundary.size();
      damage_.push_back({place, resume});
      place = resume;
    }
    say_what_was_lost();
    MBK_TRY(fill());
    return std::move(file_);
  }

 private:
  struct Samples {
    std::size_t stream;
    std::size_t begin, end;  ///< [bytes] of the samples
    Index count;
  };
  struct Damage {
    std::size_t begin, end;
  };

  [[nodiscard]] std::string_view text_of(std::size_t begin, std::size_t size) const {
    return {reinterpret_cast<const char*>(bytes_.data()) + begin, size};
  }

  /// @returns  where the next chunk begins; 0: here is none, or it is damaged
  std::size_t read_chunk(std::size_t place) {
    Reader reader(bytes_.subspan(place));
    const std::uint64_t length = reader.take_length();
    const std::size_t begin = place + reader.place();
    const auto tag = reader.take<std::uint16_t>();
    if (reader.failed() || length < sizeof tag || length > bytes_.size() - begin) return 0;
    const std::size_t end = begin + static_cast<std::size_t>(length);
    const std::size_t content = begin + sizeof tag;
    return read_content(static_cast<Tag>(tag), content, end) ? end : 0;
  }

  bool read_content(Tag tag, std::size_t begin, std::size_t end) {
    Reader reader(bytes_.subspan(begin, end - begin));
    switch (tag) {
      case Tag::file_header:
        return read_file_header(reader);
      case Tag::boundary:
        return text_of(begin, end - begin) == kBoundary;
      case Tag::stream_header:
      case Tag::samples:
      case Tag::clock_offset:
      case Tag::stream_footer:
        break;
      default:
        return is_chunk_or_end(end);  // of a kind that is not known yet
    }
    const auto id = reader.take<std::uint32_t>();
    if (reader.failed()) return false;
    if (tag == Tag::stream_header) return read_stream_header(id, reader);
    const auto known = by_id_.find(id);
    if (known == by_id_.end()) {
      without_header_.push_back(id);
      return is_chunk_or_end(end);
    }
    if (tag == Tag::samples) return read_samples(known->second, reader, begin);
    if (tag == Tag::clock_offset) return read_clock_offset(known->second, reader);
    return read_footer(known->second, reader);
  }

  [[nodiscard]] bool is_chunk_or_end(std::size_t place) const {
    if (place == bytes_.size()) return true;
    Reader reader(bytes_.subspan(place));
    const std::uint64_t length = reader.take_length();
    const auto tag = reader.take<std::uint16_t>();
    return !reader.failed() && tag >= 1 && tag <= 6 && length - sizeof tag <= reader.left();
  }

  bool read_file_header(Reader& reader) {
    pugi::xml_document document;
    if (!parse(document, reader.take_text(reader.left()))) return false;
    const pugi::xml_node info = document.child("info");
    file_.recorded = one_line(info.child_value("datetime"));
    const std::string version = one_line(info.child_value("version"));
    if (version != "1.0" && version != "1") {
      file_.notes.push_back(fmt::format("the file states XDF version '{}'; it was read as version 1.0", version));
    }
    return true;
  }

  bool read_stream_header(std::uint32_t id, Reader& reader) {
    pugi::xml_document document;
    if (!parse(document, reader.take_text(reader.left()))) return false;
    const pugi::xml_node info = document.child("info");
    const auto kind =
        std::ranges::find(kValues, std::string_view(info.child_value("channel_format")), &ValueName::name);
    const long long count = info.child("channel_count").text().as_llong(-1);
    if (by_id_.contains(id)) {
      file_.notes.push_back(fmt::format("a second header of stream {} was ignored", id));
      return true;
    }
    XdfStream stream;
    stream.id = id;
    stream.name = one_line(info.child_value("name"));
    stream.type = one_line(info.child_value("type"));
    if (kind == kValues.end() || count < 1 || count > static_cast<long long>(kMaxXdfChannels)) {
      file_.notes.push_back(fmt::format("stream {} '{}' was ignored: {} channels of format '{}' are not possible", id,
                                        stream.name, count, one_line(info.child_value("channel_format"))));
      return true;
    }
    stream.value = kind->value;
    const double rate = info.child("nominal_srate").text().as_double(0.0);
    stream.nominal_hz = rate > 0.0 && rate < kLargestRate ? rate : 0.0;
    const pugi::xml_node description = info.child("desc");
    const std::string_view drops = description.child("synchronization").child_value("can_drop_samples");
    stream.can_drop_samples = trimmed(drops) == "true";
    stream.channels.resize(static_cast<std::size_t>(count));
    std::size_t k = 0;
    for (const pugi::xml_node channel : description.child("channels").children("channel")) {
      if (k == stream.channels.size()) break;
      stream.channels[k++] = {one_line(channel.child_value("label")),
                              printable(std::string(trimmed(channel.child_value("unit"))))};
    }
    by_id_[id] = file_.streams.size();
    counts_.push_back(0);
    file_.streams.push_back(std::move(stream));
    return true;
  }

  /// Counts samples, and makes sure that they fill the chunk.
  bool read_samples(std::size_t index, Reader& reader, std::size_t begin) {
    const XdfStream& stream = file_.streams[index];
    const std::uint64_t count = reader.take_length();
    const std::size_t first = begin + reader.place();
    const std::size_t least = 1 + stream.channels.size() * size_of(stream.value);
    if (reader.failed() || count > reader.left() / least) return false;
    for (std::uint64_t k = 0; k < count && !reader.failed(); ++k) {
      take_stamp(reader);
      if (stream.value != XdfValue::string) {
        reader.skip(stream.channels.size() * size_of(stream.value));
        continue;
      }
      for (std::size_t c = 0; c < stream.channels.size(); ++c) reader.skip(reader.take_length());
    }
    if (reader.failed() || reader.left() > 0) return false;
    samples_.push_back({index, first, begin + reader.place(), static_cast<Index>(count)});
    counts_[index] += static_cast<Index>(count);
    return true;
  }

  bool read_clock_offset(std::size_t index, Reader& reader) {
    const auto time = reader.take<double>(), value = reader.take<double>();
    if (reader.failed() || reader.left() > 0) return false;
    file_.streams[index].offsets.push_back({time, value, counts_[index]});
    return true;
  }

  bool read_footer(std::size_t index, Reader& reader) {
    pugi::xml_document document;
    if (!parse(document, reader.take_text(reader.left()))) return false;
    const long long total = document.child("info").child("sample_count").text().as_llong(-1);
    if (total >= 0) file_.streams[index].total = static_cast<std::uint64_t>(total);
    return true;
  }

  void say_what_was_lost() {
    std::size_t lost = 0;
    for (std::size_t k = 0; k < damage_.size(); ++k) {
      const Damage& one = damage_[k];
      lost += one.end - one.begin;
      if (k >= kMaxDamageListed) continue;
      file_.notes.push_back(
          fmt::format("the file is damaged at byte {}: {} bytes were lost, {}", one.begin, one.end - one.begin,
                      one.end == bytes_.size() ? "up to the end of the file" : "up to the next boundary"));
    }
    if (damage_.size() > kMaxDamageListed) {
      file_.notes.push_back(
          fmt::format("the file is damaged in {} places; {} bytes were lost in total", damage_.size(), lost));
    }
    if (!without_header_.empty()) {
      std::ranges::sort(without_header_);
      const std::size_t chunks = without_header_.size();
      const auto same = std::ranges::unique(without_header_);
      without_header_.erase(same.begin(), same.end());
      file_.notes.push_back(fmt::format("{} chunks belong to {} streams whose headers are missing or were ignored",
                                        chunks, without_header_.size()));
    }
  }

  Result<void> fill() {
    std::uint64_t numbers = 0;
    for (std::size_t s = 0; s < file_.streams.size(); ++s) {
      const XdfStream& stream = file_.streams[s];
      const std::uint64_t columns = 3 + (stream.value == XdfValue::string ? 0 : stream.channels.size());
      numbers += static_cast<std::uint64_t>(counts_[s]) * columns;
    }
    MBK_TRY(check_memory(numbers * sizeof(double)));
    for (std::size_t s = 0; s < file_.streams.size(); ++s) {
      XdfStream& stream = file_.streams[s];
      stream.stamps.resize(counts_[s]);
      if (stream.value != XdfValue::string && counts_[s] > 0) {
        stream.values.assign(stream.channels.size(), Vector(counts_[s]));
      }
    }
    std::vector<Index> next(file_.streams.size(), 0);
    for (const Samples& samples : samples_) {
      XdfStream& stream = file_.streams[samples.stream];
      Reader reader(bytes_.subspan(samples.begin, samples.end - samples.begin));
      for (Index k = 0; k < samples.count; ++k) {
        const Index at = next[samples.stream]++;
        stream.stamps[at] = take_stamp(reader);
        for (std::size_t c = 0; c < stream.channels.size(); ++c) {
          if (stream.value == XdfValue::string) {
            stream.texts.push_back(printable(std::string(reader.take_text(reader.take_length()))));
          } else {
            stream.values[c][at] = take_value(reader, stream.value, stream.channels[c].rounded);
          }
        }
      }
    }
    return {};
  }

  std::span<const std::byte> bytes_;
  XdfFile file_;
  std::map<std::uint32_t, std::size_t> by_id_;  ///< place among the streams
  std::vector<Index> counts_;                   ///< samples of each stream so far
  std::vector<Samples> samples_;
  std::vector<Damage> damage_;
  std::vector<std::uint32_t> without_header_;
};

}  // namespace

bool looks_like_xdf(std::span<const std::byte> file) {
  return file.size() >= kMagic.size() &&
         std::string_view(reinterpret_cast<const char*>(file.data()), kMagic.size()) == kMagic;
}

Result<XdfFile> parse_xdf(std::span<const std::byte> file) {
  if (!looks_like_xdf(file)) return bad_data("the file has no XDF signature");
  return Parser(file).run();
}

}  // namespace mbk::recording
