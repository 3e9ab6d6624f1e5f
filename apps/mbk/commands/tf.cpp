#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/threads_option.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/analyse/describe_transfer_function.h"
#include "mbk/measure/measurement/identify_transfer_function.h"
#include "mbk/measure/preprocess/resample.h"
#include "mbk/present/report/transfer_function_text.h"
#include "mbk/present/request/transfer_function_request.h"
#include "mbk/present/result/transfer_function_json.h"

namespace mbk::app {
namespace {

struct TfArguments : request::TransferFunctionRequest {
  OutputArguments to;
  ReportArguments report;
  std::filesystem::path charts;
  ChartFormat chart_format;
};

Result<std::vector<Recording>> read_all(const TfArguments& a, const std::vector<std::filesystem::path>& files) {
  ReadRequest reading = a.reading;
  reading.files = files;
  auto recordings = files.empty() ? Result<std::vector<Recording>>() : read_perturbations(reading);
  if (!recordings) return recordings;
  for (const Recording& recording : *recordings) say_exclusions(recording, false);
  if (!a.resample) return recordings;
  for (Recording& recording : *recordings) {
    recording = MBK_TRY(preprocess::resample(recording, *a.resample));
  }
  return recordings;
}

constexpr std::array kChartNames = {"magnitude", "phase", "nyquist"};

std::filesystem::path chart_file(const TfArguments& arguments, std::size_t chart) {
  return arguments.chart_format.file(arguments.charts.string() + "_" + kChartNames[chart]);
}

/// Every recording that a result is computed from.
std::vector<std::filesystem::path> files_of(const TfArguments& arguments) {
  std::vector<std::filesystem::path> files = arguments.reading.files;
  files.insert(files.end(), arguments.held_out.begin(), arguments.held_out.end());
  return files;
}

/// Checks every file that is to be written, before the work begins.
Result<void> check_written(const TfArguments& arguments) {
  Output output = arguments.to.to;
  const bool charts_alone = !output.file && !arguments.report.file && !arguments.charts.empty();
  if (charts_alone) output.overwrite = false;
  if (auto ok = check_files(arguments.reading.files, output, arguments.report); !ok || arguments.charts.empty())
    return ok;
  MBK_TRY(arguments.chart_format.check());
  for (std::size_t k = 0; k < kChartNames.size(); ++k) {
    if (auto ok =
            check_new_file(chart_file(arguments, k), "--charts", arguments.to.to.overwrite, arguments.reading.files);
        !ok) {
      return ok;
    }
  }
  return {};
}

Result<void> write_charts(const TfArguments& arguments, const std::vector<Chart>& charts) {
  for (std::size_t k = 0; k < charts.size() && !arguments.charts.empty(); ++k) {
    MBK_TRY(arguments.chart_format.write(chart_file(arguments, k), {kChartNames[k], charts[k]},
                                         arguments.to.to.overwrite, files_of(arguments)));
    say_written(chart_file(arguments, k).string(), arguments.to.quiet);
  }
  return {};
}

int run(const TfArguments& given, const std::string& typed) {
  TfArguments arguments = given;
  if (auto ok = check_written(arguments); !ok) return report_error(ok.error());
  const auto options = request::transfer_function_options(arguments);
  if (!options) return report_error(options.error());
  const auto recordings = read_all(arguments, arguments.reading.files);
  if (!recordings) return report_error(recordings.error());
  const auto held_out = read_all(arguments, arguments.held_out);
  if (!held_out) return report_error(held_out.error());
  auto found = measurement::identify_transfer_function(*recordings, *held_out, *options);
  if (!found) return report_error(found.error());
  found->input = request::shown_name(given.input);
  found->output = request::shown_name(given.output);
  found->reference = request::shown_name(given.reference);
  const auto findings = analyse::describe(*found, given.invert);
  if (!findings) return report_error(findings.error());
  if (arguments.report.file) {
    const std::string report = result::report_json(*found, *findings, typed, arguments.report.note);
    if (auto ok = write_page(arguments.report, arguments.to, report, {report::transfer_function_text(*found), {}},
                             files_of(arguments));
        !ok)
      return report_error(ok.error());
  }
  if (auto ok = write_charts(arguments, report::response_charts(*found, findings->response)); !ok) {
    return report_error(ok.error());
  }
  std::string text = arguments.to.json ? result::to_json(*found, *findings) : report::transfer_function_text(*found);
  if (!arguments.to.json && findings->inverse) text += report::inverted_admittance_text(*findings->inverse);
  if (auto ok = arguments.to.write(text, files_of(arguments)); !ok) return report_error(ok.error());
  return found->usable ? kFine : kNotUsable;
}

}  // namespace

Action add_tf(Command app, const std::string& typed) {
  auto arguments = std::make_shared<TfArguments>();
  const Command command = app.add_command("tf", "fit a transfer function from one signal to another");
  command.footer(
      "Examples:\n"
      "  mbk tf arm.csv --input torque_Nm --output acceleration --poles 6 --zeros 5\n"
      "  mbk tf log.mat --input Fx --output x --orders 1:4\n"
      "      a table of all models with 1 to 4 poles, and the model that the data support\n"
      "  mbk tf log.csv --input 2 --output 3 --rate 500 --poles 2 --zeros 0 --delay auto --json\n"
      "  mbk tf loop.csv --input motor --output angle --reference wanted --method clsrivc --poles 3\n"
      "  mbk tf arm.csv --input torque --output angle --method bj --poles 2 --zeros 2 --sample-rate 50\n"
      "  mbk tf log.mat --input -Fx --output x --poles 2 --zeros 0 --invert position --report log.html\n"
      "      from the force on the hand to its position; the inverse is the impedance with M, B and K\n\n"
      "All FILEs are of one system: one model is fitted to them. A fit that did not converge, or\n"
      "converged to an unstable model, is rejected.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  add_options(command, request::transfer_function_signal_table(), *arguments);
  const Option held_out =
      command.add_option("--held-out", arguments->held_out, "validation recordings, which do not enter the fit")
          .type_name("FILE");
  command.accept_former_name(held_out, "--held-back");
  add_options(command, request::transfer_function_clock_table(), *arguments);
  add_main_options(command, request::transfer_function_model_table(), *arguments,
                   {"--poles", "--zeros", "--orders", "--method", "--delay"});
  add_options(command, request::transfer_function_model_table(), *arguments);
  command.accept_former_name(command.get_option("--max-delay"), "--most-delay");
  const char* const model = "Model";
  command
      .add_option("--start-pole", arguments->start_poles_hz,
                  "another starting frequency of the search, in Hz, besides the six in the band; may be repeated")
      .type_name("HZ")
      .check(positive())
      .expected(1)
      .take_all()
      .group(model);
  add_threads_option(command, arguments->options.fit.threads, "number of starts tried in parallel").group(model);
  add_report_options(command, arguments->report);
  add_output_options(command, arguments->to, "mbk.tf/1");
  command.add_option("--charts", arguments->charts, "also write charts: PREFIX_magnitude.svg, _phase.svg, _nyquist.svg")
      .type_name("PREFIX")
      .check(not_empty());
  add_chart_format(command, arguments->chart_format);
  command.get_option("--overwrite").description("replace existing files of --out, --report and --charts");
  return [arguments, typed] { return run(*arguments, typed); };
}

}  // namespace mbk::app
