#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::batch {

/// What is to be done. What a unit gives depends on the kind, the specification, the program and its key alone.
struct Job {
  std::string id;             ///< SHA-256 over all that it depends on, and the keys
  std::string kind;           ///< which work: "measure"
  std::string specification;  ///< JSON, in the kind's own terms
  std::string program;        ///< that made it, and that alone does it: version and build
  std::string simd;           ///< of the process that made it (core/vector4.h): with others, last digits may differ
  std::string title;          ///< for people: "mbk study measure, 300 recordings"
  std::int64_t units = 0, chunks = 0;
  std::int64_t memory_mb = 0;  ///< that a process needs for it
};

/// A part of the units that one process does.
struct Chunk {
  std::int64_t number = 0;
  std::int64_t first = 0, count = 0;  ///< units
  double expected_s = 0.0;            ///< of one core
};

/// This program, and which build of it: "1.0.0 4f1c…".
[[nodiscard]] std::string program_identity();

/// What it takes until it is worth while to begin a task.
struct ChunkLengths {
  double shortest_s = 2.0;  ///< below it a task's beginning shows in the whole
  double min_s = 0.2;       ///< below it no other task is begun, even if there is one with nothing to do
};

/// How much work a chunk holds [s]: a sixteenth of what each task does, so that uneven costs even out, but neither less
/// than `shortest_s` nor more than five minutes; where that makes few chunks, as many for each task as for the others.
/// @param total_s  of all units    @param tasks  that work at a time; 0: as many as a cluster may have
[[nodiscard]] double chunk_length(double total_s, int tasks, const ChunkLengths& lengths);

/// The ends of chunks, each of about so much cost, at most `max_chunks`.
/// @param costs  of each unit [s], > 0    @param target_s  of a chunk
/// @returns  for each chunk the number of the unit after its last; the last is the number of units
[[nodiscard]] std::vector<std::int64_t> cut_into_chunks(std::span<const double> costs, double target_s,
                                                        std::int64_t max_chunks);

/// A job's folder, which every machine sees: job.json, the units' keys, the chunks, the shards, logs of tasks.
class JobFolder {
 public:
  /// Makes the folder; the job is there once this ends, or not at all.
  /// @param keys  of the units, without line breaks, in the order in which results are merged
  /// @param ends  as cut_into_chunks gives them    @param costs  as there
  /// @fails  data: it cannot be written. usage: there is a job.
  [[nodiscard]] static Result<JobFolder> create(const std::filesystem::path& folder, Job job,
                                                std::span<const std::string> keys, std::span<const std::int64_t> ends,
                                                std::span<const double> costs);

  /// @fails  usage: there is no job. data: it cannot be read.
  [[nodiscard]] static Result<JobFolder> open(const std::filesystem::path& folder);
  [[nodiscard]] static bool is_there(const std::filesystem::path& folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const Job& job() const { return job_; }

  /// @fails  data: the job is another program's, by its version or its build.
  [[nodiscard]] Result<void> check_program() const;

  /// @param number  0 … chunks − 1
  [[nodiscard]] Result<Chunk> chunk(std::int64_t number) const;
  [[nodiscard]] Result<std::vector<Chunk>> chunks() const;
  [[nodiscard]] Result<std::vector<std::string>> keys(const Chunk& chunk) const;

  [[nodiscard]] std::filesystem::path shards() const { return folder_ / "shards"; }
  [[nodiscard]] std::filesystem::path logs() const { return folder_ / "logs"; }

  /// Removes everything of it.
  [[nodiscard]] Result<void> remove() const;

 private:
  std::filesystem::path folder_;
  Job job_;
};

}  // namespace mbk::batch
