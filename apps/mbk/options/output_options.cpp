#include "apps/mbk/options/output_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mbk/base/core/option_checks.h"
#include "mbk/present/report/html.h"

namespace mbk::app {
namespace output_options {

/// --overwrite speaks of every file that the command may write.
void replaces_too(Command command) {
  std::vector<std::string> names;
  for (const char* const name : {"--out", "--report", "--summary", "--charts"}) {
    if (command.find_option(name)) names.emplace_back(name);
  }
  const Option overwrite = command.get_option("--overwrite");
  overwrite.remove_needs(command.get_option("--out"));
  overwrite.description(fmt::format("replace the files of {} where they are there", fmt::join(names, ", ")));
}

}  // namespace output_options

using output_options::replaces_too;

void add_output_options(Command command, OutputArguments& arguments, const std::string& schema) {
  command.add_flag("--json", arguments.json, fmt::format("for machines: schema {}, SI units, every digit", schema));
  arguments.to.add_options(command);
  command.add_flag("--quiet", arguments.quiet, "no progress on standard error");
}

void add_report_options(Command command, ReportArguments& arguments) {
  const Option report = command
                            .add_option("--report", arguments.file,
                                        "also write everything, with plots, as one HTML file to read, print or pass on")
                            .type_name("FILE")
                            .check(not_empty());
  command
      .add_option(
          "--report-note", arguments.note,
          "a line below the report's title, such as a date and a name; mbk adds no date of its own, so that the "
          "same inputs give the same report")
      .type_name("TEXT")
      .check(not_empty())
      .needs(report);
  replaces_too(command);
}

void add_summary_option(Command command, FilesBeside& beside) {
  command
      .add_option(
          "--summary", beside.summary,
          "also write a table with one row a trial and units in its header, as FILE.csv or, for LaTeX, FILE.tex")
      .type_name("FILE")
      .check([](const std::string& file) {
        return file.ends_with(".csv") || file.ends_with(".tex")
                   ? ""
                   : fmt::format("{} ends in neither .csv nor .tex", quoted(file));
      });
  replaces_too(command);
}

void add_charts_option(Command command, FilesBeside& beside) {
  command.add_option("--charts", beside.charts, "also write the charts as SVG files into this folder")
      .type_name("FOLDER")
      .check(not_empty());
  replaces_too(command);
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
  MBK_TRY(mbk::report::page(""));
  std::error_code error;
  if (output.file && std::filesystem::weakly_canonical(*output.file, error) ==
                         std::filesystem::weakly_canonical(*report.file, error)) {
    return bad_usage("--out and --report name the same file", "choose another name for one of them");
  }
  return check_new_file(*report.file, "--report", output.overwrite, inputs);
}

}  // namespace mbk::app
