#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_jobs.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/study_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/batch/job_efficiency.h"
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
  return job_folders(study.folder());
}

nlohmann::ordered_json json_of(const batch::JobFolder& folder, const batch::JobState& state,
                               const batch::JobEfficiency& efficiency) {
  auto json = nlohmann::ordered_json::parse(batch::to_json(state));
  json["folder"] = folder.folder().string();
  json["title"] = folder.job().title;
  json["tasks"] = nlohmann::ordered_json::array();
  for (const batch::TaskEfficiency& one : efficiency.tasks) {
    json["tasks"].push_back({{"chunk", one.task.chunk},
                             {"host", one.task.end.host},
                             {"units", one.task.end.units},
                             {"failed", one.task.end.failed},
                             {"expected_s", one.task.expected_s},
                             {"wall_s", one.task.end.wall_s},
                             {"cpu_s", one.task.end.cpu_s}});
  }
  json["efficiency"] = nlohmann::ordered_json::parse(batch::to_json(efficiency));
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
    const auto efficiency = batch::job_efficiency(*folder);
    if (!efficiency) return report_error(efficiency.error());
    json["jobs"].push_back(json_of(*folder, *state, *efficiency));
    text += fmt::format("{}\n  {}\n  {}\n{}", folder->job().title, folder->folder().string(), batch::to_text(*state),
                        batch::to_text(*efficiency));
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
      "      with the time that each finished task waited and worked, and why tasks were lost\n"
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
