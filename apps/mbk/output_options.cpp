#include "apps/mbk/output_options.h"

#include <fmt/format.h>

#include "apps/mbk/option_checks.h"
#include "mbk/present/report/html.h"

namespace mbk::app {

void add_output_options(CLI::App& command, OutputArguments& arguments, const std::string& schema) {
  command.add_flag("--json", arguments.json, fmt::format("for machines: schema {}, SI units, every digit", schema));
  arguments.to.add_options(command);
  command.add_flag("--quiet", arguments.quiet, "no progress on standard error");
}

void add_report_options(CLI::App& command, ReportArguments& arguments) {
  CLI::Option* const report =
      command
          .add_option("--report", arguments.file,
                      "also write everything, with plots, as one HTML file to read, print or pass on")
          ->type_name("FILE")
          ->check(not_empty());
  command
      .add_option(
          "--report-note", arguments.note,
          "a line below the report's title, such as a date and a name; mbk adds no date of its own, so that the "
          "same inputs give the same report")
      ->type_name("TEXT")
      ->check(not_empty())
      ->needs(report);
  CLI::Option* const overwrite = command.get_option("--overwrite");
  overwrite->remove_needs(command.get_option("--out"));
  overwrite->description("replace the files of --out and --report where they are there");
}

Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output,
                         const ReportArguments& report) {
  if (output.overwrite && !output.file && !report.file) {
    return bad_usage("--overwrite requires --out or --report", "name a file to write");
  }
  if (auto ok = output.check(inputs); !ok || !report.file) return ok;
  if (auto page = mbk::report::page(""); !page) return tl::unexpected(page.error());
  std::error_code error;
  if (output.file && std::filesystem::weakly_canonical(*output.file, error) ==
                         std::filesystem::weakly_canonical(*report.file, error)) {
    return bad_usage("--out and --report name the same file", "choose another name for one of them");
  }
  return check_new_file(*report.file, "--report", output.overwrite, inputs);
}

}  // namespace mbk::app
