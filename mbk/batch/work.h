#pragma once

#include <functional>
#include <string>

#include "mbk/batch/job.h"

namespace mbk::batch {

/// What a unit gives, by its key alone.   @fails  with why it gives nothing; the other units go on.
using UnitFunction = std::function<Result<std::string>(std::int64_t number, const std::string& key)>;

struct WorkOptions {
  double heartbeat_s = 20.0;  ///< between two signs of life in the shard
};

/// What a process did of a chunk.
struct ChunkDone {
  std::int64_t units = 0, failed = 0;
  std::int64_t found = 0;  ///< of them, those that an ended process had left
};

/// Does a chunk, one unit after the other, and leaves its shard. What a process that ended in the middle of this chunk
/// had left is taken over. A unit in which three processes ended after it was begun counts as failed.
/// @fails  usage: there is no such chunk. data: another program's job; the shard cannot be written.
[[nodiscard]] Result<ChunkDone> work(const JobFolder& folder, std::int64_t chunk, const UnitFunction& compute,
                                     const WorkOptions& options = {});

/// Does chunks that no process has begun, one after the other, until there are none; from one drawn at random, so that
/// several workers seldom begin the same. If two do, their results are the same.
/// @param done  called after each chunk
/// @fails  as work; as done: the first failure.
[[nodiscard]] Result<void> work_on_free_chunks(
    const JobFolder& folder, const UnitFunction& compute, const WorkOptions& options,
    const std::function<Result<void>(std::int64_t chunk, const ChunkDone& done)>& done);

/// How many units of a chunk processes have done that ended before the chunk did.
[[nodiscard]] std::int64_t units_left_done(const JobFolder& folder, const Chunk& chunk);

}  // namespace mbk::batch
