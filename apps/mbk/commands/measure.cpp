#include <algorithm>
#include <memory>
#include <tuple>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/chart_files.h"
#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/files/recording/named_files.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/measure/analyse/summarise.h"
#include "mbk/present/report/result_charts.h"
#include "mbk/present/report/text.h"
#include "mbk/present/report/trials_table.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

using measurement::Examined;

struct MeasureCommandArguments : MeasureArguments {
  ReportArguments report;
  FilesBeside beside;

  /// Whether the plots that show the quality of a result are needed.
  [[nodiscard]] bool draws() const { return report.file || beside.charts; }
};

/// A result, with the diagnostics of the recording if a report will show them.
Result<Examined> measure_one(std::span<const Recording> recordings, const measurement::Options& options,
                             bool with_diagnostics) {
  if (with_diagnostics && recordings.size() == 1) return measurement::examine(recordings, options);
  auto measured = MBK_TRY(measurement::measure(recordings, options));
  return Examined{std::move(measured), {}};
}

/// A recording that was read and measured; its samples are gone.
struct MeasuredOne {
  Examined examined;
  result::RecordingFacts facts;
};

/// One result for each FILE, in the order of the files. Several are measured in parallel; only their samples are in
/// memory.
std::vector<Result<MeasuredOne>> measure_each(const RecordingReader& reader, const measurement::Options& options,
                                              const MeasureCommandArguments& arguments) {
  const int count = reader.count();
  std::vector<Result<MeasuredOne>> results(static_cast<std::size_t>(count), bad_data("not measured"));
  const bool with_report = arguments.report.file.has_value(), draws = arguments.draws();
  const auto measured = [&](int i) -> Result<MeasuredOne> {
    auto recording = MBK_TRY(reader.read_perturbation(i));
    add_arm(arguments.arm, recording);
    auto one = MBK_TRY(measure_one({&recording, 1}, options, draws));
    result::RecordingFacts facts;
    if (with_report) facts = facts_of(recording, one.measured.identification);
    return MeasuredOne{std::move(one), std::move(facts)};
  };
  Progress progress(arguments.output.quiet);
  int done = 0;
  std::ignore = numeric::parallel_for(
      count, arguments.threads,
      [&](int i) -> Result<void> {
        results[static_cast<std::size_t>(i)] = measured(i);
        return {};
      },
      [&](int i) { progress.count(++done, count, reader.file(i).string()); });  // a failure is kept with its file
  return results;
}

/// Everything that a run of the command found.
struct MeasuredTrials {
  std::vector<result::RecordingFacts> facts;  ///< of the recordings of `measured`; for a report
  std::vector<Measurement> measured;
  std::vector<std::optional<Diagnostics>> diagnostics;  ///< one for each result
  bool several = false;                                 ///< more than one result was asked for
  SeveralTrials together;

  void add(Examined one) {
    measured.push_back(std::move(one.measured));
    diagnostics.emplace_back();
    if (!one.diagnostics.empty()) diagnostics.back() = std::move(one.diagnostics.front());
  }
};

/// One fit over all recordings. It needs all of them: one that cannot be read is an error.
Result<MeasuredTrials> measure_pooled(const MeasureCommandArguments& arguments, const measurement::Options& options) {
  auto recordings = MBK_TRY(read_perturbations(reading_for(arguments.reading, options), arguments.sensor));
  for (Recording& recording : recordings) add_arm(arguments.arm, recording);
  auto pooled = MBK_TRY(measure_one(recordings, options, arguments.draws()));
  MeasuredTrials found;
  for (std::size_t k = 0; arguments.report.file && k < recordings.size(); ++k) {
    found.facts.push_back(facts_of(recordings[k], pooled.measured.identification, k));
  }
  found.add(std::move(pooled));
  return found;
}

/// One result for each recording. One that cannot be measured does not stop the others.
Result<MeasuredTrials> measure_apart(const MeasureCommandArguments& arguments, const measurement::Options& options) {
  const auto reader = MBK_TRY(open_recordings(reading_for(arguments.reading, options), arguments.sensor));
  MeasuredTrials found;
  found.several = reader.count() > 1;
  for (Result<MeasuredOne>& one : measure_each(reader, options, arguments)) {
    if (!one) {
      found.together.failed.push_back(one.error());
      continue;
    }
    found.facts.push_back(std::move(one->facts));
    found.add(std::move(one->examined));
  }
  if (!found.several || found.measured.empty()) return found;
  std::vector<Identification> identifications;
  for (const Measurement& one : found.measured) identifications.push_back(one.identification);
  auto mean = analyse::summarise(identifications);
  if (mean) {
    found.together.summary = std::move(*mean);
  } else {
    found.together.no_summary = mean.error().message;
  }
  return found;
}

/// Table and charts.
Result<void> write_beside(const MeasureCommandArguments& arguments, const MeasuredTrials& found) {
  const bool overwrite = arguments.output.to.overwrite;
  if (const auto& file = arguments.beside.summary) {
    const std::string table = file->extension() == ".tex" ? report::trials_latex(found.measured, found.together)
                                                          : report::trials_csv(found.measured, found.together);
    MBK_TRY(recording::write_derived(*file, overwrite, table, arguments.reading.files));
    say_written(file->string(), arguments.output.quiet);
  }
  if (!arguments.beside.charts) return {};
  auto files = MBK_TRY(
      ChartFiles::in(*arguments.beside.charts, arguments.beside.chart_format, overwrite, arguments.reading.files));
  for (std::size_t k = 0; k < found.measured.size(); ++k) {
    const auto charts = report::measurement_charts(found.measured[k], found.diagnostics[k]);
    MBK_TRY(files.write(found.measured[k].identification.sources.front(), charts));
  }
  files.say_written(arguments.output.quiet);
  return {};
}

/// Checks that need no measurement.
Result<void> check(const MeasureCommandArguments& arguments) {
  MBK_TRY(check_files(arguments.reading.files, arguments.output.to, arguments.report, arguments.beside));
  if (!arguments.beside.charts) return {};
  return ChartFiles::check(*arguments.beside.charts, arguments.beside.chart_format, arguments.output.to.overwrite,
                           arguments.reading.files, {"force", "force-x"});
}

/// As a terminal shows them.
std::string text_of(const MeasuredTrials& found) {
  std::string text;
  for (const Measurement& one : found.measured) text += (text.empty() ? "" : "\n") + report::measurement_text(one);
  return found.several ? text + "\n" + report::summary_text(found.together) : text;
}

/// Runs `measure`, or `identify`, which computes no ellipses and no passivity.
int run(const MeasureCommandArguments& given, const std::string& typed, bool with_findings) {
  MeasureCommandArguments arguments = given;
  auto files = recording::named_files(given.reading.files);
  if (!files) return report_error(files.error());
  arguments.reading.files = std::move(*files);
  auto options = measurement_options(arguments, arguments.report.file.has_value());
  if (!options) return report_error(options.error());
  options->passivity = with_findings;
  if (auto ok = check(arguments); !ok) return report_error(ok.error());
  auto found = arguments.pool ? measure_pooled(arguments, *options) : measure_apart(arguments, *options);
  if (!found) return report_error(found.error());
  int code = kFine;
  for (const Error& error : found->together.failed) code = std::max(code, report_error(error));
  if (found->measured.empty()) return code;
  for (Measurement& one : found->measured) {
    if (!with_findings) {
      one.findings.reset();
      one.spatial.reset();
    }
    if (code == kFine && !one.identification.usable) code = kNotUsable;
  }

  report::StaticReport plain;
  if (!arguments.output.json || arguments.report.file) plain.text = text_of(*found);
  const std::string text = !arguments.output.json ? plain.text
                           : found->several       ? result::to_json(found->measured, found->together)
                                                  : result::to_json(found->measured.front());
  if (arguments.report.file) {
    for (const Measurement& one : found->measured) {
      for (report::NamedChart& drawn : report::measurement_charts(one, std::nullopt)) {
        plain.charts.push_back(std::move(drawn.chart));
      }
    }
    const std::string document = report_json(typed, arguments.report.note, found->facts, found->measured,
                                             found->diagnostics, found->several ? &found->together : nullptr);
    if (auto ok = write_page(arguments.report, arguments.output, document, plain, arguments.reading.files); !ok)
      return report_error(ok.error());
  }
  if (auto ok = write_beside(arguments, *found); !ok) return report_error(ok.error());
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return code;
}

Action add(Command app, const char* name, const char* summary, const std::string& footer, const std::string& typed,
           bool with_findings) {
  auto arguments = std::make_shared<MeasureCommandArguments>();
  const Command command = app.add_command(name, summary);
  command.footer(footer);
  add_measure_options(command, *arguments);
  add_options(command, request::arm_table(), *arguments);
  if (with_findings) add_report_options(command, arguments->report);
  add_output_options(command, arguments->output, "mbk.result/2");
  add_summary_option(command, arguments->beside);
  add_charts_option(command, arguments->beside);
  return [arguments, typed, with_findings] { return run(*arguments, typed, with_findings); };
}

}  // namespace

Action add_measure(Command app, const std::string& typed) {
  return add(
      app, "measure", "measure M, B, K and x0 from a recording, with confidence intervals, ellipses and warnings",
      "Examples:\n"
      "  mbk measure log.mat\n"
      "      a log of a planar robot with 19 rows; protocol, window and filters are chosen automatically and reported\n"
      "  mbk measure --mode reference log.mat\n"
      "      reproduces the published procedure sample for sample\n"
      "  mbk measure --axes 1 --channels x=position_rad,F=torque_Nm --split 40 ankle.csv\n"
      "      one joint from a CSV file; the first 40 s identify the model, the rest validates it\n"
      "  mbk measure trial_1.mat trial_2.mat trial_3.mat --json --out results.json\n"
      "      several trials: one result each, and the mean of the usable results with its 95 % interval\n"
      "  mbk measure trials --summary trials.csv --charts charts\n"
      "      every recording of a folder, or of a pattern such as 'S0?/relaxed_*.mat'; one row each; charts as SVG "
      "files\n"
      "  mbk measure log.mat --domain joint --arm 0.30,-0.57,0.31,0.34\n"
      "      also at shoulder and elbow; shoulder at (0.30, -0.57) m, upper arm 0.31 m, forearm 0.34 m\n"
      "  mbk measure log.mat --report log.html --report-note \"Ward 3, 4 May\"\n"
      "      one HTML file to read or print: results in plain language and in numbers, ellipses, plots, glossary\n\n"
      "Exit codes: " +
          std::string(kExitCodes),
      typed, true);
}

Action add_identify(Command app) {
  return add(app, "identify", "fit the model only: M, B, K and x0 with confidence intervals and goodness of fit",
             "Examples:\n"
             "  mbk identify log.mat --json\n"
             "  mbk identify --structure mass-spring rig.mat\n"
             "      a payload on springs: one mass, no damping, symmetric stiffness",
             "", false);
}

}  // namespace mbk::app
