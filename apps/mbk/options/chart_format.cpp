#include "apps/mbk/options/chart_format.h"

#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <regex>

#include "apps/mbk/options/word_options.h"
#include "mbk/base/system/command_output.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/base/system/temporary_folder.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::app {
namespace chart_format {

enum class Converter { rsvg, inkscape, browser };

struct Program {
  const char* name;
  Converter converter;
};

constexpr auto kPrograms = std::to_array<Program>({{"rsvg-convert", Converter::rsvg},
                                                   {"inkscape", Converter::inkscape},
                                                   {"chromium", Converter::browser},
                                                   {"chromium-browser", Converter::browser},
                                                   {"chromium-headless-shell", Converter::browser},
                                                   {"google-chrome", Converter::browser}});

/// The first that is in PATH; for pages the first browser.
std::optional<Program> installed(bool for_pages = false) {
  for (const Program& program : kPrograms) {
    if (for_pages && program.converter != Converter::browser) continue;
    if (!system::find_program(program.name).empty()) return program;
  }
  return std::nullopt;
}

Result<Program> converter() {
  if (const auto found = installed()) return *found;
  return bad_usage("--chart-format pdf: no program that converts SVG to PDF is installed",
                   "install librsvg2-bin (rsvg-convert), inkscape or chromium, or omit --chart-format");
}

/// A page of exactly the drawing's size.
std::string page_of(const std::string& svg) {
  static const std::regex kPageSize(R"re(width="([\d.]+mm)" height="([\d.]+mm)")re");
  std::smatch found;
  if (!std::regex_search(svg, found, kPageSize)) return svg;
  return fmt::format(
      "<!DOCTYPE html><meta charset=\"utf-8\"><style>@page {{ size: {} {}; margin: 0 }} html, body {{ margin: 0 }} "
      "svg {{ display: block; break-inside: avoid }}</style>{}",
      found[1].str(), found[2].str(), svg);
}

std::vector<std::string> command_of(const Program& program, const std::string& in, const std::string& out,
                                    const std::string& folder) {
  switch (program.converter) {
    case Converter::rsvg:
      return {program.name, "--format=pdf", "--output=" + out, in};
    case Converter::inkscape:
      return {program.name, in, "--export-type=pdf", "--export-filename=" + out};
    case Converter::browser:
      break;
  }
  std::vector<std::string> command = {program.name,
                                      "--headless",
                                      "--disable-gpu",
                                      "--no-pdf-header-footer",
                                      "--user-data-dir=" + folder,
                                      "--virtual-time-budget=10000",
                                      "--print-to-pdf=" + out};
  if (system::is_administrator()) command.emplace_back("--no-sandbox");  // it refuses to run as root otherwise
  command.push_back("file://" + in);
  return command;
}

Result<std::string> pdf_by(const Program& program, const std::string& content, const char* otherwise) {
  constexpr double kLongestSeconds = 60.0;
  const TemporaryFolder temporary = MBK_TRY(TemporaryFolder::create("mbk-pdf"));
  const std::filesystem::path in =
      temporary.path() / (program.converter == Converter::browser ? "page.html" : "chart.svg");
  const std::filesystem::path out = temporary.path() / "made.pdf";
  std::ofstream(in, std::ios::binary) << content;
  const auto ran = MBK_TRY(system::command_output(
      command_of(program, in.string(), out.string(), (temporary.path() / "profile").string()), kLongestSeconds));
  std::ifstream file(out, std::ios::binary);
  std::string pdf((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (ran.code == 0 && pdf.starts_with("%PDF")) return pdf;
  return bad_data(fmt::format("{} did not make a PDF (exit code {}): {}", program.name, ran.code,
                              ran.error.substr(0, ran.error.find('\n'))),
                  otherwise);
}

Result<std::string> pdf_of(const std::string& svg) {
  const Program program = MBK_TRY(converter());
  return pdf_by(program, program.converter == Converter::browser ? page_of(svg) : svg,
                "install librsvg2-bin (rsvg-convert), or omit --chart-format");
}

Result<Program> browser() {
  if (const auto found = installed(true)) return *found;
  return bad_usage("a report as PDF needs a browser, and none is installed",
                   "install chromium, or write the report as .html and print it from any browser");
}

}  // namespace chart_format

bool is_pdf(const std::filesystem::path& report) {
  return report.extension() == ".pdf";
}

Result<void> check_report_format(const std::filesystem::path& report) {
  if (is_pdf(report)) {
    MBK_TRY(chart_format::browser());
    return {};
  }
  const std::string extension = report.extension().string();
  if (extension == ".html" || extension == ".htm") return {};
  return bad_usage("a report is an HTML or a PDF file", "choose a name that ends in .html or .pdf");
}

Result<std::string> page_as_pdf(const std::string& html) {
  return chart_format::pdf_by(MBK_TRY(chart_format::browser()), html, "write the report as .html instead");
}

std::string ChartFormat::file(const std::string& name) const {
  return fmt::format("{}.{}", name, word_of(format));
}

Result<void> ChartFormat::write(const std::filesystem::path& file, const report::NamedChart& chart, bool overwrite,
                                const std::vector<std::filesystem::path>& sources) const {
  std::vector<Chart> panels = {chart.chart};
  panels.insert(panels.end(), chart.beside.begin(), chart.beside.end());
  std::string drawn = report::charts_svg(chart.chart.title, panels, width_mm);
  if (format == Format::pdf) drawn = MBK_TRY(chart_format::pdf_of(drawn));
  return recording::write_derived(file, overwrite, drawn, sources);
}

Result<void> ChartFormat::check() const {
  if (format == Format::pdf) MBK_TRY(chart_format::converter());
  return {};
}

void add_chart_format(Command command, ChartFormat& format) {
  constexpr int kNarrowest = 60, kWidest = 400;
  const Option charts = command.get_option("--charts");
  command
      .add_option("--chart-width", format.width_mm,
                  "width of the charts in mm, with text of 8 pt: 85 for one column of a page, 180 for two")
      .type_name("MM")
      .check(whole_number(kNarrowest, kWidest))
      .needs(charts);
  add_choice(command, "--chart-format", format.format,
             "format of the charts; pdf needs rsvg-convert, inkscape or chromium")
      .needs(charts);
}

}  // namespace mbk::app
