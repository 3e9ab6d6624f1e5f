#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/measure/analyse/analyse_width.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/present/report/text.h"
#include "mbk/present/report/width_text.h"
#include "mbk/present/request/stored_result.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/width_json.h"

namespace mbk::app {
namespace {

struct CompareArguments : MeasureArguments {
  ReportArguments report;
};

/// One of those that are compared.
struct Compared {
  std::string name;  ///< of the given file, and the number of the result if the file contains several
  result::ReportedResult found;
};

/// The results to compare, and the files of folders that were ignored.
struct Given {
  std::vector<Compared> all;
  std::vector<Error> ignored;  ///< files of folders that contain no result
};

bool is_stored(const std::filesystem::path& file) {
  return file.extension() == ".json";
}

Result<std::vector<Compared>> from_stored(const std::filesystem::path& file) {
  auto results = MBK_TRY(request::stored_results(file));
  std::vector<Compared> all;
  for (result::StoredResult& stored : results) {
    auto measured = request::restored(std::move(stored));
    if (!measured) return tl::unexpected(measured.error().in(file.string()));
    std::string name = file.string();
    if (results.size() > 1) name += fmt::format(", result {}", all.size() + 1);
    all.push_back({std::move(name), {std::move(*measured), {}, {}}});
    all.back().found.recordings.resize(all.back().found.measured.identification.sources.size());
  }
  return all;
}

Result<Compared> from_recording(CompareArguments arguments, const std::filesystem::path& file) {
  arguments.reading.files = {file};
  const bool with_report = arguments.report.file.has_value();
  auto options = MBK_TRY(measurement_options(arguments, with_report));
  options.passivity = with_report;
  auto recordings = MBK_TRY(read_perturbations(reading_for(arguments.reading, options), arguments.sensor));
  for (Recording& recording : recordings) add_arm(arguments.arm, recording);
  auto measured = MBK_TRY(measurement::measure(std::span(recordings), options));
  Compared one{file.string(), {std::move(measured), {}, {}}};
  for (std::size_t k = 0; with_report && k < recordings.size(); ++k) {
    one.found.recordings.push_back(facts_of(recordings[k], one.found.measured.identification, k));
  }
  return one;
}

/// The results of a folder in the order of their names; other files are kept with the reason.
Result<void> add_folder(const std::filesystem::path& folder, Given& given) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_stored(it->path()) && it->is_regular_file(error)) files.push_back(it->path());
  }
  if (error) return bad_data("the folder cannot be read: " + error.message(), "check its permissions", folder.string());
  std::ranges::sort(files);
  const std::size_t before = given.all.size();
  for (const std::filesystem::path& file : files) {
    auto found = from_stored(file);
    if (found) {
      std::ranges::move(*found, std::back_inserter(given.all));
    } else {
      given.ignored.push_back(found.error());
    }
  }
  if (given.all.size() > before) return {};
  return bad_data("the folder contains no result",
                  "write results with 'mbk measure FILE --json --out FOLDER/NAME.json', or name recordings",
                  folder.string());
}

Result<Given> read_all(const CompareArguments& arguments) {
  Given given;
  for (const std::filesystem::path& file : arguments.reading.files) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
      MBK_TRY(add_folder(file, given));
    } else if (is_stored(file)) {
      auto found = MBK_TRY(from_stored(file));
      std::ranges::move(found, std::back_inserter(given.all));
    } else {
      auto found = MBK_TRY(from_recording(arguments, file));
      given.all.push_back(std::move(found));
    }
  }
  if (given.all.size() < 2) {
    return bad_usage("there is only one result",
                     "name another result, a recording, or a folder of results to compare it with");
  }
  return given;
}

const Identification& identification(const Compared& one) {
  return one.found.measured.identification;
}

std::string source_line(const Identification& id, const char* which) {
  std::string text;
  for (const SourceFile& source : id.sources) text += fmt::format("{:<7} {}\n", which, source.label());
  text += fmt::format("        by {}\n", method_name(id.method));
  if (!id.usable) text += fmt::format("  ! the {} result is not usable: 'mbk measure' reports the reason\n", which);
  return text;
}

/// The first and each of the others.
std::string text_of(const std::vector<Compared>& all, const std::vector<WidthFindings>& widths) {
  std::string text;
  const Identification& first = identification(all.front());
  for (std::size_t k = 0; k < widths.size(); ++k) {
    const Identification& second = identification(all[k + 1]);
    if (widths.size() > 1) text += fmt::format("{}{}\n", k == 0 ? "" : "\n", all[k + 1].name);
    text += source_line(first, "first") + source_line(second, "second");
    text +=
        first.usable && second.usable ? report::width_text(widths[k]) : "  not compared; --json contains the numbers\n";
  }
  return text;
}

std::string json_of(const std::vector<Compared>& all, const std::vector<WidthFindings>& widths) {
  std::vector<result::Comparison> comparisons;
  for (std::size_t k = 0; k < widths.size(); ++k) {
    comparisons.push_back({identification(all.front()).sources, identification(all[k + 1]).sources, widths[k]});
  }
  return result::to_json(comparisons);
}

int run(const CompareArguments& arguments, const std::string& typed) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to, arguments.report); !ok)
    return report_error(ok.error());
  auto given = read_all(arguments);
  if (!given) return report_error(given.error());
  for (const Error& error : given->ignored) say("mbk: ignored: {}\n", error.line());
  std::vector<WidthFindings> widths;
  bool good = identification(given->all.front()).usable;
  for (const Compared& other : std::span(given->all).subspan(1)) {
    auto width = analyse::analyse_width(identification(given->all.front()), identification(other));
    if (!width) return report_error(given->all.size() > 2 ? width.error().in(other.name) : width.error());
    good = good && identification(other).usable && width->complete();
    widths.push_back(std::move(*width));
  }
  const std::string shown = arguments.output.json ? json_of(given->all, widths) : text_of(given->all, widths);
  if (arguments.report.file) {
    const std::string plain = text_of(given->all, widths);
    result::ComparisonReport report{{{}, SeveralTrials{}, typed, arguments.report.note}, {}, widths};
    report.compared.together->failed = std::move(given->ignored);
    for (Compared& one : given->all) {
      report.names.push_back(std::move(one.name));
      report.compared.results.push_back(std::move(one.found));
    }
    if (auto ok = write_page(arguments.report, arguments.output, result::to_json(report), {plain, {}},
                             arguments.reading.files);
        !ok)
      return report_error(ok.error());
  }
  if (auto ok = arguments.output.write(shown, arguments.reading.files); !ok) return report_error(ok.error());
  return good ? kFine : kNotUsable;
}

}  // namespace

Action add_compare(Command app, const std::string& typed) {
  auto arguments = std::make_shared<CompareArguments>();
  const Command command = app.add_command("compare", "compare results: how far M, B and K differ");
  command.footer(
      "Examples:\n"
      "  mbk compare relaxed.json rigid.json\n"
      "      files written by 'mbk measure --json --out relaxed.json' and so on\n"
      "  mbk compare relaxed.mat rigid.mat --method iv\n"
      "      measures both recordings with the same options first\n"
      "  mbk compare results/ --report all.html\n"
      "      every result of a folder: side by side on a page, and each compared with the first\n\n"
      "The width measures how much two matrices differ. It is √(Σ ln² λ) over the eigenvalues λ of\n"
      "Z₁⁻¹Z₂, for the symmetric parts of M, B and K each: 0 if both are equal, √2 ln 7 = 2.75 if the\n"
      "second is seven times the first in every direction. It does not depend on axes and units, nor on\n"
      "hand or joint coordinates. The minimum and maximum ratio of the second to the first are reported\n"
      "with their directions from x. A matrix that is not positive definite has no width (exit code 4).\n"
      "Each of several results is compared with the first.");
  add_measure_options(command, *arguments);
  command.get_option("FILE").description("results of 'mbk measure --json', recordings, or folders of results");
  // They join files or add what a comparison does not show.
  for (const char* name : {"--parts", "--pool", "--bootstrap", "--seed", "--decimate-check", "--threads"}) {
    command.remove_option(name);
  }
  add_output_options(command, arguments->output, "mbk.compare/1");
  add_report_options(command, arguments->report);
  return [arguments, typed] { return run(*arguments, typed); };
}

}  // namespace mbk::app
