#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "apps/mbk/study_commands.h"
#include "apps/mbk/study_options.h"
#include "mbk/study/batch/merge.h"
#include "mbk/study/batch/run.h"

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
  const auto study = open_study(arguments.study);
  if (!study) return tl::unexpected(study.error());
  std::vector<fs::path> jobs;
  std::error_code error;
  for (auto at = fs::directory_iterator(study->folder() / "jobs", error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    if (batch::JobFolder::is_there(at->path())) jobs.push_back(at->path());
  }
  std::ranges::sort(jobs);
  return jobs;
}

/// Wall and processor time of the finished tasks: how much of the time that they had they used.
std::string efficiency_text(const batch::JobFolder& folder) {
  const auto tasks = batch::finished_tasks(folder);
  if (!tasks || tasks->empty()) return "";
  double wall = 0.0, cpu = 0.0, expected = 0.0, slowest = 0.0;
  for (const batch::FinishedTask& task : *tasks) {
    wall += task.end.wall_s;
    cpu += task.end.cpu_s;
    expected += task.expected_s;
    slowest = std::max(slowest, task.end.wall_s);
  }
  return fmt::format(
      "  finished tasks: {}; {:.1f} s each, slowest {:.1f} s; processor busy {:.0f} % of the time; {:.2f} times the "
      "expected cost\n",
      tasks->size(), wall / static_cast<double>(tasks->size()), slowest, wall > 0.0 ? 100.0 * cpu / wall : 0.0,
      expected > 0.0 ? wall / expected : 0.0);
}

nlohmann::ordered_json json_of(const batch::JobFolder& folder, const batch::JobState& state) {
  auto json = nlohmann::ordered_json::parse(batch::to_json(state));
  json["folder"] = folder.folder().string();
  json["title"] = folder.job().title;
  json["tasks"] = nlohmann::ordered_json::array();
  const auto tasks = batch::finished_tasks(folder);
  if (!tasks) return json;
  for (const batch::FinishedTask& task : *tasks) {
    json["tasks"].push_back({{"chunk", task.chunk},
                             {"host", task.end.host},
                             {"units", task.end.units},
                             {"failed", task.end.failed},
                             {"expected_s", task.expected_s},
                             {"wall_s", task.end.wall_s},
                             {"cpu_s", task.end.cpu_s}});
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
    json["jobs"].push_back(json_of(*folder, *state));
    text += fmt::format("{}\n  {}\n  {}\n{}", folder->job().title, folder->folder().string(), batch::to_text(*state),
                        efficiency_text(*folder));
  }
  if (arguments.json) text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (auto ok = Output().write(text); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_study_status(CLI::App& group) {
  auto arguments = std::make_shared<StatusArguments>();
  CLI::App* command = add_command(group, "status", "how far the jobs are that --engine began");
  command->footer(
      "Examples:\n"
      "  mbk study status\n"
      "  mbk study status --json\n"
      "      with the time that each finished task took\n"
      "  mbk study status --job mbk-jobs/validate-recovery-0123456789ab/stage-0\n"
      "      a job of another command");
  add_study_option(*command, arguments->study);
  command->add_option("--job", arguments->job, "the folder of one job, in a study or elsewhere")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->add_flag("--json", arguments->json, "for machines: schema mbk.study_status/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
