#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/base/system/files.h"

/// Work that is cut into chunks, which processes on one machine or on many do, each into a file of its own.
namespace mbk::batch {

/// What a record of a shard says.
enum class RecordKind : std::uint32_t {
  header = 1,     ///< whose shard it is, as JSON
  result = 2,     ///< what a unit gave
  failure = 3,    ///< why a unit gave nothing
  began = 4,      ///< a unit was begun; only where an earlier process ended in this chunk
  heartbeat = 5,  ///< the process lives
  end = 6,        ///< everything is there; JSON
};

/// Who writes a shard, and of what.
struct ShardHeader {
  std::string job, program;  ///< as in Job
  std::int64_t chunk = 0;
  std::string host;
  std::int64_t process = 0;
  std::string token;  ///< drawn by lot: no two shards share a name
};

[[nodiscard]] std::string to_json(const ShardHeader& header);
/// @fails  data: not such a document.
[[nodiscard]] Result<ShardHeader> shard_header_from(const std::string& json);

struct ShardRecord {
  RecordKind kind = RecordKind::heartbeat;
  std::uint64_t unit = 0;  ///< its number within the job, from 0
  std::string payload;
};

/// "000012.89abcdef01234567"
[[nodiscard]] std::string shard_stem(std::int64_t chunk, const std::string& token);
inline constexpr std::string_view kShardEnd = ".shard", kPartEnd = ".part", kDamagedEnd = ".damaged";

/// Writes a file that is only ever appended to: "MBKSHRD1", then records with a checksum each. Until it is whole its
/// name ends in .part; then it is flushed to the disk and renamed. May be used by several threads.
class ShardWriter {
 public:
  /// @param folder  of the shards
  /// @fails  data: the folder cannot be written.
  [[nodiscard]] static Result<std::unique_ptr<ShardWriter>> create(const std::filesystem::path& folder,
                                                                   const ShardHeader& header);
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;
  ~ShardWriter();

  /// Appends a record; it reaches the file within the next half second in which one is added, or at flush().
  /// @fails  data: the disk is full; it was closed.
  [[nodiscard]] Result<void> add(RecordKind kind, std::uint64_t unit, std::string_view payload);
  /// What was added is in the file.
  [[nodiscard]] Result<void> flush();
  /// What was added is on the disk.
  [[nodiscard]] Result<void> sync();
  /// Adds the last record, waits for the disk and gives the file its name.
  [[nodiscard]] Result<void> finish(std::string_view end);

  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

 private:
  ShardWriter(std::filesystem::path part, std::filesystem::path whole, system::OpenFile out);
  Result<void> write_waiting();
  void append(RecordKind kind, std::uint64_t unit, std::string_view payload);

  std::mutex mutex_;
  std::filesystem::path part_, whole_;
  system::OpenFile out_;
  std::string waiting_;
  double last_write_;
};

/// Reads the records of a shard, from the first on.
class ShardReader {
 public:
  /// @fails  data: it cannot be read, or is no shard.
  [[nodiscard]] static Result<ShardReader> open(const std::filesystem::path& file);

  /// The next record; nothing after the last one that is whole.
  /// @fails  data: a record is damaged.
  [[nodiscard]] Result<std::optional<ShardRecord>> next();

 private:
  explicit ShardReader(std::filesystem::path file) : file_(std::move(file)) {}
  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t left_ = 0;  ///< bytes
};

}  // namespace mbk::batch
