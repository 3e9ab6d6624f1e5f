#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "apps/mbk/caller.h"
#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/job_kinds.h"
#include "apps/mbk/options/chart_files.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"
#include "mbk/validate/study.h"
#include "mbk/validate/udp_fault_kinds.h"
#include "mbk/validate/udp_faults.h"

namespace mbk::app {
namespace {

constexpr int kFallsShort = 1, kNotShown = 6;

int exit_code(RowVerdict verdict) {
  if (verdict == RowVerdict::falls_short) return kFallsShort;
  return verdict == RowVerdict::met ? kFine : kNotShown;
}

/// How the faulty robots of a study are driven.
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
  ChartFormat chart_format;
  Link link = Link::function;
  std::vector<std::string> faults, conditions;
  EngineArguments engine;
  bool json = false, quiet = false, overwrite = false, page = false;
  bool all = false;  ///< one of all studies; it may have no charts
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

/// One line for each study, for the help.
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
Result<void> write_charts(const ValidationTable& table, const std::filesystem::path& folder, const ChartFormat& format,
                          bool overwrite, bool quiet) {
  if (table.charts.empty()) {
    return bad_usage(fmt::format("the study '{}' has no chart", table.study), "omit --charts");
  }
  auto files = MBK_TRY(ChartFiles::in(folder, format, overwrite, {}));
  for (std::size_t k = 0; k < table.charts.size(); ++k) {
    MBK_TRY(files.write({fmt::format("{}-{}", table.study, k + 1), table.charts[k]}));
  }
  files.say_written(quiet);
  return {};
}

Result<ValidationTable> perform(const validation::Study& study, const validation::StudyOptions& options,
                                const ValidateArguments& arguments) {
  if (!arguments.conditions.empty()) {
    if (study.name == "misspecification") return validation::misspecification_study(options, arguments.conditions);
    return bad_usage("--condition is valid only with 'mbk validate misspecification'", "omit it");
  }
  if (arguments.link == Link::function && arguments.faults.empty()) return study.perform(options);
  if (study.name != "faults" || arguments.link != Link::udp) {
    if (study.name == "faults") return bad_usage("--fault is valid only with --link udp", "add it, or omit --fault");
    return bad_usage("--link and --fault are valid only with 'mbk validate faults --link udp'", "omit them");
  }
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error)
    return bad_data(error.message(), "make this link readable; it names the running program", "/proc/self/exe");
  return validation::udp_faults_study({options, program, arguments.faults});
}

/// A study asks for its runs once or several times; each time is a job.
std::filesystem::path stage_folder(const std::filesystem::path& whole, int stage) {
  return whole / fmt::format("stage-{}", stage);
}

/// What a study's runs depend on.
nlohmann::json specification_of(const ValidateArguments& arguments, const validation::StudyOptions& options) {
  return {
      {"study", arguments.study}, {"runs", options.runs}, {"seed", options.seed}, {"conditions", arguments.conditions}};
}

/// Has the runs of a study done by --engine.
class RunsElsewhere {
 public:
  RunsElsewhere(const ValidateArguments& arguments, const validation::StudyOptions& options)
      : arguments_(arguments),
        specification_(specification_of(arguments, options)),
        folder_(arguments.engine.folder.value_or(
            job_folder_here(fmt::format("{}-{}", kValidateKind, arguments.study), specification_.dump()))) {}

  Result<std::vector<std::string>> operator()(int count, const std::function<Result<std::string>(int)>& work) {
    EngineArguments engine = arguments_.engine;
    engine.folder = stage_folder(folder_, stages);
    nlohmann::json specification = specification_;
    specification["stage"] = stages++;
    batch::JobRequest request{std::string(kValidateKind), specification.dump()};
    request.title = fmt::format("mbk validate {} --runs {} --seed {}", arguments_.study,
                                specification_.at("runs").get<int>(), specification_.at("seed").get<std::uint64_t>());
    for (int k = 0; k < count; ++k) request.keys.push_back(std::to_string(k));
    request.weights.assign(request.keys.size(), 1.0);
    request.compute = [&](std::int64_t number, const std::string&) { return work(static_cast<int>(number)); };
    const auto carried = carry_out(engine, request, arguments_.quiet);
    if (!carried) return tl::unexpected(carried.error());
    if (carried->code) {
      code = carried->code;
      return bad_data("some runs were not computed");
    }
    return batch::results_of(*carried->folder);
  }

  /// Removes the jobs, unless --keep-job is given.
  void clear() const {
    if (arguments_.engine.keep) return;
    std::error_code ignored;
    for (int stage = 0; stage < stages; ++stage) {
      const auto folder = batch::JobFolder::open(stage_folder(folder_, stage));
      if (folder) std::ignore = folder->remove();
    }
    std::filesystem::remove(folder_, ignored);  // if it is empty
    if (!arguments_.engine.folder) std::filesystem::remove(folder_.parent_path(), ignored);
  }

  int stages = 0;
  std::optional<int> code;  ///< exit code of the command if a job did not finish

 private:
  const ValidateArguments& arguments_;
  nlohmann::json specification_;
  std::filesystem::path folder_;
};

int run_one(const ValidateArguments& arguments) {
  const validation::Study& study = *find_study(arguments.study);
  if (arguments.page) {
    if (study.name != "faults")
      return report_error({ErrorKind::usage, "--page is valid only with 'faults'", "omit it", ""});
    const auto written = print_text(validation::safety_page());
    return written ? kFine : report_error(written.error());
  }
  Progress progress(arguments.quiet, arguments.study + ": ");
  validation::StudyOptions options;
  options.runs = arguments.runs.value_or(validation::default_runs(study));
  options.seed = arguments.seed;
  options.threads = arguments.threads;
  options.progress = [&](int done, int of) { progress.count(done, of); };
  std::optional<RunsElsewhere> elsewhere;
  if (arguments.engine.kind) {
    if (arguments.link != Link::function || !arguments.faults.empty()) {
      return report_error({ErrorKind::usage, "robots behind UDP run in real time, so that --engine cannot be used",
                           "omit --engine", ""});
    }
    elsewhere.emplace(arguments, options);
    options.elsewhere = [&](int count, const std::function<Result<std::string>(int)>& work) {
      return (*elsewhere)(count, work);
    };
  }
  const auto table = perform(study, options, arguments);
  if (elsewhere && elsewhere->code) return *elsewhere->code;
  if (!table) return report_error(table.error());
  if (elsewhere) elsewhere->clear();
  const auto written =
      arguments.json ? print_text(result::to_json(*table)) : Output().show(report::validation_text(*table), {});
  if (!written) return report_error(written.error());
  if (arguments.charts && !(arguments.all && table->charts.empty())) {
    if (auto ok = write_charts(*table, *arguments.charts, arguments.chart_format, arguments.overwrite, arguments.quiet);
        !ok)
      return report_error(ok.error());
  }
  return exit_code(table->verdict());
}

/// The word for all studies.
constexpr const char* kAll = "all";

/// The worse of two exit codes: an error, then a row that fails, then one that is not shown.
int worse(int a, int b) {
  const auto rank = [](int code) {
    return code == kNotShown ? 1 : code == kFallsShort ? 2 : code == kFine ? 0 : 2 + code;
  };
  return rank(a) < rank(b) ? b : a;
}

/// Every study in turn, in the order of the list.
int run_all(ValidateArguments arguments) {
  if (arguments.json || arguments.page || arguments.engine.folder) {
    return report_error({ErrorKind::usage, "--json, --page and --job-folder are valid only for one study",
                         "name the study; 'mbk validate' lists them", ""});
  }
  arguments.all = true;
  int code = kFine;
  for (const std::string& name : study_names()) {
    arguments.study = name;
    code = worse(code, run_one(arguments));
    if (code != kFine && code != kNotShown && code != kFallsShort) return code;
    if (auto ok = print_text("\n"); !ok) return report_error(ok.error());
  }
  return code;
}

std::string list_of_studies() {
  return "Studies, each of which validates a method against known truth:\n" + study_lines() +
         "\n  mbk validate coverage            one study, with the default number of runs\n"
         "  mbk validate coverage --runs 20  a quick look; rows that need more runs are reported as not shown\n"
         "  mbk validate all                 every study in turn, which takes long\n";
}

int run(const ValidateArguments& arguments, bool bare) {
  if (bare) {
    const auto shown = Output().show(list_of_studies(), {});
    return shown ? kFine : report_error(shown.error());
  }
  return arguments.study == kAll ? run_all(arguments) : run_one(arguments);
}

}  // namespace

Result<void> with_validation_units(const nlohmann::json& specification, const batch::JobFolder& folder,
                                   const UseUnits& use) {
  ValidateArguments arguments;
  arguments.study = specification.at("study");
  arguments.conditions = specification.at("conditions").get<std::vector<std::string>>();
  const validation::Study* const study = find_study(arguments.study);
  if (study == nullptr) return bad_data(fmt::format("'{}' is not a study", arguments.study));
  validation::StudyOptions options;
  options.runs = specification.at("runs");
  options.seed = specification.at("seed");
  options.threads = 1;
  const int requested = specification.at("stage");
  int stage = 0;
  std::optional<Result<void>> used;
  options.elsewhere = [&](int /*count*/,
                          const std::function<Result<std::string>(int)>& work) -> Result<std::vector<std::string>> {
    if (stage < requested) {  // is done, in a folder beside this one
      const auto earlier = batch::JobFolder::open(stage_folder(folder.folder().parent_path(), stage++));
      return earlier ? batch::results_of(*earlier) : tl::unexpected(earlier.error());
    }
    used = use([&](std::int64_t number, const std::string&) { return work(static_cast<int>(number)); });
    return bad_data("the study continues in the process that started the job");
  };
  const auto table = perform(*study, options, arguments);
  if (used) return *used;
  return table ? bad_data("the study has no such stage") : Result<void>(tl::unexpected(table.error()));
}

Action add_validate(Command app) {
  auto arguments = std::make_shared<ValidateArguments>();
  const Command command = app.add_command("validate", "validate a method against known truth; prints a table");
  // Made on demand: the numbers of runs are computed.
  command.footer([] {
    return "Studies:\n" + study_lines() +
           "\nDefault number of runs, and the minimum with which every row can be met:\n" + runs_lines() +
           "\n"
           "Examples:\n"
           "  mbk validate coverage --runs 2000 --seed 7 --json\n"
           "  mbk validate participant --charts charts\n"
           "      charts/participant-1.svg: energy against the amplitude of the pulses\n"
           "  mbk validate recovery --runs 5000 --engine slurm --tasks 200\n"
           "      on a cluster; the table is identical\n"
           "  mbk validate faults --link udp --runs 2\n"
           "      robots that misbehave, as separate processes over UDP, in real time; four trials at a time\n\n"
           "A row is met if its 95 % interval lies within the expected range, and falls short if the whole\n"
           "interval lies outside it. 'not shown' means undecided: more runs are needed.\n\n"
           "Exit codes: 0 every row is met, 1 one falls short, 2 wrong usage, 3 bad or unreadable data,\n"
           "6 not shown by this many runs.";
  });
  const std::string names = fmt::format("{}", fmt::join(study_names(), ", "));
  std::vector<std::string> words = study_names();
  words.emplace_back(kAll);
  command
      .add_option(
          "STUDY", arguments->study,
          fmt::format(
              "study to run: one of {}, or all (default: {}); without any argument or option, the studies are listed",
              names, arguments->study))
      .check([names](const std::string& study) {
        return study == kAll || find_study(study) != nullptr
                   ? ""
                   : fmt::format("'{}' is not a study; choose one of {}", study, names);
      })
      .check(suggests(words));
  command.add_option("--runs", arguments->runs, "number of runs, each with its own seed (default: as listed below)")
      .type_name("N")
      .check(whole_number(1, 1'000'000));
  command.add_option("--seed", arguments->seed, "random seed; the same seed gives the same table (default: 1)")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<std::int64_t>::max()));
  add_threads_option(command, arguments->threads, "number of trials run in parallel");
  add_choice(command, "--link", arguments->link,
             "with 'faults': function, or udp for a robot in a separate process (default: function)")
      .type_name("LINK");
  command.add_option("--fault", arguments->faults, "with 'faults --link udp': run only this fault; may be repeated")
      .type_name("NAME")
      .check(suggests(fault_names()));
  command
      .add_option("--condition", arguments->conditions,
                  "with 'misspecification': run only this condition; may be repeated")
      .type_name("NAME");
  command.add_flag("--page", arguments->page,
                   "with 'faults': print docs/guide/safety.md, from the tables of both links");
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.validation/2");
  const Option charts = command
                            .add_option("--charts", arguments->charts,
                                        "also write the charts of the study to this folder, as files for a paper")
                            .type_name("FOLDER")
                            .check(not_empty());
  add_chart_format(command, arguments->chart_format);
  command.add_flag("--overwrite", arguments->overwrite, "replace existing charts").needs(charts);
  command.add_flag("--quiet", arguments->quiet, "print no progress on standard error");
  add_engine_options(command, arguments->engine);
  return [arguments, command] { return run(*arguments, command.is_bare() && Caller::current() == nullptr); };
}

}  // namespace mbk::app
