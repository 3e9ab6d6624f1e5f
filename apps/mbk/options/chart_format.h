#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/result_charts.h"

namespace mbk::app {

/// Width and format of the charts that --charts writes.
struct ChartFormat {
  enum class Format { svg, pdf };
  Format format = Format::svg;
  double width_mm = report::kOneColumnMm;

  /// "force" → "force.svg"
  [[nodiscard]] std::string file(const std::string& name) const;

  /// @param sources  as Output::write
  /// @fails  as recording::write_derived. usage: no program that makes a PDF is installed. data: it failed.
  [[nodiscard]] Result<void> write(const std::filesystem::path& file, const report::NamedChart& chart, bool overwrite,
                                   const std::vector<std::filesystem::path>& sources) const;

  /// Before the work begins.   @fails  usage: as above
  [[nodiscard]] Result<void> check() const;
};

[[nodiscard]] constexpr auto word_table(ChartFormat::Format) {
  using enum ChartFormat::Format;
  return std::to_array<Word<ChartFormat::Format>>({{svg, "svg"}, {pdf, "pdf"}});
}

/// Whether a report is to be written as PDF, by the end of its name.
[[nodiscard]] bool is_pdf(const std::filesystem::path& report);

/// Before the work begins.   @fails  usage: the report is a PDF, and no browser is installed
[[nodiscard]] Result<void> check_report_format(const std::filesystem::path& report);

/// A page as a browser prints it.   @fails  as above. data: the browser failed
[[nodiscard]] Result<std::string> page_as_pdf(const std::string& html);

/// Adds --chart-width and --chart-format, which need --charts.
void add_chart_format(Command command, ChartFormat& format);

}  // namespace mbk::app
