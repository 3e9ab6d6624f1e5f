#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/study_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/batch/job_status.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct StatusArguments {
  StudyArguments study;
  std::optional<fs::path> job;
  bool json = false;
};

Result<std::vector<fs::path>> jobs_of(const StatusArguments& arguments) {
  if (arguments.job) return std::vector{*arguments.job};
  const auto study = MBK_TRY(open_study(arguments.study));
  std::vector<fs::path> folders;
  std::error_code error;
  for (auto at = fs::directory_iterator(study.folder() / "jobs", error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    if (batch::JobFolder::is_there(at->path())) folders.push_back(at->path());
  }
  std::ranges::sort(folders);
  return folders;
}

int run(const StatusArguments& arguments) {
  const auto jobs = jobs_of(arguments);
  if (!jobs) return report_error(jobs.error());
  std::string text = jobs->empty() ? "no job is running\n" : "";
  std::vector<batch::JobStatus> all;
  for (const fs::path& one : *jobs) {
    const auto folder = batch::JobFolder::open(one);
    if (!folder) return report_error(folder.error());
    const auto status = batch::status_of(*folder);
    if (!status) return report_error(status.error());
    all.push_back(*status);
    text += fmt::format("{}\n  {}\n  {}\n", status->title, status->folder, batch::to_text(status->state));
  }
  if (arguments.json) text = batch::to_json(all);
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_study_status(Command group) {
  auto arguments = std::make_shared<StatusArguments>();
  const Command command = group.add_command("status", "show the progress of jobs started with --engine");
  command.footer(
      "Examples:\n"
      "  mbk study status\n"
      "  mbk study status --json\n"
      "      includes the duration of each finished task\n"
      "  mbk study status --job mbk-jobs/validate-recovery-0123456789ab/stage-0\n"
      "      a job of another command");
  add_study_option(command, arguments->study);
  command
      .add_option("--job", arguments->job,
                  "folder of one job, in a study or elsewhere (default: all jobs of the study)")
      .type_name("FOLDER")
      .check(not_empty());
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.study_status/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
