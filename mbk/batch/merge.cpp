#include "mbk/batch/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tuple>

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;

bool is_unit(RecordKind kind) {
  return kind == RecordKind::result || kind == RecordKind::failure;
}

/// The next result or failure, or the end.
Result<ShardRecord> next_unit(ShardReader& reader, const fs::path& file) {
  while (true) {
    auto record = MBK_TRY(reader.next());
    if (!record) return bad_data("the file ends early", "", file.string());
    if (is_unit(record->kind) || record->kind == RecordKind::end) return std::move(*record);
  }
}

/// The next unit of a shard must have that number.
Result<ShardRecord> unit_of(ShardReader& reader, const fs::path& file, std::int64_t number) {
  auto record = next_unit(reader, file);
  if (record && (record->kind == RecordKind::end || record->unit != static_cast<std::uint64_t>(number))) {
    return bad_data(fmt::format("unit {} is missing", number), "", file.string());
  }
  return record;
}

}  // namespace

Result<std::vector<ShardFile>> list_shards(const JobFolder& folder) {
  std::vector<ShardFile> files;
  std::error_code error;
  auto at = fs::directory_iterator(folder.shards(), error);
  for (; !error && at != fs::directory_iterator(); at.increment(error)) {
    const std::string name = at->path().filename().string();
    ShardFile file;
    if (name.ends_with(kShardEnd)) {
      file.state = ShardFile::State::whole;
    } else if (!name.ends_with(kPartEnd)) {
      continue;
    }
    const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), file.chunk);
    if (code != std::errc() || *end != '.') continue;
    file.path = at->path();
    files.push_back(std::move(file));
  }
  if (error) return bad_data(error.message(), "check that the folder is there", folder.shards().string());
  std::ranges::sort(files, {}, [](const ShardFile& file) { return std::tie(file.chunk, file.path); });
  return files;
}

Result<ShardReader> open_shard_of(const JobFolder& folder, const fs::path& file, std::int64_t chunk) {
  auto reader = ShardReader::open(file);
  if (!reader) return reader;
  const auto record = MBK_TRY(reader->next());
  if (!record || record->kind != RecordKind::header) return bad_data("the file has no header", "", file.string());
  const auto header = shard_header_from(record->payload);
  if (!header) return tl::unexpected(header.error().in(file.string()));
  if (header->program != folder.job().program) {
    return bad_data(
        fmt::format("it was written by mbk {}, but the job is of mbk {}", header->program, folder.job().program),
        "use the same program on every computer", file.string());
  }
  if (header->job != folder.job().id || header->chunk != chunk) {
    return bad_data("it belongs to another job or chunk", "remove it", file.string());
  }
  return reader;
}

Result<ShardEnd> check_shard(const JobFolder& folder, const Chunk& chunk, const fs::path& file) {
  auto reader = MBK_TRY(open_shard_of(folder, file, chunk.number));
  for (std::int64_t k = 0; k < chunk.count; ++k) {
    MBK_TRY(unit_of(reader, file, chunk.first + k));
  }
  const auto end = MBK_TRY(next_unit(reader, file));
  if (end.kind != RecordKind::end) return bad_data("holds too many units", "", file.string());
  const auto json = nlohmann::json::parse(end.payload, nullptr, false);
  if (!json.is_object()) return bad_data("its end cannot be read", "", file.string());
  return ShardEnd{json.value("host", std::string()), json.value("units", std::int64_t{0}),
                  json.value("failed", std::int64_t{0}), json.value("wall_s", 0.0), json.value("cpu_s", 0.0)};
}

Result<std::vector<FinishedTask>> finished_tasks(const JobFolder& folder) {
  const auto chunks = MBK_TRY(folder.chunks());
  const auto files = MBK_TRY(list_shards(folder));
  std::vector<FinishedTask> tasks;
  for (const ShardFile& file : files) {
    if (file.state != ShardFile::State::whole || file.chunk < 0 || file.chunk >= std::ssize(chunks)) continue;
    if (!tasks.empty() && tasks.back().chunk == file.chunk) continue;
    const Chunk& chunk = chunks[static_cast<std::size_t>(file.chunk)];
    const auto end = check_shard(folder, chunk, file.path);
    if (end) tasks.push_back({chunk.number, chunk.expected_s, *end});
  }
  return tasks;
}

Result<MergeReport> merge(const JobFolder& folder, const std::function<Result<void>(MergedUnit)>& take) {
  const auto chunks = MBK_TRY(folder.chunks());
  const auto files = MBK_TRY(list_shards(folder));
  MergeReport report;
  auto file = files.begin();
  for (const Chunk& chunk : chunks) {
    std::vector<std::pair<const fs::path*, ShardReader>> readers;
    for (; file != files.end() && file->chunk <= chunk.number; ++file) {
      if (file->chunk < chunk.number || file->state != ShardFile::State::whole) continue;
      auto reader = MBK_TRY(open_shard_of(folder, file->path, chunk.number));
      readers.emplace_back(&file->path, std::move(reader));
    }
    if (readers.empty()) {
      ++report.missing_chunks;
      continue;
    }
    auto keys = MBK_TRY(folder.keys(chunk));
    for (std::int64_t k = 0; k < chunk.count; ++k) {
      MergedUnit unit{chunk.first + k, std::move(keys[static_cast<std::size_t>(k)]), true};
      for (auto& [path, reader] : readers) {
        auto record = MBK_TRY(unit_of(reader, *path, unit.number));
        const bool failed = record.kind == RecordKind::failure;
        // What one process could not do, another may have done.
        if (path == readers.front().first || (unit.failed && !failed)) {
          unit.failed = failed;
          unit.payload = std::move(record.payload);
        } else if (!failed && record.payload != unit.payload) {
          unit.differing.push_back(*path);
        }
      }
      if (!unit.differing.empty()) {
        unit.differing.insert(unit.differing.begin(), *readers.front().first);
        ++report.conflicts;
      } else {
        ++(unit.failed ? report.failed : report.results);
      }
      MBK_TRY(take(std::move(unit)));
    }
  }
  return report;
}

}  // namespace mbk::batch
