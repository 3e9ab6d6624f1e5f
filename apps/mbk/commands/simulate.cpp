#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/job_kinds.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/progress.h"
#include "apps/mbk/options/readers_option.h"
#include "mbk/simulate/laboratory/named_scenario.h"
#include "apps/mbk/options/threads_option.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/recording/write.h"
#include "mbk/present/report/schedule_text.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/study/store/store.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string scenario;
  std::vector<std::string> trials;
  fs::path out;
  std::optional<std::uint64_t> seed;
  int seeds = 1;
  unsigned threads = 0;
  std::optional<Readers> readers;
  EngineArguments engine;
  bool blind = false, overwrite = false, list = false, facts = false, quiet = false;
};

/// One recording that is to be made.
struct Job {
  laboratory::Scenario scenario;
  fs::path file;
};

/// out.mat → out_NAME_seedN.mat, where there are several trials or seeds.
fs::path file_name(const SimulateArguments& arguments, const std::string& trial, std::optional<std::uint64_t> seed) {
  std::string stem = arguments.out.stem().string();
  if (!trial.empty()) stem += "_" + trial;
  if (seed) stem += fmt::format("_seed{}", *seed);
  return arguments.out.parent_path() / (stem + arguments.out.extension().string());
}

Result<std::vector<Job>> jobs_of(const SimulateArguments& arguments) {
  const auto scenarios = MBK_TRY(laboratory::read_scenario_argument(arguments.scenario));
  std::vector<laboratory::Scenario> chosen;
  for (const std::string& name : arguments.trials) {
    if (std::ranges::count(arguments.trials, name) > 1) {
      return bad_usage(fmt::format("trial '{}' is asked for twice", name), "name each --trial once");
    }
    const auto trial = MBK_TRY(laboratory::find_trial(scenarios, name));
    chosen.push_back(trial);
  }
  std::vector<Job> jobs;
  for (const laboratory::Scenario& scenario : arguments.trials.empty() ? scenarios : chosen) {
    for (int k = 0; k < arguments.seeds; ++k) {
      Job job{scenario, {}};
      job.scenario.seed = arguments.seed.value_or(scenario.seed) + static_cast<std::uint64_t>(k);
      job.file = file_name(arguments, scenarios.size() > 1 ? scenario.name : "",
                           arguments.seeds > 1 ? std::optional(job.scenario.seed) : std::nullopt);
      jobs.push_back(std::move(job));
    }
  }
  return jobs;
}

/// The scenario as it was asked for, and the trial in it: where an experiment that cannot be is described.
std::string place_of(const SimulateArguments& arguments, const Job& job) {
  const std::string& trial = job.scenario.name;
  return trial.empty() ? arguments.scenario : fmt::format("{}, trial '{}'", arguments.scenario, trial);
}

Result<void> check_files(const std::vector<Job>& jobs, const SimulateArguments& arguments) {
  for (const Job& job : jobs) {
    Output output;
    output.file = job.file;
    output.overwrite = arguments.overwrite;
    MBK_TRY(output.check({arguments.scenario}));
  }
  return {};
}

/// "relaxed.mat: 62.1 s at 1000 Hz, relaxed, sinusoidal …; E = 1.23 J absorbed".
std::string summary_line(const Job& job, const laboratory::Performance& performance) {
  const Recording& recording = performance.recording;
  const auto note = recording.metadata.find("truth_note");
  return fmt::format("{}: {:.1f} s at {:g} Hz, seed {}; {}the limb absorbed {:+.3f} J{}\n", job.file.string(),
                     recording.time[recording.samples() - 1], job.scenario.rate.value, job.scenario.seed,
                     job.scenario.condition.empty() ? "" : job.scenario.condition + "; ", performance.energy_absorbed,
                     note == recording.metadata.end() ? "" : "; " + note->second);
}

int list() {
  std::string text = "Ready scenarios (mbk simulate NAME --out REC.mat; --show NAME prints one):\n";
  for (const laboratory::ReadyScenario& one : laboratory::ready_scenarios()) {
    const auto scenarios = laboratory::read_scenarios(one.text, std::string(one.name) + ".toml");
    if (!scenarios) return report_error(scenarios.error());
    const std::string trials = scenarios->size() > 1 ? fmt::format(" ({} trials)", scenarios->size()) : "";
    text += fmt::format("  {:<26}{}{}\n", one.name, scenarios->front().condition, trials);
  }
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

int show_scenario(const std::string& name) {
  const auto* ready = laboratory::find_ready_scenario(name);
  if (ready == nullptr) {
    return report_error({ErrorKind::usage, fmt::format("there is no ready scenario '{}'", name),
                         "'mbk simulate --list' names them", ""});
  }
  if (auto ok = print_text(std::string(ready->text)); !ok) return report_error(ok.error());
  return kFine;
}

/// What the perturbation of each trial demands; nothing is simulated.
int show_facts(const SimulateArguments& arguments) {
  const auto jobs = jobs_of(arguments);
  if (!jobs) return report_error(jobs.error());
  std::string text;
  for (const Job& job : *jobs) {
    const auto schedule = perturbation::make_schedule(job.scenario.perturbation, job.scenario.seed);
    if (!schedule) return report_error(schedule.error().in(place_of(arguments, job)));
    text += fmt::format("{}{}{}, seed {}\n", job.scenario.protocol, job.scenario.name.empty() ? "" : " ",
                        job.scenario.name, job.scenario.seed) +
            report::schedule_text(*schedule);
  }
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

/// Makes one recording.   @returns  its line of the summary
Result<std::string> perform(const SimulateArguments& arguments, recording::Format format, const Job& job,
                            const laboratory::SimulateOptions& options) {
  auto performance = laboratory::simulate(job.scenario, options);
  if (!performance) return tl::unexpected(performance.error().in(place_of(arguments, job)));
  const std::string line = summary_line(job, *performance);
  if (arguments.blind) performance->recording = laboratory::without_truth(std::move(performance->recording));
  if (auto ok = recording::write(performance->recording, job.file, format, arguments.overwrite,
                                 arguments.readers.value_or(job.scenario.readers));
      !ok) {
    return tl::unexpected(ok.error());
  }
  return line;
}

/// What does the recordings by their numbers. One that is there was written by a process that ended afterwards.
Result<batch::UnitFunction> units_of(SimulateArguments arguments) {
  arguments.overwrite = true;
  auto jobs = jobs_of(arguments);
  if (!jobs) return tl::unexpected(jobs.error());
  const auto format = recording::format_of(arguments.out);
  if (!format) return tl::unexpected(format.error());
  return [arguments = std::move(arguments), jobs = std::move(*jobs), format = *format](
             std::int64_t number, const std::string&) -> Result<std::string> {
    if (number >= std::ssize(jobs)) return bad_data("the scenario no longer has that many trials", "begin again");
    return perform(arguments, format, jobs[static_cast<std::size_t>(number)], {});
  };
}

/// The scenario's text, which a job rests on.
Result<std::string> scenario_sum(const std::string& scenario) {
  if (const auto* ready = laboratory::find_ready_scenario(scenario); ready != nullptr) {
    return recording::sha256(std::as_bytes(std::span(ready->text)));
  }
  return files::file_sha256(scenario);
}

Result<std::string> specification_of(const SimulateArguments& arguments) {
  const auto sum = MBK_TRY(scenario_sum(arguments.scenario));
  nlohmann::json json = {
      {"scenario", arguments.scenario},       {"scenario_sha256", sum},   {"trials", arguments.trials},
      {"out", arguments.out.string()},        {"seeds", arguments.seeds}, {"blind", arguments.blind},
      {"folder", fs::current_path().string()}};
  if (arguments.seed) json["seed"] = *arguments.seed;
  if (arguments.readers) json["readers"] = word_of(*arguments.readers);
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

int simulate_elsewhere(const SimulateArguments& arguments, const std::vector<Job>& jobs) {
  const auto specification = specification_of(arguments);
  if (!specification) return report_error(specification.error());
  batch::JobRequest request{std::string(kSimulateKind), *specification};
  request.folder = job_folder_here(request.kind, *specification);
  const fs::path folder = arguments.engine.folder.value_or(request.folder);
  // What a job that was interrupted has written may be there.
  if (!batch::JobFolder::is_there(folder)) {
    if (auto ok = check_files(jobs, arguments); !ok) return report_error(ok.error());
  }
  request.title = fmt::format("mbk simulate {}, {} recordings", arguments.scenario, jobs.size());
  for (std::size_t k = 0; k < jobs.size(); ++k) request.keys.push_back(std::to_string(k));
  request.weights.assign(jobs.size(), 1.0);
  request.compute = [&](std::int64_t number, const std::string&) -> Result<std::string> {
    const auto performance = laboratory::simulate(jobs[static_cast<std::size_t>(number)].scenario, {});
    return performance ? Result<std::string>("") : tl::unexpected(performance.error());
  };
  const auto carried = carry_out(arguments.engine, request, arguments.quiet);
  if (!carried) return report_error(carried.error());
  if (carried->code) return *carried->code;
  const auto lines = batch::results_of(*carried->folder);
  if (!lines) return report_error(lines.error());
  if (!arguments.quiet) {
    std::string text;
    for (const std::string& line : *lines) text += line;
    if (auto ok = print_text(text); !ok) return report_error(ok.error());
  }
  if (auto ok = batch::remove_job(*carried->folder, arguments.engine); !ok) return report_error(ok.error());
  return kFine;
}

int run(const SimulateArguments& arguments, recording::Format format) {
  const auto jobs = jobs_of(arguments);
  if (!jobs) return report_error(jobs.error());
  if (arguments.engine.kind) return simulate_elsewhere(arguments, *jobs);
  if (auto ok = check_files(*jobs, arguments); !ok) return report_error(ok.error());
  const int count = static_cast<int>(jobs->size());
  std::vector<std::string> lines(jobs->size());
  Progress progress(arguments.quiet, "simulate: ");
  int done = 0;
  const auto made = numeric::parallel_for(
      count, arguments.threads,
      [&](int i) -> Result<void> {
        const Job& job = (*jobs)[static_cast<std::size_t>(i)];
        laboratory::SimulateOptions options;
        if (count == 1) options.progress = [&](double fraction) { progress.reached(fraction); };
        auto line = MBK_TRY(perform(arguments, format, job, options));
        lines[static_cast<std::size_t>(i)] = std::move(line);
        return {};
      },
      [&](int i) { progress.count(++done, count, (*jobs)[static_cast<std::size_t>(i)].file.string()); });
  if (!made) return report_error(made.error());
  std::string text;
  for (const std::string& line : lines) text += line;
  if (!arguments.quiet) {
    if (auto ok = print_text(text); !ok) return report_error(ok.error());
  }
  return kFine;
}

}  // namespace

Result<batch::UnitFunction> simulate_units(const nlohmann::json& specification) {
  SimulateArguments arguments;
  std::error_code error;
  fs::current_path(specification.at("folder").get<std::string>(), error);
  if (error) return bad_data(error.message(), "every machine must see the folder in which the job was begun");
  arguments.scenario = specification.at("scenario");
  const auto sum = MBK_TRY(scenario_sum(arguments.scenario));
  if (sum != specification.at("scenario_sha256").get<std::string>()) {
    return bad_data("it has changed since the job was begun", "put it back, or begin again", arguments.scenario);
  }
  arguments.trials = specification.at("trials").get<std::vector<std::string>>();
  arguments.out = specification.at("out").get<std::string>();
  arguments.seeds = specification.at("seeds");
  arguments.blind = specification.at("blind");
  if (specification.contains("seed")) arguments.seed = specification.at("seed").get<std::uint64_t>();
  if (specification.contains("readers")) {
    arguments.readers = value_of<Readers>(specification.at("readers").get<std::string>());
  }
  return units_of(std::move(arguments));
}

Action add_simulate(Command app) {
  auto arguments = std::make_shared<SimulateArguments>();
  auto shown = std::make_shared<std::string>();
  const Command command = app.add_command("simulate", "a simulated trial: a recording with the truth in it");
  command.footer(
      "Examples:\n"
      "  mbk simulate --list\n"
      "      the ready scenarios, one for each experiment of the thesis\n"
      "  mbk simulate relaxed_sinusoidal --out relaxed.mat\n"
      "      the end of the name says the format: .h5, .mat (v5) or .csv\n"
      "  mbk simulate --show relaxed_sinusoidal > mine.toml\n"
      "      a commented file to begin your own with; every key carries its unit\n"
      "  mbk simulate mine.toml --out mine.mat --seeds 20\n"
      "      mine_seed1.mat … mine_seed20.mat, as many at a time as there are cores\n"
      "  mbk simulate mine.toml --out mine.h5 --seeds 10000 --engine slurm\n"
      "      as a job array on the cluster\n"
      "  mbk simulate rig_table_5_1 --trial K5_M5 --out rig.mat\n"
      "  mbk simulate mine.toml --facts\n"
      "      peaks, speed, crest factor and band of the perturbation, before anything moves\n\n"
      "The recording holds the truth (truth_M, truth_B, truth_K, …) as metadata, which 'mbk info' shows and\n"
      "nothing that measures reads; --blind leaves it out. The same scenario and seed give the same bytes.\n"
      "Arms that correct their position or force do so with gains that are tuned, not fitted to people.");
  command.add_option("SCENARIO", arguments->scenario, "a .toml file, or the name of a ready scenario")
      .check(suggests(laboratory::ready_scenario_names()));
  command
      .add_option("--out", arguments->out,
                  "the recording to write: .h5, .mat or .csv; several trials or seeds get suffixes")
      .type_name("REC")
      .check(not_empty());
  command.add_option("--trial", arguments->trials, "only this [[trial]] of the file; may be repeated")
      .type_name("NAME");
  command.add_option("--seed", arguments->seed, "of phases, decisions and noise, instead of the scenario's")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<long>::max()));
  command.add_option("--seeds", arguments->seeds, "so many recordings, with seeds from there on (1)")
      .type_name("N")
      .check(whole_number(1, 100'000));
  add_threads_option(command, arguments->threads, "recordings");
  command.add_flag("--blind", arguments->blind, "leave the truth and the scenario's name out");
  command.add_flag("--overwrite", arguments->overwrite, "replace recordings that are there");
  add_readers_option(command, arguments->readers);
  add_engine_options(command, arguments->engine);
  command.add_flag("--list", arguments->list, "the ready scenarios");
  command.add_flag("--facts", arguments->facts, "what the perturbation demands: peaks, speed, band; simulates nothing");
  command.add_option("--show", *shown, "print a ready scenario")
      .type_name("NAME")
      .check(suggests(laboratory::ready_scenario_names()));
  command.add_flag("--quiet", arguments->quiet, "no progress and no summary");
  return [arguments, shown] {
    if (arguments->list) return list();
    if (!shown->empty()) return show_scenario(*shown);
    if (arguments->scenario.empty()) {
      return report_error({ErrorKind::usage, "no scenario", "name a TOML file, or one of 'mbk simulate --list'", ""});
    }
    if (arguments->facts) return show_facts(*arguments);
    if (arguments->out.empty()) {
      return report_error({ErrorKind::usage, "no --out", "name the recording to write: --out recording.mat", ""});
    }
    const auto format = recording::format_of(arguments->out);
    if (!format) return report_error(format.error());
    return run(*arguments, *format);
  };
}

}  // namespace mbk::app
