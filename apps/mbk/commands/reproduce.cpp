#include "thesis/reproduce.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/reproduction_json.h"
#include "thesis/thesis_page.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct ReproduceArguments {
  fs::path folder = "thesis";
  std::vector<std::string> only;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool list = false, without_printed = false, json = false, quiet = false, overwrite = false;
};

/// One exhibit on each line.
std::string list_of_exhibits() {
  std::string text;
  for (const auto& [id, title] : thesis::exhibit_names()) text += fmt::format("{:<16} {}\n", id, title);
  return text;
}

/// The id of an erratum for its former name "slip-4", which is accepted for one version; any other id unchanged.
std::string current_id(const std::string& id) {
  constexpr std::string_view kBefore = "slip-";
  if (!id.starts_with(kBefore)) return id;
  const std::string now = "erratum-" + id.substr(kBefore.size());
  say_former_name(id, now);
  return now;
}

/// The exhibit's id, with a number where it has several tables: "table-3.6", "table-5.4-2".
std::string table_file(const Exhibit& exhibit, std::size_t k) {
  return exhibit.tables.size() == 1 ? exhibit.id : fmt::format("{}-{}", exhibit.id, k + 1);
}

/// Writes one exhibit into the folders tables and figures.
Result<void> write_exhibit(const Exhibit& exhibit, const ReproduceArguments& arguments) {
  for (std::size_t k = 0; k < exhibit.tables.size(); ++k) {
    const fs::path file = arguments.folder / "tables" / table_file(exhibit, k);
    MBK_TRY(recording::write_file(file.string() + ".csv", arguments.overwrite, result::to_csv(exhibit.tables[k])));
    MBK_TRY(recording::write_file(file.string() + ".json", arguments.overwrite,
                                  result::to_json(exhibit, exhibit.tables[k])));
  }
  for (std::size_t k = 0; k < exhibit.charts.size(); ++k) {
    const fs::path file = arguments.folder / "figures" / fmt::format("{}-{}.svg", exhibit.id, k + 1);
    MBK_TRY(recording::write_file(file, arguments.overwrite, report::chart_svg(exhibit.charts[k])));
  }
  return {};
}

Result<void> make_folders(const ReproduceArguments& arguments) {
  for (const char* folder : {"", "tables", "figures"}) {
    std::error_code error;
    fs::create_directories(arguments.folder / folder, error);
    if (error)
      return fail(ErrorKind::usage, error.message(), "name a folder that can be created", arguments.folder.string());
  }
  return {};
}

/// Everything, tables and figures first, so that the page is there only once all of it is.
Result<void> write_all(const Reproduction& made, const ReproduceArguments& arguments, const std::string& document) {
  MBK_TRY(make_folders(arguments));
  for (const Exhibit& exhibit : made.exhibits) {
    MBK_TRY(write_exhibit(exhibit, arguments));
  }
  MBK_TRY(recording::write_file(arguments.folder / "reproduction.json", arguments.overwrite, document));
  const auto page = MBK_TRY(thesis::page(made));
  return recording::write_file(arguments.folder / "index.html", arguments.overwrite, page);
}

std::string summary_text(const Reproduction& made, const fs::path& folder) {
  const int agree = made.count(Agreement::within_rounding), errata = made.count(Agreement::erratum),
            differ = made.count(Agreement::differs), not_compared = made.count(Agreement::not_compared);
  std::string text = fmt::format("{}: {} exhibits, {} printed numbers\n", (folder / "index.html").string(),
                                 made.exhibits.size(), made.printed());
  text += fmt::format(
      "  {} follow from other printed numbers: {} agree within their rounding, {} are errata of the source, {} "
      "differ\n",
      agree + errata + differ, agree, errata, differ);
  text +=
      fmt::format("  {} are round trips: computed from the printed number itself\n", made.count(Agreement::round_trip));
  text += fmt::format("  {} are not compared: {} correspond to simulated numbers, {} to text\n", not_compared,
                      made.beside_simulated(), not_compared - made.beside_simulated());
  return text;
}

int run(const ReproduceArguments& arguments) {
  if (arguments.list) {
    const auto ok = print_text(list_of_exhibits());
    return ok ? kFine : report_error(ok.error());
  }
  const fs::path page = arguments.folder / "index.html";
  if (auto ok = check_new_file(page, "--out", arguments.overwrite, {}); !ok) return report_error(ok.error());
  auto source = thesis::read_source(thesis::source_text());
  if (!source) return report_error(source.error());
  if (arguments.without_printed) source->printed.clear();
  Progress progress(arguments.quiet, "reproduce: ");
  thesis::ReproduceOptions options;
  for (const std::string& id : arguments.only) options.only.push_back(current_id(id));
  options.seed = arguments.seed;
  options.threads = arguments.threads;
  options.progress = [&](int done, int of, std::string_view id) { progress.count(done, of, id); };
  const auto made = thesis::reproduce(*source, options);
  if (!made) return report_error(made.error());
  const std::string document = result::to_json(*made);
  if (auto ok = write_all(*made, arguments, document); !ok) return report_error(ok.error());
  const std::string text = arguments.json ? document : summary_text(*made, arguments.folder);
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return made->count(Agreement::differs) == 0 ? kFine : kFallsShort;
}

}  // namespace

Action add_reproduce(Command app) {
  auto arguments = std::make_shared<ReproduceArguments>();
  const Command command =
      app.add_command("reproduce", "reproduce the tables and figures of the thesis that mbk is based on");
  command.footer(
      "Every table and figure of M. Dyck, Measuring the Dynamic Impedance of the Human Arm (MSc thesis,\n"
      "University of Alberta, 2013), compared with the printed numbers: recomputed from other printed\n"
      "numbers, or simulated with the same mechanism, or not recoverable, with the reason; also errata of\n"
      "the source, its research questions and its future work.\n\n"
      "Examples:\n"
      "  mbk reproduce --out thesis\n"
      "      writes thesis/index.html, and tables and figures as files\n"
      "  mbk reproduce --list\n"
      "      lists the exhibits\n"
      "  mbk reproduce --only table-3.6 --only erratum-1 --out excess\n\n"
      "Exit codes: 0 every printed number that follows from others agrees or is a known erratum, 1 one\n"
      "differs, 2 wrong usage, 3 bad data.");
  const Option out = command.add_option("--out", arguments->folder, "output folder (default: thesis)")
                         .type_name("FOLDER")
                         .check(not_empty());
  command.add_option("--only", arguments->only, "reproduce only this exhibit of --list; may be repeated")
      .type_name("ID");
  command.add_flag("--list", arguments->list, "list the exhibits and exit").excludes(out);
  command
      .add_option("--seed", arguments->seed,
                  "random seed of the simulations; the same seed gives the same numbers (default: 1)")
      .type_name("N")
      .check(whole_number(1, 1'000'000'000));
  add_threads_option(command, arguments->threads, "number of trials simulated in parallel");
  command.add_flag("--without-printed", arguments->without_printed,
                   "omit the printed numbers; the reproduced numbers are unchanged");
  command.add_flag("--json", arguments->json, "also print JSON on standard output: schema mbk.reproduction/2");
  command.add_flag("--overwrite", arguments->overwrite, "replace existing files");
  command.add_flag("--quiet", arguments->quiet, "no progress on standard error");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
