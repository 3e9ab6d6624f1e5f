#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "apps/mbk/options/chart_format.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/report/result_charts.h"

namespace mbk::app {

/// The charts of one command as files of one folder, "FOLDER/NAME.svg" or .pdf.
class ChartFiles {
 public:
  /// Checks before the work begins.   @param names  of the charts of each of `inputs`
  /// @fails  usage: FOLDER is not a folder; it contains such a chart, which may not be overwritten.
  /// As ChartFormat::check.
  [[nodiscard]] static Result<void> check(const std::filesystem::path& folder, const ChartFormat& format,
                                          bool overwrite, const std::vector<std::filesystem::path>& inputs,
                                          std::initializer_list<const char*> names);

  /// Creates the folder.    @param sources  as Output::write
  /// @fails  usage: it cannot be created.
  [[nodiscard]] static Result<ChartFiles> in(const std::filesystem::path& folder, const ChartFormat& format,
                                             bool overwrite, std::vector<std::filesystem::path> sources);

  /// "trial_3-force.svg" of a result of "data/trial_3.mat"; if an earlier result has that name,
  /// "trial_3-2-force.svg".
  /// @fails  as ChartFormat::write
  [[nodiscard]] Result<void> write(const SourceFile& source, const std::vector<report::NamedChart>& charts);

  /// @fails  as ChartFormat::write
  [[nodiscard]] Result<void> write(const report::NamedChart& chart);

  /// As app::say_written: how many, and the folder.
  void say_written(bool quiet) const;

 private:
  std::filesystem::path folder_;
  ChartFormat format_;
  std::vector<std::filesystem::path> sources_;
  bool overwrite_ = false;
  std::vector<std::string> begun_;
  int written_ = 0;
};

}  // namespace mbk::app
