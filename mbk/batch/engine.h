#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"
#include "mbk/batch/job.h"

namespace mbk::batch {

/// What runs the chunks.
enum class EngineKind { local, slurm };

[[nodiscard]] constexpr auto word_table(EngineKind) {
  using enum EngineKind;
  return std::to_array<Word<EngineKind>>({{local, "local"}, {slurm, "slurm"}});
}

/// What is known of a chunk that was handed out and has not ended.
struct Alive {
  bool running = false;  ///< false: it waits
  std::string why;       ///< it waits: "Resources"; may be empty
};

/// Hands chunks out to processes. Which of them are finished the shards tell, and nothing else.
class Engine {
 public:
  virtual ~Engine() = default;

  /// The most chunks that a job may have.
  [[nodiscard]] virtual Result<std::int64_t> max_chunks() = 0;
  /// @fails  data: they were not taken.
  [[nodiscard]] virtual Result<void> submit(std::span<const std::int64_t> chunks) = 0;
  /// Those that wait or run, from whichever process handed them out.   @fails  data: nobody answers.
  [[nodiscard]] virtual Result<std::map<std::int64_t, Alive>> alive() = 0;
  /// Those that run or wait; an engine that cannot end one alone may end all.
  virtual void cancel(std::span<const std::int64_t> chunks) = 0;
  /// Everything, and waits a while until it is gone.
  virtual void cancel_all() = 0;
  /// Why a chunk ended without a shard: "killed by signal 9"; as far as it is known.
  [[nodiscard]] virtual std::string why_ended(std::int64_t chunk) = 0;
  /// Whether a chunk that ended without a shard was begun at all; otherwise the next attempt is its first.
  [[nodiscard]] virtual bool was_begun(std::int64_t /*chunk*/) const { return true; }
  /// Between two looks at it, at most [s]; less in the first seconds.
  [[nodiscard]] virtual double interval_s() const = 0;
  /// So long after its end a shard may still come into sight on another machine's disk [s].
  [[nodiscard]] virtual double settle_s() const = 0;
  /// Whether the chunks go on where this process ends.
  [[nodiscard]] virtual bool outlives() const { return false; }
};

struct EngineOptions {
  EngineKind kind = EngineKind::local;
  std::filesystem::path program;  ///< mbk
  int tasks = 0;                  ///< chunks at a time; 0: local: as many as there are cores; slurm: no limit
  double heartbeat_s = 20.0;
  double longest_chunk_s = 0.0;    ///< expected; for the time that is asked for
  std::int64_t memory_mb = 0;      ///< that a task needs
  std::string partition, account;  ///< of Slurm; empty: as SBATCH_PARTITION and SBATCH_ACCOUNT or the site say
  std::vector<std::string> extra;  ///< further options of sbatch
  double settle_s = 10.0;          ///< of Slurm
};

/// For a job in its folder.   @fails  usage: the engine is not installed. data: its controller does not answer.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_engine(const JobFolder& folder, const EngineOptions& options);

/// The most chunks that a job may have, before there is one.   @fails  as make_engine
[[nodiscard]] Result<std::int64_t> max_chunks(const EngineOptions& options);

/// The command that does a chunk, without its number.
[[nodiscard]] std::vector<std::string> work_command(const JobFolder& folder, const EngineOptions& options);

}  // namespace mbk::batch
