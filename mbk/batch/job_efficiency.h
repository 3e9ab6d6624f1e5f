#pragma once

#include <map>
#include <string>
#include <vector>

#include "mbk/batch/merge.h"

namespace mbk::batch {

/// What a chunk took, from being handed out to its shard.
struct TaskEfficiency {
  FinishedTask task;
  int attempts = 1;       ///< how often it was handed out
  double waited_s = 0.0;  ///< from being handed out the last time until it ran
};

/// Where the time of a job went, by its shards and what the process that looked after it noted. Times are that
/// process's, to about the interval between two looks; a task's wall and processor time are its own.
struct JobEfficiency {
  std::string title, engine;  ///< engine: "" where nobody has looked after it yet
  std::int64_t chunks = 0, units = 0;
  std::int64_t finished_chunks = 0, finished_units = 0, failed_units = 0;
  double elapsed_s = 0.0;                        ///< that processes looked after the job
  double working_s = 0.0;                        ///< of that: with at least one task running
  double waiting_s = 0.0;                        ///< with none: for the engine, for files
  double merge_s = 0.0;                          ///< afterwards, until its results were taken; 0: they were not yet
  double wall_s = 0.0, cpu_s = 0.0;              ///< of finished tasks, added up
  double lost_s = 0.0;                           ///< of tasks that ended without a shard, added up
  int most_at_a_time = 0;                        ///< tasks
  std::map<std::string, std::int64_t> losses;    ///< of those tasks, by the reason
  std::map<std::string, std::int64_t> failures;  ///< of units that gave nothing, by the reason
  std::vector<TaskEfficiency> tasks;             ///< by chunk

  /// Finished units over `elapsed_s`; 0 where that is 0.
  [[nodiscard]] double units_per_s() const;
  /// Share of its time, at as many tasks as there were at most, in which a task worked; 0 where nothing is known.
  [[nodiscard]] double busy() const;
};

/// @fails  data: the job cannot be read.
[[nodiscard]] Result<JobEfficiency> job_efficiency(const JobFolder& folder);

/// Schema "mbk.job_efficiency/1".
[[nodiscard]] std::string to_json(const JobEfficiency& job);

/// A few lines for a terminal of 80 columns; "" where no chunk is finished.
[[nodiscard]] std::string to_text(const JobEfficiency& job);

}  // namespace mbk::batch
