#include <fmt/format.h>

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/study_options.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/version.h"
#include "mbk/study/workflow/measure_study.h"

namespace mbk::app {
namespace {

struct StudyMeasureArguments {
  StudyArguments study;
  request::MeasureRequest measuring;
  unsigned threads = 0;
  EngineArguments engine;
  bool again_failed = false, quiet = false;
};

using workflow::Tally;

/// Results that are not usable: by recording, the first of their warnings.
using NotUsable = std::map<store::Unit, std::string>;

/// Units under the words of their recordings; none if the study cannot be read.
std::map<store::Unit, std::string> names_of(const store::Store& study) {
  std::map<store::Unit, std::string> names;
  if (const auto recordings = study.recordings()) {
    for (const store::StoredRecording& r : *recordings) names[{r.sha256, r.part, ""}] = recording_words(r);
  }
  return names;
}

workflow::MeasureListener listener_of(const store::Store& study, const StudyMeasureArguments& arguments,
                                      Progress& progress, NotUsable& not_usable) {
  return {
      arguments.study.role, [&](int done, int of) { progress.count(done, of); },
      [&study, names = std::map<store::Unit, std::string>()](const store::Unit& unit, const std::string& why) mutable {
        if (names.empty()) names = names_of(study);
        const auto found = names.find(unit);
        say("mbk: {}: {}\n", found == names.end() ? unit.file : found->second, why);
      },
      [&](const store::Unit& unit, const std::string& codes) { not_usable[unit] = codes.substr(0, codes.find(',')); },
      [](const Error& error) { std::ignore = report_error(error); }};
}

/// A line for each recording that is not usable.
Result<std::string> lines_of(const store::Store& study, const NotUsable& not_usable) {
  std::string text;
  if (not_usable.empty()) return text;
  const auto recordings = MBK_TRY(study.recordings());
  for (const store::StoredRecording& r : recordings) {
    const auto found = not_usable.find({r.sha256, r.part, ""});
    if (found == not_usable.end()) continue;
    text += fmt::format("  {}: not usable: {}\n", recording_words(r), found->second);
  }
  return text;
}

int said_of(const store::Store& study, const Tally& tally, const NotUsable& not_usable, std::optional<int> code = {}) {
  const int count = tally.count();
  const std::string text = count == 0 ? "nothing new to measure\n"
                                      : fmt::format("{} measured: {} usable, {} not usable, {} could not be measured\n",
                                                    count, tally.usable, tally.not_usable, tally.failed + tally.unread);
  const auto lines = lines_of(study, not_usable);
  if (!lines) return report_error(lines.error());
  if (auto ok = print_text(text + *lines); !ok) return report_error(ok.error());
  if (code) return *code;
  if (tally.unread + tally.failed > 0) return kBadData;
  return tally.not_usable > 0 && tally.usable == 0 ? kNotUsable : kFine;
}

/// Measures as a job of many processes. An unfinished earlier job is finished first, with its own recordings.
int measure_as_job(store::Store& study, const std::string& key, const OptionTexts& options,
                   const std::shared_ptr<const workflow::Measuring>& measuring,
                   const StudyMeasureArguments& arguments) {
  Progress progress(arguments.quiet);
  NotUsable not_usable;
  const auto listener = listener_of(study, arguments, progress, not_usable);
  Tally tally;
  while (true) {
    const auto units = study.pending(key, std::string(version()), arguments.again_failed && tally.count() == 0);
    if (!units) return report_error(units.error());
    const auto request = workflow::measure_request(study, options, measuring, *units);
    if (!request) return report_error(request.error());
    const std::filesystem::path job_folder = arguments.engine.folder.value_or(request->folder);
    if (units->empty() && !batch::JobFolder::is_there(job_folder)) return said_of(study, tally, not_usable);
    const auto carried = carry_out(arguments.engine, *request, arguments.quiet);
    if (!carried) return report_error(carried.error());
    if (!carried->folder) return *carried->code;
    const auto collected = workflow::collect_job(study, key, *carried->folder, listener);
    if (!collected) return report_error(collected.error());
    tally += *collected;
    if (carried->code) return said_of(study, tally, not_usable, carried->code);
    if (auto ok = batch::remove_job(*carried->folder, arguments.engine); !ok) return report_error(ok.error());
    // Recordings that could not be read are not retried immediately.
    if (arguments.engine.keep || tally.unread > 0) return said_of(study, tally, not_usable);
  }
}

int run(Command command, const StudyMeasureArguments& arguments) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  auto options = workflow::default_options(*study);
  if (!options) return report_error(options.error());
  for (const auto& [name, values] : given_options(command, workflow::measuring_table())) (*options)[name] = values;
  const auto measuring = workflow::measuring_of(*options);
  if (!measuring) return report_error(measuring.error());
  const auto key = workflow::key_in(*study, **measuring);
  if (!key) return report_error(key.error());
  if (arguments.engine.kind) return measure_as_job(*study, *key, *options, *measuring, arguments);
  const auto units = study->pending(*key, std::string(version()), arguments.again_failed);
  if (!units) return report_error(units.error());
  Progress progress(arguments.quiet);
  NotUsable not_usable;
  const auto tally = workflow::measure_units_here(*study, *key, **measuring, *units, arguments.threads,
                                                  listener_of(*study, arguments, progress, not_usable));
  return tally ? said_of(*study, *tally, not_usable) : report_error(tally.error());
}

}  // namespace

Action add_study_measure(Command group) {
  auto arguments = std::make_shared<StudyMeasureArguments>();
  const Command command =
      group.add_command("measure", "measure recordings that are new or whose options or version changed");
  command.footer(
      "Examples:\n"
      "  mbk study measure\n"
      "      uses the default options of the study (mbk study defaults)\n"
      "  mbk study measure --mode reference\n"
      "      adds another analysis; 'mbk study list' shows both\n"
      "  mbk study measure --again-failed\n"
      "  mbk study measure --engine slurm --tasks 40\n"
      "      as a job array on the cluster, 40 tasks at a time; the results are identical\n\n"
      "The options are those of 'mbk measure'; a given option overrides the default of the study. Each\n"
      "result is stored with the hash of the recording, the options and the version of mbk. An\n"
      "interrupted run continues where it stopped. The results do not depend on the number of threads.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 a recording could not be measured, 4 no new result is usable.");
  add_study_and_role(command, arguments->study);
  command.add_flag("--again-failed", arguments->again_failed, "retry recordings that could not be measured");
  command.add_flag("--quiet", arguments->quiet, "print no progress on standard error");
  add_measuring_options(command, arguments->measuring);
  add_threads_option(command, arguments->threads, "number of recordings measured in parallel").group("Model");
  add_engine_options(command, arguments->engine);
  return [command, arguments] { return run(command, *arguments); };
}

}  // namespace mbk::app
