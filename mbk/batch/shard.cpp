#include "mbk/batch/shard.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "mbk/files/contents/durable_files.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "MBKSHRD1";
constexpr std::size_t kWaitingBytes = std::size_t{1} << 18U;
constexpr std::uint32_t kLargestPayload = 1U << 28U;
constexpr double kLongestWait = 0.5;  // [s]

struct RecordHead {
  std::uint32_t kind = 0, bytes = 0;  ///< bytes: of the payload
  std::uint64_t unit = 0;
  std::uint32_t checksum = 0;  ///< CRC-32 of what stands before it, and of the payload
  std::uint32_t zero = 0;
};
static_assert(sizeof(RecordHead) == 24);

std::uint32_t checksum_of(const RecordHead& head, std::string_view payload) {
  const std::uint32_t sum = libdeflate_crc32(0, &head, offsetof(RecordHead, checksum));
  // of no bytes it would begin anew
  return payload.empty() ? sum : libdeflate_crc32(sum, payload.data(), payload.size());
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

tl::unexpected<Error> not_written(const fs::path& file, int code) {
  return bad_data(fmt::format("cannot be written: {}", std::generic_category().message(code)),
                  system::is_full(code) ? "free space on the disk; finished chunks are kept"
                                        : "check the disk and the permissions of the folder",
                  file.string());
}

}  // namespace

std::string to_json(const ShardHeader& header) {
  return nlohmann::json{{"job", header.job},   {"program", header.program}, {"chunk", header.chunk},
                        {"host", header.host}, {"process", header.process}, {"token", header.token}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<ShardHeader> shard_header_from(const std::string& json) {
  try {
    const auto document = nlohmann::json::parse(json);
    return ShardHeader{document.at("job"),  document.at("program"), document.at("chunk"),
                       document.at("host"), document.at("process"), document.at("token")};
  } catch (const nlohmann::json::exception&) {
    return bad_data("the shard's header cannot be read");
  }
}

std::string shard_stem(std::int64_t chunk, const std::string& token) {
  return fmt::format("{:06}.{}", chunk, token);
}

ShardWriter::ShardWriter(fs::path part, fs::path whole, system::OpenFile out)
    : part_(std::move(part)), whole_(std::move(whole)), out_(std::move(out)), last_write_(now()) {}

ShardWriter::~ShardWriter() = default;

Result<std::unique_ptr<ShardWriter>> ShardWriter::create(const fs::path& folder, const ShardHeader& header) {
  const std::string stem = shard_stem(header.chunk, header.token);
  fs::path part = folder / (stem + std::string(kPartEnd));
  system::OpenFile out = system::create_new(part);
  if (!out) return not_written(part, errno);
  std::unique_ptr<ShardWriter> writer(
      new ShardWriter(std::move(part), folder / (stem + std::string(kShardEnd)), std::move(out)));
  writer->waiting_ = kMagic;
  writer->append(RecordKind::header, 0, to_json(header));
  MBK_TRY(writer->sync());
  return writer;
}

void ShardWriter::append(RecordKind kind, std::uint64_t unit, std::string_view payload) {
  RecordHead head{static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(payload.size()), unit};
  head.checksum = checksum_of(head, payload);
  waiting_.append(reinterpret_cast<const char*>(&head), sizeof head);
  waiting_ += payload;
}

Result<void> ShardWriter::write_waiting() {
  last_write_ = now();
  if (!out_) return bad_data("the shard is closed", "", part_.string());
  std::size_t wrote = 0;
  const int code = system::write_all(out_.number(), std::as_bytes(std::span(waiting_)), &wrote);
  waiting_.erase(0, wrote);  // so that it could go on where it ended
  if (code != 0) return not_written(part_, code);
  return {};
}

Result<void> ShardWriter::add(RecordKind kind, std::uint64_t unit, std::string_view payload) {
  if (payload.size() > kLargestPayload) return bad_data("a result is larger than 256 MB", "", part_.string());
  const std::lock_guard lock(mutex_);
  append(kind, unit, payload);
  if (waiting_.size() < kWaitingBytes && now() - last_write_ < kLongestWait) return {};
  return write_waiting();
}

Result<void> ShardWriter::flush() {
  const std::lock_guard lock(mutex_);
  return write_waiting();
}

Result<void> ShardWriter::sync() {
  const std::lock_guard lock(mutex_);
  MBK_TRY(write_waiting());
  if (const int code = system::flush(out_); code != 0) return not_written(part_, code);
  return {};
}

Result<void> ShardWriter::finish(std::string_view end) {
  MBK_TRY(add(RecordKind::end, 0, end));
  MBK_TRY(sync());
  const std::lock_guard lock(mutex_);
  if (const int code = out_.close(); code != 0) return not_written(part_, code);
  return files::rename_on_disk(part_, whole_);
}

Result<ShardReader> ShardReader::open(const fs::path& file) {
  ShardReader reader(file);
  reader.stream_.open(file, std::ios::binary);
  std::error_code error;
  const auto bytes = fs::file_size(file, error);
  if (!reader.stream_ || error) return bad_data("cannot be read", "check its permissions", file.string());
  std::array<char, kMagic.size()> magic{};
  reader.stream_.read(magic.data(), magic.size());
  if (!reader.stream_ || std::string_view(magic.data(), magic.size()) != kMagic) {
    return bad_data("the file is not a shard", "", file.string());
  }
  reader.left_ = bytes - kMagic.size();
  return reader;
}

Result<std::optional<ShardRecord>> ShardReader::next() {
  RecordHead head;
  if (left_ < sizeof head) return std::optional<ShardRecord>();
  stream_.read(reinterpret_cast<char*>(&head), sizeof head);
  if (!stream_) return bad_data("cannot be read", "check the disk", file_.string());
  left_ -= sizeof head;
  if (head.bytes > kLargestPayload) return bad_data("a record is damaged", "", file_.string());
  if (head.bytes > left_) {  // the rest of it never came
    left_ = 0;
    return std::optional<ShardRecord>();
  }
  ShardRecord record{static_cast<RecordKind>(head.kind), head.unit, std::string(head.bytes, '\0')};
  stream_.read(record.payload.data(), head.bytes);
  if (!stream_) return bad_data("cannot be read", "check the disk", file_.string());
  left_ -= head.bytes;
  if (checksum_of(head, record.payload) != head.checksum) {
    return bad_data("a record is damaged", "", file_.string());
  }
  return std::optional(std::move(record));
}

}  // namespace mbk::batch
