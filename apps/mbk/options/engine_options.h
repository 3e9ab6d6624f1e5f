#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/batch/engine.h"
#include "mbk/batch/run.h"
#include "mbk/batch/work.h"

/// Work on many processes and machines: the options, and what every command does with them.
namespace mbk::app {

struct EngineArguments {
  std::optional<batch::EngineKind> kind;  ///< absent: within this process
  std::optional<std::filesystem::path> folder;
  int tasks = 0;
  std::optional<double> chunk_s;
  std::optional<std::int64_t> chunk_units;
  std::optional<std::int64_t> memory_mb;
  double silence_s = 300.0, settle_s = 10.0;
  std::string partition, account;
  std::vector<std::string> extra;
  bool detach = false, keep = false, progress_json = false;
};

/// Adds --engine and what belongs to it.
void add_engine_options(Command command, EngineArguments& arguments);

/// What a command wants to have done.
struct Request {
  std::string kind, specification;  ///< as in batch::Job
  std::string title;
  std::vector<std::string> keys;
  std::vector<double> weights;   ///< of the units: their costs, but for a common factor
  batch::UnitFunction compute;   ///< a few units are done here first, to see what they cost
  std::filesystem::path folder;  ///< of the job, where --job-folder says none
};

/// How a job ended: with all its shards, unless `code` says what the command is to end with.
struct Carried {
  std::optional<batch::JobFolder> folder;
  std::optional<int> code;
};

/// Begins the job, or goes on with the one that is there, and waits for it unless it is to be detached.
/// @fails  usage: there is another job in the folder. data: as batch::run.
[[nodiscard]] Result<Carried> carry_out(const EngineArguments& arguments, const Request& request, bool quiet);

/// Gets what does the units of a job, and may use it as long as it runs.
using UseUnits = std::function<Result<void>(const batch::UnitFunction& compute)>;

/// Calls `use` with what does the units of a job, by its kind.
/// @fails  data: a kind that this mbk does not know; a specification that cannot be read; what it names has changed. As
/// `use`.
[[nodiscard]] Result<void> with_units(const batch::JobFolder& folder, const UseUnits& use);

/// What each unit of a finished job gave.   @fails  data: a unit gave nothing, or different results.
[[nodiscard]] Result<std::vector<std::string>> results_of(const batch::JobFolder& folder);

/// Once the results of a job are taken: removes it, and the folder above it where nothing is left in that, unless it is
/// to be kept.
[[nodiscard]] Result<void> remove_job(const batch::JobFolder& folder, const EngineArguments& arguments);

/// Below the current folder: "mbk-jobs/KIND-…", the same for the same work.
[[nodiscard]] std::filesystem::path job_folder_here(const std::string& kind, const std::string& specification);

/// The path of this program.
[[nodiscard]] Result<std::filesystem::path> this_program();

}  // namespace mbk::app
