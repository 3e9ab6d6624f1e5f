#include "apps/mbk/options/output_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/mbk/options/chart_format.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/present/report/html.h"

namespace mbk::app {
namespace output_options {

/// --overwrite applies to every file that the command may write.
void update_overwrite(Command command) {
  std::vector<std::string> names;
  for (const char* const name : {"--out", "--report", "--summary", "--charts"}) {
    if (command.find_option(name)) names.emplace_back(name);
  }
  const auto overwrite = command.find_option("--overwrite");
  if (!overwrite || names.size() < 2) return;
  overwrite->remove_needs(command.get_option("--out"));
  overwrite->description(fmt::format("replace existing files of {}", fmt::join(names, ", ")));
}

}  // namespace output_options

using output_options::update_overwrite;

void add_output_options(Command command, OutputArguments& arguments, const std::string& schema) {
  command.add_flag("--json", arguments.json, fmt::format("print JSON: schema {}, SI units, full precision", schema));
  arguments.to.add_options(command);
  update_overwrite(command);
  command.add_flag("--quiet", arguments.quiet, "neither progress nor names of written files on standard error");
}

void add_report_options(Command command, ReportArguments& arguments) {
  const Option report =
      command
          .add_option(
              "--report", arguments.file,
              "also write a report with all results and plots as one HTML file, to read, print or share; as PDF if the "
              "name ends in .pdf and a browser is installed")
          .type_name("FILE")
          .check(not_empty());
  command
      .add_option(
          "--report-note", arguments.note,
          "a line below the title of the report, such as a date; mbk adds none, so that the same inputs give the same "
          "report")
      .type_name("TEXT")
      .check(not_empty())
      .needs(report);
  update_overwrite(command);
}

void add_summary_option(Command command, FilesBeside& beside) {
  command
      .add_option(
          "--summary", beside.summary,
          "also write a table with one row for each trial and units in its header, as FILE.csv or, for LaTeX, FILE.tex")
      .type_name("FILE")
      .check([](const std::string& file) {
        return file.ends_with(".csv") || file.ends_with(".tex")
                   ? ""
                   : fmt::format("{} does not end in .csv or .tex", quoted(file));
      });
  update_overwrite(command);
}

void add_charts_option(Command command, FilesBeside& beside) {
  command.add_option("--charts", beside.charts, "also write the charts to this folder, as files for a paper")
      .type_name("FOLDER")
      .check(not_empty());
  add_chart_format(command, beside.chart_format);
  update_overwrite(command);
}

Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output,
                         const ReportArguments& report, const FilesBeside& beside) {
  if (output.overwrite && !output.file && !report.file && !beside.summary && !beside.charts) {
    return bad_usage("--overwrite requires --out, --report, --summary or --charts", "name a file to write");
  }
  MBK_TRY(output.check(inputs));
  if (beside.summary) {
    MBK_TRY(check_new_file(*beside.summary, "--summary", output.overwrite, inputs));
  }
  if (!report.file) return {};
  MBK_TRY(mbk::report::page("", {}));
  std::error_code error;
  if (output.file && std::filesystem::weakly_canonical(*output.file, error) ==
                         std::filesystem::weakly_canonical(*report.file, error)) {
    return bad_usage("--out and --report name the same file", "choose another name for one of them");
  }
  MBK_TRY(check_new_file(*report.file, "--report", output.overwrite, inputs));
  return check_report_format(*report.file);
}

}  // namespace mbk::app
