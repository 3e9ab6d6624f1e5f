#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mbk/batch/job.h"
#include "mbk/batch/shard.h"

namespace mbk::batch {

/// A file among the shards.
struct ShardFile {
  enum class State { part, whole };
  std::int64_t chunk = 0;
  State state = State::part;
  std::filesystem::path path;
};

/// The shards that there are, by chunk and name.
[[nodiscard]] Result<std::vector<ShardFile>> list_shards(const JobFolder& folder);

/// A reader that stands behind the header.
/// @fails  data: the shard is damaged, or is another job's, program's or chunk's.
[[nodiscard]] Result<ShardReader> open_shard_of(const JobFolder& folder, const std::filesystem::path& file,
                                                std::int64_t chunk);

/// How long a process took for a chunk.
struct ShardEnd {
  std::string host;
  std::int64_t units = 0, failed = 0;
  double wall_s = 0.0, cpu_s = 0.0;
};

/// Whether a shard that has its name is whole: every unit of its chunk once, in order, and an end.
/// @fails  data: why it is not.
[[nodiscard]] Result<ShardEnd> check_shard(const JobFolder& folder, const Chunk& chunk,
                                           const std::filesystem::path& file);

/// A chunk that is done, and what it took.
struct FinishedTask {
  std::int64_t chunk = 0;
  double expected_s = 0.0;
  ShardEnd end;
};

/// By chunk; shards that are damaged are passed over, and of a chunk that was done twice the first counts.
[[nodiscard]] Result<std::vector<FinishedTask>> finished_tasks(const JobFolder& folder);

/// What is told of each unit, in the order of their numbers.
struct MergedUnit {
  std::int64_t number = 0;
  std::string key;
  bool failed = false;
  std::string payload;                           ///< the result, or why there is none
  std::vector<std::filesystem::path> differing;  ///< shards that give it another result than the first; then it counts
                                                 ///< as none
};

/// What merging found.
struct MergeReport {
  std::int64_t results = 0, failed = 0, conflicts = 0, missing_chunks = 0;
};

/// Reads the shards in the order of the units, whatever order they came in. Shards of one chunk are held against each
/// other. Chunks without a whole shard are passed over.
/// @param take  what it fails with ends the merge
/// @fails  data: as take; a shard cannot be read.
[[nodiscard]] Result<MergeReport> merge(const JobFolder& folder, const std::function<Result<void>(MergedUnit)>& take);

}  // namespace mbk::batch
