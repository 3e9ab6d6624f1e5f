#include "mbk/measure/measurement/explore.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/chart_files.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/files/recording/named_files.h"
#include "mbk/present/report/exploration_text.h"
#include "mbk/present/report/result_charts.h"
#include "mbk/present/result/exploration_json.h"
#include "mbk/study/workflow/explore_units.h"

namespace mbk::app {
namespace {

struct ExploreArguments : request::ExploreRequest {
  OutputArguments to;
  ReportArguments report;
  FilesBeside beside;
  bool each = false;
  unsigned threads = 0;
  EngineArguments engine;
};

using Explored = Result<std::vector<workflow::ExploredRecord>>;

Explored explored_here(const workflow::ExploringEach& each, const ExploreArguments& arguments) {
  Progress progress(arguments.to.quiet);
  return workflow::explored_here(each, arguments.threads,
                                 [&](int done, int of, const std::string& file) { progress.count(done, of, file); });
}

/// @param code  what the command ends with where the job did not come to its end
Explored explored_elsewhere(const workflow::ExploringEach& each, const ExploreArguments& arguments,
                            std::optional<int>& code) {
  auto job = MBK_TRY(workflow::explore_request(each));
  job.folder = job_folder_here(job.kind, job.specification);
  const auto carried = MBK_TRY(carry_out(arguments.engine, job, arguments.to.quiet));
  code = carried.code;
  if (code) return bad_data("some recordings are missing");
  auto all = MBK_TRY(workflow::explored_of(*carried.folder));
  MBK_TRY(batch::remove_job(*carried.folder, arguments.engine));
  return all;
}

/// A result for each recording.
int run_each(Command command, const ExploreArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.to.to, arguments.report); !ok) {
    return report_error(ok.error());
  }
  if (arguments.reading.parts) {
    return report_error({ErrorKind::usage, "--parts joins recordings, and --each keeps them apart", "pass one", ""});
  }
  const workflow::ExploringEach each{arguments, given_options(command, request::explore_table()), arguments.to.json};
  std::optional<int> code;
  const auto explored =
      arguments.engine.kind ? explored_elsewhere(each, arguments, code) : explored_here(each, arguments);
  if (code) return *code;
  if (!explored) return report_error(explored.error());
  int worst = kFine;
  bool all_usable = true;
  std::vector<std::string> texts;
  std::vector<Error> failed;
  for (const workflow::ExploredRecord& one : *explored) {
    if (one.failed) {
      failed.push_back(one.error);
      worst = std::max(worst, report_error(one.error));
    } else {
      texts.push_back(one.text);
      all_usable = all_usable && one.usable;
    }
  }
  if (texts.empty()) return worst;
  const std::string text =
      arguments.to.json ? result::to_json(texts, failed) : fmt::format("{}", fmt::join(texts, "\n"));
  if (auto ok = arguments.to.to.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return worst != kFine ? worst : all_usable ? kFine : kNotUsable;
}

/// What can be said before the work begins.
Result<void> check(const ExploreArguments& a) {
  if (auto ok = check_files(a.reading.files, a.to.to, a.report); !ok || !a.beside.charts) return ok;
  return ChartFiles::check(*a.beside.charts, a.to.to.overwrite, {a.reading.files.front()},
                           {"response-magnitude", "impulse-response"});
}

Result<void> write_charts(const ExploreArguments& arguments, const Exploration& found) {
  if (!arguments.beside.charts) return {};
  auto files = MBK_TRY(ChartFiles::in(*arguments.beside.charts, arguments.to.to.overwrite, arguments.reading.files));
  return files.write(found.recordings.front().source, report::exploration_charts(found));
}

int run_explore(ExploreArguments arguments, const std::string& typed) {
  if (auto ok = check(arguments); !ok) return report_error(ok.error());
  const auto options = request::explore_options(arguments);
  if (!options) return report_error(options.error());
  const auto recordings = read_perturbations(arguments.reading, arguments.sensor);
  if (!recordings) return report_error(recordings.error());
  for (const Recording& recording : *recordings) say_exclusions(recording, false);
  const auto found = measurement::explore(*recordings, *options);
  if (!found) return report_error(found.error());
  if (arguments.report.file) {
    const std::string report = result::report_json(*found, typed, arguments.report.note);
    if (auto ok = write_page(arguments.report, arguments.to.to.overwrite, report, arguments.reading.files); !ok) {
      return report_error(ok.error());
    }
  }
  if (auto ok = write_charts(arguments, *found); !ok) return report_error(ok.error());
  const std::string text = arguments.to.json ? result::to_json(*found) : report::exploration_text(*found);
  if (auto ok = arguments.to.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return found->usable ? kFine : kNotUsable;
}

}  // namespace

Action add_explore(Command app, const std::string& typed) {
  auto arguments = std::make_shared<ExploreArguments>();
  const Command command = app.add_command("explore", "what the limb does before anyone assumes M, B and K");
  command.footer(
      "Examples:\n"
      "  mbk explore log.mat\n"
      "      how the force answers motion at each frequency: dynamic stiffness −F/X and coherence\n"
      "  mbk explore first.mat second.mat third.mat --json\n"
      "      repetitions of one condition, averaged\n"
      "  mbk explore log.mat --report log.html\n"
      "      the same to be looked at: Bode plots with bands, coherence, Nyquist plots, impulse responses\n"
      "  mbk explore --each trials/*.h5 --json --engine local\n"
      "      a result for each file, by as many processes as there are cores; or by slurm\n"
      "  mbk explore ankle.csv --channels x=2,F=3 --method welch --max-frequency 30\n"
      "  mbk explore arm.mat --input torque --output acceleration --rate 500\n\n"
      "FILEs are of one limb in one condition. Trials with other phases of a periodic perturbation are\n"
      "realisations: they tell nonlinear distortion from noise, and two axes from each other.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_files_option(command, arguments->reading);
  add_options(command, request::explore_table(), *arguments);
  const Option each =
      command.add_flag("--each", arguments->each, "a result for each recording, in place of one of all together");
  add_threads_option(command, arguments->threads, "with --each: recordings").needs(each);
  add_output_options(command, arguments->to, "mbk.explore/1, with --each mbk.explorations/1");
  add_report_options(command, arguments->report);
  add_charts_option(command, arguments->beside);
  add_engine_options(command, arguments->engine);
  command.get_option("--report").excludes(each);
  command.get_option("--charts").excludes(each);
  command.get_option("--engine").needs(each);
  return [command, arguments, typed] {
    ExploreArguments named = *arguments;
    auto files = recording::named_files(named.reading.files);
    if (!files) return report_error(files.error());
    named.reading.files = std::move(*files);
    return named.each ? run_each(command, named) : run_explore(std::move(named), typed);
  };
}

}  // namespace mbk::app
