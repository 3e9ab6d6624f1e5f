#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/output.h"

namespace mbk::app {

/// In which form a result is said, and where.
struct OutputArguments {
  bool json = false, quiet = false;
  Output to;
};

/// The HTML report beside it.
struct ReportArguments {
  std::optional<std::filesystem::path> file;
  std::string note;
};

/// Adds --json, --out, --overwrite, --quiet.
void add_output_options(CLI::App& command, OutputArguments& arguments, const std::string& schema);

/// Adds --report and --report-note; --overwrite then speaks of the report too.
void add_report_options(CLI::App& command, ReportArguments& arguments);

/// What can be said of --out, --report and --overwrite before the work begins.
[[nodiscard]] Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output,
                                       const ReportArguments& report = {});

}  // namespace mbk::app
