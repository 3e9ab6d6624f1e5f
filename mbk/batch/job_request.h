#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/option_table.h"
#include "mbk/batch/engine.h"
#include "mbk/batch/run.h"
#include "mbk/batch/work.h"

namespace mbk::batch {

/// How a job is carried out.
struct JobOptions {
  std::optional<EngineKind> kind;               ///< absent: within this process
  std::optional<std::filesystem::path> folder;  ///< of the job; absent: as the request says
  int tasks = 0;
  std::optional<double> chunk_s;
  std::optional<std::int64_t> chunk_units;
  std::optional<std::int64_t> memory_mb;
  double silence_s = 300.0, settle_s = 10.0;
  std::string partition, account;
  std::vector<std::string> extra;
  bool detach = false, keep = false;
};

/// --engine and what belongs to it.
[[nodiscard]] const OptionTable<JobOptions>& job_table();

/// What is to be done.
struct JobRequest {
  std::string kind, specification;  ///< as in Job
  std::string title;
  std::vector<std::string> keys;
  std::vector<double> weights;   ///< of the units: their costs, but for a common factor
  UnitFunction compute;          ///< a few units are done here first, to see what they cost
  std::filesystem::path folder;  ///< of the job, where the options say none
};

/// How a job ended.
struct CarriedOut {
  JobFolder folder;
  RunReport report;

  /// Every unit is in a shard.
  [[nodiscard]] bool finished() const { return report.end == RunEnd::finished; }
};

/// Begins the job, or goes on with the one that is there, and waits for it unless it is to be detached.
/// @param program  mbk    @param stop, progress  as in RunOptions
/// @fails  usage: there is another job in the folder; --detach without Slurm. data: as run.
[[nodiscard]] Result<CarriedOut> carry_out(const JobOptions& options, const JobRequest& request,
                                           const std::filesystem::path& program, std::function<Stop()> stop,
                                           std::function<void(const JobState&)> progress);

/// What each unit of a finished job gave.   @fails  data: a unit gave nothing, or different results.
[[nodiscard]] Result<std::vector<std::string>> results_of(const JobFolder& folder);

/// Once the results of a job are taken: removes it, and the folder above it where nothing is left in that, unless it is
/// to be kept.
[[nodiscard]] Result<void> remove_job(const JobFolder& folder, const JobOptions& options);

/// "KIND-0123456789ab", the same for the same work.
[[nodiscard]] std::string job_name(const std::string& kind, const std::string& specification);

}  // namespace mbk::batch
