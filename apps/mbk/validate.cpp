#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "apps/mbk/commands.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "apps/mbk/progress.h"
#include "apps/mbk/word_options.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"
#include "mbk/study/validation/study.h"
#include "mbk/study/validation/udp_fault_kinds.h"
#include "mbk/study/validation/udp_faults.h"

namespace mbk::app {
namespace {

constexpr int kFallsShort = 1, kNotShown = 6;

int exit_code(RowVerdict verdict) {
  if (verdict == RowVerdict::falls_short) return kFallsShort;
  return verdict == RowVerdict::met ? kFine : kNotShown;
}

/// Over what the faulty robots of a study are driven.
enum class Link { function, udp };

constexpr auto word_table(Link) {
  using enum Link;
  return std::to_array<Word<Link>>({{function, "function"}, {udp, "udp"}});
}

struct ValidateArguments {
  std::string study = "coverage";
  std::optional<int> runs;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::optional<std::filesystem::path> charts;
  Link link = Link::function;
  std::vector<std::string> faults, conditions;
  bool json = false, quiet = false, overwrite = false, page = false;
};

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (const validation::UdpFaultKind& kind : validation::udp_fault_kinds()) names.emplace_back(kind.name);
  return names;
}

const validation::Study* find_study(const std::string& name) {
  for (const validation::Study& study : validation::studies()) {
    if (study.name == name) return &study;
  }
  return nullptr;
}

std::vector<std::string> study_names() {
  std::vector<std::string> names;
  for (const validation::Study& study : validation::studies()) names.emplace_back(study.name);
  return names;
}

/// One line for each study, as they stand in the help.
std::string study_lines() {
  std::string lines;
  for (const validation::Study& study : validation::studies()) {
    lines += fmt::format("  {:<17}  {}\n", study.name, study.what);
  }
  return lines;
}

std::string runs_lines() {
  std::string lines;
  for (const validation::Study& study : validation::studies()) {
    lines += fmt::format("  {:<17}  {}, at least {}\n", study.name, validation::default_runs(study),
                         validation::min_runs(study));
  }
  return lines;
}

/// "FOLDER/coverage-1.svg", "FOLDER/coverage-2.svg", …
Result<void> write_charts(const ValidationTable& table, const std::filesystem::path& folder, bool overwrite) {
  if (table.charts.empty()) {
    return bad_usage(fmt::format("the study '{}' draws no chart", table.study), "omit --charts");
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorKind::usage, error.message(), "name a folder that can be made", folder.string());
  for (std::size_t k = 0; k < table.charts.size(); ++k) {
    const auto file = folder / fmt::format("{}-{}.svg", table.study, k + 1);
    if (auto ok = recording::write_file(file, overwrite, report::chart_svg(table.charts[k])); !ok) return ok;
  }
  return {};
}

Result<ValidationTable> perform(const validation::Study& study, const validation::StudyOptions& options,
                                const ValidateArguments& arguments) {
  if (!arguments.conditions.empty()) {
    if (study.name == "misspecification") return validation::misspecification_study(options, arguments.conditions);
    return bad_usage("--condition belongs to 'mbk validate misspecification'", "leave it out");
  }
  if (arguments.link == Link::function && arguments.faults.empty()) return study.perform(options);
  if (study.name != "faults" || arguments.link != Link::udp) {
    return bad_usage("--link and --fault belong to 'mbk validate faults --link udp'", "leave them out");
  }
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return bad_data(error.message(), "it names this program", "/proc/self/exe");
  return validation::udp_faults_study({options, program, arguments.faults});
}

int run(const ValidateArguments& arguments) {
  const validation::Study& study = *find_study(arguments.study);
  if (arguments.page) {
    if (study.name != "faults") return report_error({ErrorKind::usage, "--page belongs to 'faults'", "", ""});
    const auto written = Output().write(validation::safety_page());
    return written ? kFine : report_error(written.error());
  }
  Progress progress(arguments.quiet, arguments.study + ": ");
  validation::StudyOptions options;
  options.runs = arguments.runs.value_or(validation::default_runs(study));
  options.seed = arguments.seed;
  options.threads = arguments.threads;
  options.progress = [&](int done, int of) { progress.count(done, of); };
  const auto table = perform(study, options, arguments);
  if (!table) return report_error(table.error());
  const std::string text = arguments.json ? result::to_json(*table) : report::validation_text(*table);
  if (auto ok = Output().write(text); !ok) return report_error(ok.error());
  if (arguments.charts) {
    if (auto ok = write_charts(*table, *arguments.charts, arguments.overwrite); !ok) return report_error(ok.error());
  }
  return exit_code(table->verdict());
}

}  // namespace

Action add_validate(CLI::App& app) {
  auto arguments = std::make_shared<ValidateArguments>();
  CLI::App* command = add_command(app, "validate", "a method against known truth, as a table");
  // Made where it is asked for: the numbers of runs are computed.
  command->footer([] {
    return "Studies:\n" + study_lines() + "\nRuns by default, and those that it takes to meet every row:\n" +
           runs_lines() +
           "\nExamples:\n"
           "  mbk validate coverage --runs 2000 --seed 7 --json\n"
           "  mbk validate participant --charts charts\n"
           "      charts/participant-1.svg: energy against the amplitude of the pulses\n"
           "  mbk validate faults --link udp --runs 2\n"
           "      robots that misbehave, as processes behind UDP, in real time; four trials side by side\n\n"
           "A row is met where its 95 % interval lies inside what is expected. It falls short where its\n"
           "value lies outside. It is not shown where the value lies inside and the interval does not:\n"
           "that takes more runs.\n\n"
           "Exit codes: 0 every row is met, 1 one falls short, 2 wrong usage, 3 bad or unreadable data,\n"
           "6 not shown by this many runs.";
  });
  const std::string names = fmt::format("{}", fmt::join(study_names(), ", "));
  command->add_option("STUDY", arguments->study, names)
      ->check([names](const std::string& study) {
        return find_study(study) != nullptr ? "" : fmt::format("'{}' is no study; there are: {}", study, names);
      })
      ->check(suggests(study_names()));
  command->add_option("--runs", arguments->runs, "how many seeds (as many as the study needs)")
      ->type_name("N")
      ->check(whole_number(1, 1'000'000));
  command->add_option("--seed", arguments->seed, "the same seed gives the same table (1)")
      ->type_name("N")
      ->check(whole_number(0, std::numeric_limits<long>::max()));
  command->add_option("--threads", arguments->threads, "trials at a time (as many as there are cores)")
      ->type_name("N")
      ->check(whole_number(1, 1024));
  add_choice(*command, "--link", arguments->link,
             "of 'faults': function, or udp for a robot in a process of its own (function)")
      ->type_name("LINK");
  command->add_option("--fault", arguments->faults, "of 'faults --link udp': only this one; may be repeated")
      ->type_name("NAME")
      ->check(suggests(fault_names()));
  command->add_option("--condition", arguments->conditions, "of 'misspecification': only this one; may be repeated")
      ->type_name("NAME");
  command->add_flag("--page", arguments->page,
                    "of 'faults': writes docs/guide/safety.md, from the tables of both links");
  command->add_flag("--json", arguments->json, "for machines: schema mbk.validation/2");
  CLI::Option* const charts = command
                                  ->add_option("--charts", arguments->charts,
                                               "also write the charts of the study as SVG files into this folder")
                                  ->type_name("FOLDER")
                                  ->check(not_empty());
  command->add_flag("--overwrite", arguments->overwrite, "replace those files where they are there")->needs(charts);
  command->add_flag("--quiet", arguments->quiet, "no progress on standard error");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
