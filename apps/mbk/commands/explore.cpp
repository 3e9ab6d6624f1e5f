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

/// @param code  exit code of the command if the job did not finish
Explored explored_elsewhere(const workflow::ExploringEach& each, const ExploreArguments& arguments,
                            std::optional<int>& code) {
  auto job = MBK_TRY(workflow::explore_request(each));
  job.folder = job_folder_here(job.kind, job.specification);
  const auto carried = MBK_TRY(carry_out(arguments.engine, job, arguments.to.quiet));
  code = carried.code;
  if (code) return bad_data("some recordings were not processed");
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
    return report_error({ErrorKind::usage, "--parts joins recordings, but --each processes them separately",
                         "omit one of the two", ""});
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

/// Checks that need no computation.
Result<void> check(const ExploreArguments& a) {
  if (auto ok = check_files(a.reading.files, a.to.to, a.report); !ok || !a.beside.charts) return ok;
  return ChartFiles::check(*a.beside.charts, a.beside.chart_format, a.to.to.overwrite, {a.reading.files.front()},
                           {"response-magnitude", "impulse-response"});
}

Result<void> write_charts(const ExploreArguments& arguments, const Exploration& found) {
  if (!arguments.beside.charts) return {};
  auto files = MBK_TRY(ChartFiles::in(*arguments.beside.charts, arguments.beside.chart_format,
                                      arguments.to.to.overwrite, arguments.reading.files));
  MBK_TRY(files.write(found.recordings.front().source, report::exploration_charts(found)));
  files.say_written(arguments.to.quiet);
  return {};
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
    if (auto ok = write_page(arguments.report, arguments.to, report, {report::exploration_text(*found), {}},
                             arguments.reading.files);
        !ok) {
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
  const Command command = app.add_command("explore", "describe the response of the limb without assuming M, B and K");
  command.footer(
      "Examples:\n"
      "  mbk explore log.mat\n"
      "      dynamic stiffness −F/X and coherence at each frequency\n"
      "  mbk explore first.mat second.mat third.mat --json\n"
      "      averages repetitions of one condition\n"
      "  mbk explore log.mat --report log.html\n"
      "      the same as plots: Bode plots with confidence bands, coherence, Nyquist plots, impulse responses\n"
      "  mbk explore --each trials/*.h5 --json --engine local\n"
      "      one result for each file, computed by one process for each core; or with --engine slurm\n"
      "  mbk explore ankle.csv --channels x=2,F=3 --method welch --max-frequency 30\n"
      "  mbk explore arm.mat --input torque --output acceleration --rate 500\n\n"
      "All FILEs are of one limb in one condition. Trials with different phases of a periodic\n"
      "perturbation are realisations: they separate nonlinear distortion from noise, and the two axes\n"
      "from each other.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_files_option(command, arguments->reading);
  add_main_options(command, request::explore_table(), *arguments,
                   {"--channels", "--input", "--output", "--reference", "--only", "--method", "--from", "--to"});
  add_options(command, request::explore_table(), *arguments);
  const Option each =
      command.add_flag("--each", arguments->each, "one result for each recording instead of one for all together");
  add_threads_option(command, arguments->threads, "number of recordings processed in parallel").needs(each);
  add_report_options(command, arguments->report);
  add_output_options(command, arguments->to, "mbk.explore/1, with --each mbk.explorations/1");
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
