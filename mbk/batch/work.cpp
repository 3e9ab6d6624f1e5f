#include "mbk/batch/work.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "mbk/base/realtime/rest.h"
#include "mbk/base/system/process.h"
#include "mbk/batch/merge.h"
#include "mbk/batch/shard.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// What processes left that ended before the chunk did.
struct Remains {
  int processes = 0;
  std::map<std::uint64_t, ShardRecord> done;
  std::map<std::uint64_t, int> ended_in;  ///< how many ended while a unit was computed
};

Remains remains_of(const JobFolder& folder, const Chunk& chunk) {
  Remains remains;
  const auto listed = list_shards(folder);
  if (!listed) return remains;
  for (const ShardFile& file : *listed) {
    if (file.chunk != chunk.number || file.state != ShardFile::State::part) continue;
    auto reader = open_shard_of(folder, file.path, chunk.number);
    if (!reader) continue;
    ++remains.processes;
    std::optional<std::uint64_t> begun;
    while (true) {
      auto record = reader->next();
      if (!record || !*record) break;
      const std::uint64_t unit = (*record)->unit;
      if ((*record)->kind == RecordKind::began) begun = unit;
      if ((*record)->kind != RecordKind::result) continue;
      begun.reset();
      remains.done[unit] = std::move(**record);
    }
    if (begun) ++remains.ended_in[*begun];
  }
  return remains;
}

/// Says again and again in the shard that the process lives.
class Heartbeat {
 public:
  Heartbeat(ShardWriter& shard, double interval_s)
      : thread_([this, &shard, interval = std::chrono::nanoseconds(std::llround(1e9 * interval_s))] {
          while (!realtime::rest(interval, [this] { return ended_.load(); })) {
            if (shard.add(RecordKind::heartbeat, 0, "") && shard.sync()) continue;
            failed = true;
            return;
          }
        }) {}
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;
  ~Heartbeat() {
    ended_ = true;
    thread_.join();
  }

  std::atomic<bool> failed = false;

 private:
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// The first chunk from `begin` on, and then from 0, of which there is no shard, whole or not.
Result<std::optional<std::int64_t>> free_chunk(const JobFolder& folder, std::int64_t begin) {
  const std::int64_t count = folder.job().chunks;
  std::vector<bool> taken(static_cast<std::size_t>(count));
  const auto files = MBK_TRY(list_shards(folder));
  for (const ShardFile& file : files) {
    if (file.chunk >= 0 && file.chunk < count) taken[static_cast<std::size_t>(file.chunk)] = true;
  }
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t chunk = (begin + k) % count;
    if (!taken[static_cast<std::size_t>(chunk)]) return chunk;
  }
  return std::nullopt;
}

constexpr int kEndsOfOneUnit = 3;

}  // namespace

std::int64_t units_left_done(const JobFolder& folder, const Chunk& chunk) {
  return std::ssize(remains_of(folder, chunk).done);
}

Result<ChunkDone> work(const JobFolder& folder, std::int64_t number, const UnitFunction& compute,
                       const WorkOptions& options) {
  MBK_TRY(folder.check_program());
  const auto chunk = MBK_TRY(folder.chunk(number));
  const auto keys = MBK_TRY(folder.keys(chunk));
  const Remains remains = remains_of(folder, chunk);

  std::random_device lot;
  ShardHeader header{folder.job().id, folder.job().program, number, system::host_name(), system::process_id()};
  header.token = fmt::format("{:08x}{:08x}", lot(), lot());
  auto shard = MBK_TRY(ShardWriter::create(folder.shards(), header));
  const auto begin = Clock::now();
  ChunkDone done;
  {
    const Heartbeat heartbeat(*shard, options.heartbeat_s);
    for (std::size_t k = 0; k < keys.size(); ++k) {
      const auto unit = static_cast<std::uint64_t>(chunk.first) + k;
      Result<void> written;
      if (const auto found = remains.done.find(unit); found != remains.done.end()) {
        written = shard->add(RecordKind::result, unit, found->second.payload);
        ++done.found;
      } else if (const auto ended = remains.ended_in.find(unit);
                 ended != remains.ended_in.end() && ended->second >= kEndsOfOneUnit) {
        written = shard->add(RecordKind::failure, unit, "mbk ended each time it computed this unit");
        ++done.failed;
      } else {
        if (remains.processes > 0) {
          written = shard->add(RecordKind::began, unit, "");
          if (written) written = shard->flush();
          if (!written) return tl::unexpected(written.error());
        }
        const auto result = compute(static_cast<std::int64_t>(unit), keys[k]);
        if (!result) ++done.failed;
        written = result ? shard->add(RecordKind::result, unit, *result)
                         : shard->add(RecordKind::failure, unit, result.error().line());
      }
      if (!written) return tl::unexpected(written.error());
      ++done.units;
    }
  }
  const nlohmann::json end = {{"host", header.host},
                              {"units", done.units},
                              {"failed", done.failed},
                              {"wall_s", std::chrono::duration<double>(Clock::now() - begin).count()},
                              {"cpu_s", system::cpu_seconds()}};
  MBK_TRY(shard->finish(end.dump()));
  return done;
}

Result<void> work_on_free_chunks(const JobFolder& folder, const UnitFunction& compute, const WorkOptions& options,
                                 const std::function<Result<void>(std::int64_t, const ChunkDone&)>& done) {
  std::int64_t begin = std::random_device()() % std::max<std::int64_t>(folder.job().chunks, 1);
  while (const auto chunk = MBK_TRY(free_chunk(folder, begin))) {
    const auto did = MBK_TRY(work(folder, *chunk, compute, options));
    MBK_TRY(done(*chunk, did));
    begin = *chunk;
  }
  return {};
}

}  // namespace mbk::batch
