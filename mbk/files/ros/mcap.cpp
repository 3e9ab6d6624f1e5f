#include "mbk/files/ros/mcap.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/ros/forward_bytes.h"
#include "mbk/files/ros/topics.h"

namespace mbk::recording {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers of MCAP files are little-endian");

constexpr std::size_t kRecordHeader = 9;    ///< kind, length
constexpr std::size_t kMessageHeader = 22;  ///< of a message
constexpr std::size_t kFooter = 20;
constexpr std::uint64_t kLargestRecord = std::uint64_t{4} << 20;  ///< of those that describe

/// Fields of a record, one after the other. Once it has failed, whatever it gives says nothing.
class McapFields {
 public:
  explicit McapFields(std::span<const std::byte> record) : bytes_(record) {}
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool at_end() const { return failed_ || bytes_.empty(); }

  template <class Number>
  Number number() {
    Number value{};
    const auto raw = part(sizeof value);
    if (!failed_) std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  std::string text() {
    const auto raw = part(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  std::map<std::string, std::string> pairs() {
    McapFields inner(part(number<std::uint32_t>()));
    std::map<std::string, std::string> found;
    while (!inner.at_end()) {
      std::string key = inner.text();
      std::string value = inner.text();
      if (!inner.failed()) found.insert_or_assign(std::move(key), std::move(value));
    }
    failed_ = failed_ || inner.failed();
    return found;
  }

 private:
  std::span<const std::byte> part(std::uint64_t count) {
    failed_ = failed_ || count > bytes_.size();
    if (failed_) return {};
    const auto part = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(part.size());
    return part;
  }
  std::span<const std::byte> bytes_;
  bool failed_ = false;
};

std::optional<Packing> packing_called(std::string_view name) {
  if (name.empty()) return Packing::none;
  if (name == "zstd") return Packing::zstd;
  if (name == "lz4") return Packing::lz4;
  return std::nullopt;
}

/// A type of messages.
struct Schema {
  std::string name, encoding, definition;
};

class McapDecoder {
 public:
  /// @param size  of all bytes
  McapDecoder(ForwardBytes& bytes, std::uint64_t size) : bytes_(bytes), size_(size), topics_(size) {}

  Result<Contents> run() {
    MBK_TRY(bytes_.take(kMcapMagic.size()));
    while (!ended_) {
      MBK_TRY(take_record(bytes_, size_ - bytes_.position(), false));
    }
    MBK_TRY(bytes_.skip(size_ - bytes_.position()));
    Contents contents = topics_.contents("MCAP", own_);
    for (auto& [key, value] : metadata_) contents.metadata.insert_or_assign(key, std::move(value));
    if (!strange_metadata_.empty()) {
      contents.notes.push_back(
          printable(fmt::format("its metadata records were not copied: {}", fmt::join(strange_metadata_, ", "))));
    }
    for (std::string& note : notes_) contents.notes.push_back(std::move(note));
    return contents;
  }

 private:
  [[nodiscard]] std::string place() const { return fmt::format("byte {}", bytes_.position()); }

  [[nodiscard]] tl::unexpected<Error> odd(std::string_view record) const {
    return bad_data(fmt::format("a {} record is malformed", record), std::string(kCopyAgain), place());
  }

  void cut_short(std::uint64_t at) {
    ended_ = true;
    notes_.push_back(fmt::format(
        "the file is truncated: it ends within a record or without a footer; it was read up to byte {}", at));
  }

  /// One record, of the file or of a chunk.
  /// @param left  bytes there
  Result<void> take_record(ForwardBytes& from, std::uint64_t left, bool in_chunk) {
    const std::uint64_t at = bytes_.position();
    const std::uint32_t crc = bytes_.crc();
    const auto header = MBK_TRY(from.take(kRecordHeader));
    if (header.size() < kRecordHeader) {
      if (in_chunk) return odd("chunk");
      cut_short(at);
      return {};
    }
    const auto kind = static_cast<McapRecord>(header[0]);
    std::uint64_t length = 0;
    std::memcpy(&length, header.data() + 1, sizeof length);
    if (left < kRecordHeader || length > left - kRecordHeader) {
      if (in_chunk) return odd("chunk");
      cut_short(at);
      return {};
    }
    if (kind == McapRecord::message) return take_message(from, length);
    if (!in_chunk && kind == McapRecord::chunk) return take_chunk(length);
    if (!in_chunk && kind == McapRecord::footer) return take_footer(length);
    const bool describes = kind == McapRecord::schema || kind == McapRecord::channel ||
                           (kind == McapRecord::metadata && !in_chunk) || (kind == McapRecord::data_end && !in_chunk);
    if (!describes || length > kLargestRecord) return leave_out(from, length);
    const auto record = MBK_TRY(from.take(static_cast<std::size_t>(length)));
    if (record.size() < length) return odd("last");
    if (kind == McapRecord::schema) return take_schema(McapFields(record));
    if (kind == McapRecord::channel) return take_channel(McapFields(record));
    if (kind == McapRecord::metadata) return take_metadata(McapFields(record));
    return take_data_end(McapFields(record), crc);
  }

  static Result<void> leave_out(ForwardBytes& from, std::uint64_t length) {
    const auto all = MBK_TRY(from.skip(length));
    if (!all) return bad_data("a chunk ends within a record", std::string(kCopyAgain));
    return {};
  }

  Result<void> take_schema(McapFields record) {
    const auto id = record.number<std::uint16_t>();
    Schema schema{record.text(), record.text(), record.text()};
    if (record.failed()) return odd("schema");
    schemas_.emplace(id, std::move(schema));
    return {};
  }

  Result<void> take_channel(McapFields record) {
    const auto id = record.number<std::uint16_t>();
    const auto schema = record.number<std::uint16_t>();
    TopicDescription description;
    description.topic = record.text();
    description.encoding = record.text();
    if (record.failed()) return odd("channel");
    if (const auto known = schemas_.find(schema); known != schemas_.end()) {
      description.type = known->second.name;
      description.schema_encoding = known->second.encoding;
      description.definition = known->second.definition;
    }
    topics_.add(id, description);
    return {};
  }

  Result<void> take_metadata(McapFields record) {
    const std::string name = record.text();
    auto pairs = record.pairs();
    if (record.failed()) return odd("metadata");
    if (name == kMcapLayoutRecord) {
      own_ = true;
    } else if (name == kMcapMetadataRecord && own_) {
      for (auto& [key, value] : pairs) metadata_[printable(key)] = printable(value);
    } else if (strange_metadata_.size() < 12) {
      strange_metadata_.insert(fmt::format("'{}'", name));
    }
    return {};
  }

  Result<void> take_message(ForwardBytes& from, std::uint64_t length) {
    if (length < kMessageHeader) return odd("message");
    const auto header = MBK_TRY(from.take(kMessageHeader));
    if (header.size() < kMessageHeader) return odd("message");
    McapFields fields(header);
    const auto channel = fields.number<std::uint16_t>();
    fields.number<std::uint32_t>();
    const auto log_time = fields.number<std::uint64_t>();
    length -= kMessageHeader;
    if (!topics_.wants(channel) || length > kLargestMessage) {
      topics_.leave_out(channel);
      return leave_out(from, length);
    }
    const auto message = MBK_TRY(from.take(static_cast<std::size_t>(length)));
    if (message.size() < length) return odd("message");
    return topics_.message(channel, log_time, message);
  }

  Result<void> take_chunk(std::uint64_t length) {
    PartOfBytes chunk(bytes_, length);
    const std::string where = place();
    const auto header = MBK_TRY(chunk.take(32));
    McapFields fields(header);
    fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const auto name_size = fields.number<std::uint32_t>();
    if (fields.failed() || name_size > 64) return odd("chunk");
    const auto name = MBK_TRY(chunk.take(name_size));
    const std::string called(reinterpret_cast<const char*>(name.data()), name.size());
    const auto packing = packing_called(called);
    if (!packing) {
      return bad_data(fmt::format("a chunk is compressed with '{}', which is not supported", called),
                      "compress it with zstd or lz4, or not at all ('mcap compress')", where);
    }
    const auto record_size = MBK_TRY(chunk.take(sizeof(std::uint64_t)));
    McapFields rest(record_size);
    const auto packed_size = rest.number<std::uint64_t>();
    if (rest.failed() || packed_size != chunk.left()) return odd("chunk");

    const auto records = unpacked(*packing, chunk);
    while (records->position() < size) {
      if (auto ok = take_record(*records, size - records->position(), true); !ok) {
        return tl::unexpected(ok.error().where.empty() ? ok.error().in(where) : ok.error());
      }
    }
    const auto more = records->take(1);
    if (!more) return tl::unexpected(more.error().in(where));
    if (!more->empty()) return bad_data("a chunk is longer than its stated size", std::string(kCopyAgain), where);
    if (crc != 0 && crc != records->crc()) {
      return bad_data("the checksum of a chunk is wrong", std::string(kCopyAgain), where);
    }
    return leave_out(chunk, chunk.left());
  }

  Result<void> take_data_end(McapFields record, std::uint32_t crc) {
    const auto said = record.number<std::uint32_t>();
    if (record.failed()) return odd("last data");
    if (said != 0 && said != crc) {
      return bad_data("the checksum of the data section is wrong", std::string(kCopyAgain));
    }
    bytes_.restart_crc();
    in_summary_ = true;
    return {};
  }

  Result<void> take_footer(std::uint64_t length) {
    if (length < kFooter) return odd("footer");
    MBK_TRY(leave_out(bytes_, kFooter - 4));
    const std::uint32_t crc = bytes_.crc();
    const auto sum = MBK_TRY(bytes_.take(4));
    const auto said = McapFields(sum).number<std::uint32_t>();
    if (said != 0 && in_summary_ && said != crc) {
      return bad_data("the checksum of the summary section is wrong", std::string(kCopyAgain));
    }
    MBK_TRY(leave_out(bytes_, length - kFooter));
    const auto magic = MBK_TRY(bytes_.take(kMcapMagic.size()));
    if (std::string_view(reinterpret_cast<const char*>(magic.data()), magic.size()) != kMcapMagic) {
      notes_.emplace_back("the file lacks the end magic of MCAP; all of its records were read");
    }
    ended_ = true;
    return {};
  }

  ForwardBytes& bytes_;
  std::uint64_t size_;
  bool ended_ = false, in_summary_ = false;
  bool own_ = false;  ///< mbk wrote it
  std::map<std::uint16_t, Schema> schemas_;
  Topics topics_;
  std::map<std::string, std::string> metadata_;
  std::set<std::string> strange_metadata_;
  std::vector<std::string> notes_;
};

}  // namespace

bool looks_like_mcap(std::span<const std::byte> begin) {
  return begin.size() >= kMcapMagic.size() && std::memcmp(begin.data(), kMcapMagic.data(), kMcapMagic.size()) == 0;
}

Result<Contents> decode_mcap(std::span<const std::byte> file) {
  GivenBytes bytes(file);
  return McapDecoder(bytes, file.size()).run();
}

Result<Contents> decode_mcap(FileInPassing& file) {
  PassingBytes bytes(file);
  return McapDecoder(bytes, file.size()).run();
}

}  // namespace mbk::recording
