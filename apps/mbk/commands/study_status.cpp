#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/options/option_checks.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/study_options.h"
#include "mbk/batch/merge.h"
#include "mbk/batch/run.h"

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

nlohmann::ordered_json json_of(const batch::JobFolder& folder, const batch::JobState& state,
                               const std::vector<batch::FinishedTask>& tasks) {
  auto json = nlohmann::ordered_json::parse(batch::to_json(state));
  json["folder"] = folder.folder().string();
  json["title"] = folder.job().title;
  json["tasks"] = nlohmann::ordered_json::array();
  for (const batch::FinishedTask& one : tasks) {
    json["tasks"].push_back({{"chunk", one.chunk},
                             {"host", one.end.host},
                             {"units", one.end.units},
                             {"failed", one.end.failed},
                             {"expected_s", one.expected_s},
                             {"wall_s", one.end.wall_s},
                             {"cpu_s", one.end.cpu_s}});
  }
  return json;
}

int run(const StatusArguments& arguments) {
  const auto jobs = jobs_of(arguments);
  if (!jobs) return report_error(jobs.error());
  std::string text = jobs->empty() ? "no job is under way\n" : "";
  nlohmann::ordered_json json = {{"schema", "mbk.study_status/1"}, {"jobs", nlohmann::ordered_json::array()}};
  for (const fs::path& one : *jobs) {
    const auto folder = batch::JobFolder::open(one);
    if (!folder) return report_error(folder.error());
    const auto state = batch::state_of(*folder);
    if (!state) return report_error(state.error());
    const auto tasks = batch::finished_tasks(*folder);
    if (!tasks) return report_error(tasks.error());
    json["jobs"].push_back(json_of(*folder, *state, *tasks));
    text += fmt::format("{}\n  {}\n  {}\n", folder->job().title, folder->folder().string(), batch::to_text(*state));
  }
  if (arguments.json) text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_study_status(Command group) {
  auto arguments = std::make_shared<StatusArguments>();
  const Command command = group.add_command("status", "how far the jobs are that --engine began");
  command.footer(
      "Examples:\n"
      "  mbk study status\n"
      "  mbk study status --json\n"
      "      with the time that each finished task took\n"
      "  mbk study status --job mbk-jobs/validate-recovery-0123456789ab/stage-0\n"
      "      a job of another command");
  add_study_option(command, arguments->study);
  command.add_option("--job", arguments->job, "the folder of one job, in a study or elsewhere")
      .type_name("FOLDER")
      .check(not_empty());
  command.add_flag("--json", arguments->json, "for machines: schema mbk.study_status/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
