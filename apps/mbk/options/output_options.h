#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// In which form a result is said, and where.
struct OutputArguments {
  bool json = false, quiet = false;
  Output to;

  /// A document, or a text for people.
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
};

/// Adds --json, --out, --overwrite, --quiet.
void add_output_options(Command command, OutputArguments& arguments, const std::string& schema);

/// Adds --report and --report-note; --overwrite then speaks of the report too.
void add_report_options(Command command, ReportArguments& arguments);

/// Adds --summary; --overwrite then speaks of it too.
void add_summary_option(Command command, FilesBeside& beside);

/// Adds --charts; --overwrite then speaks of them too.
void add_charts_option(Command command, FilesBeside& beside);

/// What can be said of --out, --report, --summary and --overwrite before the work begins; of --charts see ChartFiles.
[[nodiscard]] Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output,
                                       const ReportArguments& report = {}, const FilesBeside& beside = {});

}  // namespace mbk::app
