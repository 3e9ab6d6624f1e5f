#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "apps/mbk/terminal/command.h"
#include "mbk/batch/job_request.h"

/// Work on many processes and machines: the options, and their use by every command.
namespace mbk::app {

struct EngineArguments : batch::JobOptions {
  bool progress_json = false;
};

/// Adds --engine and the options that belong to it.
void add_engine_options(Command command, EngineArguments& arguments);

/// How a job ended: with all its shards, or with the exit code of the command in `code`.
struct Carried {
  std::optional<batch::JobFolder> folder;
  std::optional<int> code;
};

/// As batch::carry_out, with progress on standard error, until a signal comes.
[[nodiscard]] Result<Carried> carry_out(const EngineArguments& arguments, const batch::JobRequest& request, bool quiet);

/// Receives the function that computes the units of a job; valid only during the call.
using UseUnits = std::function<Result<void>(const batch::UnitFunction& compute)>;

/// Calls `use` with the function that computes the units of a job of its kind.
/// @fails  data: an unknown kind; a specification that cannot be read; its inputs have changed. As `use`.
[[nodiscard]] Result<void> with_units(const batch::JobFolder& folder, const UseUnits& use);

/// Below the current folder: "mbk-jobs/KIND-…", the same for the same work.
[[nodiscard]] std::filesystem::path job_folder_here(const std::string& kind, const std::string& specification);

/// The path of this program.
[[nodiscard]] Result<std::filesystem::path> this_program();

}  // namespace mbk::app
