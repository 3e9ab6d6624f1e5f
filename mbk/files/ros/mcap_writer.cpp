#include "mbk/files/ros/mcap_writer.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

#include "mbk/files/ros/mcap.h"
#include "mbk/files/ros/stream.h"

namespace mbk::recording {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers of MCAP files are little-endian");

constexpr std::size_t kChunk = std::size_t{1} << 20;  ///< [bytes] from which on it is closed
constexpr int kLevel = 3;                             ///< of zstd

template <class Number>
std::string raw_number(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string counted(std::string_view bytes) {
  return raw_number(static_cast<std::uint32_t>(bytes.size())) + std::string(bytes);
}

std::string record(McapRecord kind, std::string_view content) {
  return static_cast<char>(kind) + raw_number(std::uint64_t{content.size()}) + std::string(content);
}

std::uint32_t crc_of(std::uint32_t before, std::string_view bytes) {
  return libdeflate_crc32(before, bytes.data(), bytes.size());
}

}  // namespace

template <class Number>
void CdrMessage::put(Number value) {
  constexpr std::size_t kHeader = 4;  // from which alignment does not count
  bytes_.append((sizeof value - (bytes_.size() - kHeader) % sizeof value) % sizeof value, '\0');
  bytes_ += raw_number(value);
}

void CdrMessage::add(double value) {
  put(value);
}
void CdrMessage::add(std::int32_t value) {
  put(value);
}
void CdrMessage::add(std::uint32_t value) {
  put(value);
}
void CdrMessage::add(std::string_view text) {
  put(static_cast<std::uint32_t>(text.size() + 1));
  bytes_ += text;
  bytes_ += '\0';
}
void CdrMessage::add_header(std::int64_t stamp, std::string_view frame) {
  add(static_cast<std::int32_t>(stamp / kSecond));
  add(static_cast<std::uint32_t>(stamp % kSecond));
  add(frame);
}

McapWriter::McapWriter(std::string_view library)
    : file_(std::string(kMcapMagic) + record(McapRecord::header, counted("ros2") + counted(library))) {}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view type, std::string_view definition) {
  channels_.emplace_back();
  const auto number = static_cast<std::uint16_t>(channels_.size());  // 0 is no schema
  const std::string records =
      record(McapRecord::schema, raw_number(number) + counted(type) + counted("ros2msg") + counted(definition)) +
      record(McapRecord::channel,
             raw_number(number) + raw_number(number) + counted(topic) + counted("cdr") + counted(""));
  file_ += records;
  descriptions_ += records;
  return number;
}

void McapWriter::add_metadata(std::string_view name, const std::map<std::string, std::string>& pairs) {
  std::string all;
  for (const auto& [key, value] : pairs) all += counted(key) + counted(value);
  const std::string bytes = record(McapRecord::metadata, counted(name) + counted(all));
  metadata_indexes_ += record(McapRecord::metadata_index, raw_number(std::uint64_t{file_.size()}) +
                                                              raw_number(std::uint64_t{bytes.size()}) + counted(name));
  file_ += bytes;
  ++metadata_;
}

Result<void> McapWriter::add_message(std::uint16_t channel, std::int64_t time, std::string_view message) {
  const auto stamp = static_cast<std::uint64_t>(time);
  Channel& own = channels_[channel - 1U];
  if (chunk_.empty()) chunk_first_ = chunk_last_ = stamp;
  if (messages_ == 0) first_ = last_ = stamp;
  chunk_first_ = std::min(chunk_first_, stamp);
  chunk_last_ = std::max(chunk_last_, stamp);
  first_ = std::min(first_, stamp);
  last_ = std::max(last_, stamp);
  own.index.emplace_back(stamp, chunk_.size());
  ++own.messages;
  ++messages_;
  chunk_ += record(McapRecord::message, raw_number(channel) + raw_number(own.sequence++) + raw_number(stamp) +
                                            raw_number(stamp) + std::string(message));
  return chunk_.size() < kChunk ? Result<void>() : close_chunk();
}

Result<void> McapWriter::close_chunk() {
  if (chunk_.empty()) return {};
  std::string packed(ZSTD_compressBound(chunk_.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), chunk_.data(), chunk_.size(), kLevel);
  if (ZSTD_isError(size) != 0) {
    return bad_data(fmt::format("a chunk cannot be packed: {}", ZSTD_getErrorName(size)));
  }
  packed.resize(size);
  const std::string bytes =
      record(McapRecord::chunk, raw_number(chunk_first_) + raw_number(chunk_last_) +
                                    raw_number(std::uint64_t{chunk_.size()}) + raw_number(crc_of(0, chunk_)) +
                                    counted("zstd") + raw_number(std::uint64_t{size}) + packed);
  const std::uint64_t begin = file_.size();
  file_ += bytes;
  std::string offsets;
  const std::uint64_t indexes = file_.size();
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    if (channels_[k].index.empty()) continue;
    const auto number = static_cast<std::uint16_t>(k + 1);
    offsets += raw_number(number) + raw_number(std::uint64_t{file_.size()});
    std::ranges::stable_sort(channels_[k].index, {}, &std::pair<std::uint64_t, std::uint64_t>::first);
    std::string entries;
    for (const auto& [time, offset] : channels_[k].index) entries += raw_number(time) + raw_number(offset);
    file_ += record(McapRecord::message_index, raw_number(number) + counted(entries));
    channels_[k].index.clear();
  }
  chunk_indexes_ +=
      record(McapRecord::chunk_index, raw_number(chunk_first_) + raw_number(chunk_last_) + raw_number(begin) +
                                          raw_number(std::uint64_t{bytes.size()}) + counted(offsets) +
                                          raw_number(std::uint64_t{file_.size() - indexes}) + counted("zstd") +
                                          raw_number(std::uint64_t{size}) + raw_number(std::uint64_t{chunk_.size()}));
  chunk_.clear();
  ++chunks_;
  return {};
}

Result<std::string> McapWriter::finish() {
  MBK_TRY(close_chunk());
  file_ += record(McapRecord::data_end, raw_number(crc_of(0, file_)));

  const std::uint64_t summary = file_.size();
  std::string counts;
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    counts += raw_number(static_cast<std::uint16_t>(k + 1)) + raw_number(channels_[k].messages);
  }
  const auto count = static_cast<std::uint32_t>(channels_.size());
  const std::string statistics = record(
      McapRecord::statistics, raw_number(messages_) + raw_number(static_cast<std::uint16_t>(count)) +
                                  raw_number(count) + raw_number(std::uint32_t{0}) + raw_number(metadata_) +
                                  raw_number(chunks_) + raw_number(first_) + raw_number(last_) + counted(counts));
  file_ += descriptions_;
  std::string offsets;
  const auto group = [&](McapRecord kind, const std::string& records) {
    if (records.empty()) return;
    offsets += record(McapRecord::summary_offset, static_cast<char>(kind) + raw_number(std::uint64_t{file_.size()}) +
                                                      raw_number(std::uint64_t{records.size()}));
    file_ += records;
  };
  group(McapRecord::statistics, statistics);
  group(McapRecord::chunk_index, chunk_indexes_);
  group(McapRecord::metadata_index, metadata_indexes_);
  const std::uint64_t summary_offsets = file_.size();
  file_ += offsets;
  const std::string places = raw_number(summary) + raw_number(summary_offsets);
  constexpr std::uint64_t kFooterSize = 20;
  file_ += static_cast<char>(McapRecord::footer) + raw_number(kFooterSize) + places;
  file_ += raw_number(crc_of(0, std::string_view(file_).substr(static_cast<std::size_t>(summary))));
  file_ += kMcapMagic;
  return std::move(file_);
}

}  // namespace mbk::recording
