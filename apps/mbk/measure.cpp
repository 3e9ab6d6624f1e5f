#include <memory>
#include <tuple>

#include "apps/mbk/commands.h"
#include "apps/mbk/measure_options.h"
#include "apps/mbk/progress.h"
#include "apps/mbk/report_file.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/measure/analyse/summarise.h"
#include "mbk/present/report/joint_domain_text.h"
#include "mbk/present/report/passivity_text.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

using measurement::Examined;

struct MeasureCommandArguments : MeasureArguments {
  AnalyseArguments analyse;
  ReportArguments report;
};

/// A result, with the diagnostics where a report will show them: those of one recording.
Result<Examined> measure_one(std::span<const Recording> recordings, const measurement::Options& options,
                             bool with_diagnostics) {
  if (with_diagnostics && recordings.size() == 1) return measurement::examine(recordings, options);
  auto measured = measurement::measure(recordings, options);
  if (!measured) return tl::unexpected(measured.error());
  return Examined{std::move(*measured), {}};
}

/// One result per recording, several at a time; the order is that of the recordings.
std::vector<Result<Examined>> measure_each(const std::vector<Recording>& recordings,
                                           const measurement::Options& options,
                                           const MeasureCommandArguments& arguments) {
  std::vector<Result<Examined>> results(recordings.size(), bad_data("not measured"));
  const int count = static_cast<int>(recordings.size());
  Progress progress(arguments.output.quiet);
  int done = 0;
  std::ignore = numeric::parallel_for(
      count, arguments.threads,
      [&](int i) -> Result<void> {
        const auto k = static_cast<std::size_t>(i);
        results[k] = measure_one({&recordings[k], 1}, options, arguments.report.file.has_value());
        return {};
      },
      [&](int i) {
        const Recording& recording = recordings[static_cast<std::size_t>(i)];
        progress.count(++done, count, recording.sources.empty() ? "" : recording.sources.front().path);
      });  // a failure is kept with its recording
  return results;
}

/// The work of `measure` and `identify`, which differ only in whether the ellipses are shown.
int run(const MeasureCommandArguments& arguments, const std::string& typed, bool with_findings) {
  const auto options = measurement_options(arguments, arguments.analyse, arguments.report.file.has_value());
  if (!options) return report_error(options.error());
  if (auto ok = check_files(arguments.reading.files, arguments.output.to, arguments.report); !ok)
    return report_error(ok.error());
  auto recordings = read_perturbations(arguments.reading, arguments.sensor);
  if (!recordings) return report_error(recordings.error());
  add_arm(arguments.analyse, *recordings);

  std::vector<Result<Examined>> results;
  if (arguments.pool) {
    results.push_back(measure_one(*recordings, *options, arguments.report.file.has_value()));
  } else {
    results = measure_each(*recordings, *options, arguments);
  }
  std::vector<Measurement> measured;
  std::vector<std::optional<Diagnostics>> diagnostics;
  for (Result<Examined>& one : results) {
    if (!one) return report_error(one.error());
    if (!with_findings) {
      one->measured.findings.reset();
      one->measured.passivity.reset();
    }
    measured.push_back(std::move(one->measured));
    diagnostics.emplace_back();
    if (!one->diagnostics.empty()) diagnostics.back() = std::move(one->diagnostics.front());
  }
  std::optional<Summary> summary;
  if (measured.size() > 1) {
    std::vector<Identification> identifications;
    for (const Measurement& one : measured) identifications.push_back(one.identification);
    auto mean = analyse::summarise(identifications);
    if (!mean) return report_error(mean.error());
    summary = std::move(*mean);
  }

  std::string text;
  if (arguments.output.json) {
    text = summary ? result::to_json(measured, summary) : result::to_json(measured.front());
  } else {
    for (const Measurement& one : measured) {
      if (!text.empty()) text += "\n";
      text += report::result_text(one.identification, one.findings);
      if (one.alternative && one.disagreement) {
        text += "\n" + report::alternative_text(one.identification, *one.alternative, *one.disagreement);
      }
      if (one.force_comparison && one.by_sensor) {
        text += "\n" + report::by_sensor_text(one.identification, *one.by_sensor, *one.force_comparison);
      }
      if (one.joints) text += "\n" + report::joint_domain_text(*one.joints);
      if (one.bootstrap) text += "\n" + report::bootstrap_text(*one.bootstrap);
      if (one.passivity) text += "\n" + report::passivity_lines(*one.passivity);
    }
    if (summary) text += "\n" + report::summary_text(*summary);
  }
  if (arguments.report.file) {
    const std::string document = report_json(typed, arguments.report.note, *recordings, measured, diagnostics, summary);
    if (auto ok = write_page(arguments.report, arguments.output.to.overwrite, document); !ok)
      return report_error(ok.error());
  }
  if (auto ok = arguments.output.to.write(text); !ok) return report_error(ok.error());
  for (const Measurement& one : measured) {
    if (!one.identification.usable) return kNotUsable;
  }
  return kFine;
}

Action add(CLI::App& app, const char* name, const char* summary, const std::string& footer, const std::string& typed,
           bool with_findings) {
  auto arguments = std::make_shared<MeasureCommandArguments>();
  CLI::App* command = add_command(app, name, summary);
  command->footer(footer);
  add_measure_options(*command, *arguments);
  add_analyse_options(*command, arguments->analyse);
  add_output_options(*command, arguments->output, "mbk.result/2");
  if (with_findings) add_report_options(*command, arguments->report);
  return [arguments, typed, with_findings] { return run(*arguments, typed, with_findings); };
}

}  // namespace

Action add_measure(CLI::App& app, const std::string& typed) {
  return add(app, "measure", "recording → M, B, K, x0 with intervals, ellipses, warnings",
             "Examples:\n"
             "  mbk measure log.mat\n"
             "      a 19-row log of a planar robot; protocol, window and filters are chosen and printed\n"
             "  mbk measure --mode reference log.mat\n"
             "      the published procedure, sample for sample\n"
             "  mbk measure --axes 1 --channels x=position_rad,F=torque_Nm --split 40 ankle.csv\n"
             "      one joint from a CSV file, the first 40 s to identify, the rest held out\n"
             "  mbk measure trial_1.mat trial_2.mat trial_3.mat --json --out results.json\n"
             "      several trials: one result each, their mean and the standard error between them\n"
             "  mbk measure log.mat --domain joint --arm 0.30,-0.57,0.31,0.34\n"
             "      at shoulder and elbow too; shoulder at (0.30, -0.57) m, upper arm 0.31 m, forearm 0.34 m\n"
             "  mbk measure log.mat --report log.html --report-note \"Ward 3, 4 May\"\n"
             "      one file for the browser or the printer: the result in plain words, ellipses, plots, glossary\n\n"
             "Exit codes: " +
                 std::string(kExitCodes),
             typed, true);
}

Action add_identify(CLI::App& app) {
  return add(app, "identify", "only the model: M, B, K, x0 with intervals and fit",
             "Examples:\n"
             "  mbk identify log.mat --json\n"
             "  mbk identify --structure mass-spring rig.mat\n"
             "      a payload on springs: one mass, no damping, symmetric stiffness",
             "", false);
}

}  // namespace mbk::app
