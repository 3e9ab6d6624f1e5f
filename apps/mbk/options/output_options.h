#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/options/chart_format.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// The form of a result, and where it goes.
struct OutputArguments {
  bool json = false, quiet = false;
  Output to;

  /// Writes a document, or a text for people.
  /// @param sources  as Output::write
  [[nodiscard]] Result<void> write(const std::string& text, const std::vector<std::filesystem::path>& sources) const {
    return json ? to.write(text, sources) : to.show(text, sources);
  }
};

/// The HTML report beside it.
struct ReportArguments {
  std::optional<std::filesystem::path> file;
  std::string note;
};

/// A table and drawings beside it.
struct FilesBeside {
  std::optional<std::filesystem::path> summary, charts;  ///< a file; a folder
  ChartFormat chart_format;
};

/// Adds --json, --out, --overwrite, --quiet.
void add_output_options(Command command, OutputArguments& arguments, const std::string& schema);

/// Adds --report and --report-note; --overwrite then applies to the report too.
void add_report_options(Command command, ReportArguments& arguments);

/// Adds --summary; --overwrite then applies to it too.
void add_summary_option(Command command, FilesBeside& beside);

/// Adds --charts, --chart-width and --chart-format; --overwrite then applies to them too.
void add_charts_option(Command command, FilesBeside& beside);

/// Checks --out, --report, --summary and --overwrite before the work begins; for --charts see ChartFiles.
[[nodiscard]] Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output,
                                       const ReportArguments& report = {}, const FilesBeside& beside = {});

}  // namespace mbk::app
