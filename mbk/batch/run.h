#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mbk/batch/engine.h"
#include "mbk/batch/job.h"

namespace mbk::batch {

/// How far a job is.
struct JobState {
  std::int64_t chunks = 0, finished = 0, running = 0, waiting = 0, given_up = 0;
  std::int64_t units = 0, finished_units = 0, failed_units = 0;
  double elapsed_s = 0.0;                      ///< since this process began to look after it
  double units_per_s = 0.0;                    ///< since then; 0: nothing is known
  double left_s = 0.0;                         ///< estimated; 0: nothing is known
  std::map<std::string, std::int64_t> losses;  ///< processes that ended without a shard, by the reason
  std::string trouble;                         ///< the engine does not answer, or why tasks wait; may be empty
};

[[nodiscard]] std::string to_json(const JobState& state);
/// "12 of 40 chunks, 3 of 10 running; …"
[[nodiscard]] std::string to_text(const JobState& state);

/// Whether a run is to end early, and what becomes of its processes.
enum class Stop { no, cancel, leave };

struct RunOptions {
  int attempts = 6;          ///< of a chunk whose processes end without having done any unit of it
  double silence_s = 300.0;  ///< a running process whose shard does not grow for so long is taken for dead
  bool detach = false;       ///< hands out what is missing, and does not wait
  std::function<Stop()> stop = [] { return Stop::no; };
  std::function<void(const JobState&)> progress = [](const JobState&) {};
};

enum class RunEnd { finished, detached, stopped, incomplete };

struct RunReport {
  RunEnd end = RunEnd::incomplete;
  JobState state;
};

/// Hands out the chunks that are missing, until every one has a whole shard, and again those whose process ended. What
/// an earlier process finished or still runs counts. A shard that is damaged is set aside.
/// @fails  data: another process looks after this job; another program's job; the engine takes nothing.
[[nodiscard]] Result<RunReport> run(const JobFolder& folder, Engine& engine, const RunOptions& options);

/// How far it is, by the shards alone.
[[nodiscard]] Result<JobState> state_of(const JobFolder& folder);

}  // namespace mbk::batch
