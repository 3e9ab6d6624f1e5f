#include <fmt/format.h>

#include <functional>
#include <limits>
#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/readers_option.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/files/recording/write.h"
#include "mbk/present/report/schedule_text.h"
#include "mbk/simulate/laboratory/named_scenario.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/study/workflow/simulate_recordings.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments : workflow::SimulateOptions {
  unsigned threads = 0;
  EngineArguments engine;
  bool list = false, facts = false, quiet = false;
};

using Trials = std::vector<workflow::SimulatedTrial>;

Result<void> check_files(const Trials& jobs, const SimulateArguments& arguments) {
  for (const workflow::SimulatedTrial& job : jobs) {
    Output output;
    output.file = job.file;
    output.overwrite = arguments.overwrite;
    MBK_TRY(output.check({arguments.scenario}));
  }
  return {};
}

int list() {
  std::string text = "Built-in scenarios (mbk simulate NAME --out REC.mat; --show NAME prints one):\n";
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
    return report_error(
        {ErrorKind::usage, fmt::format("'{}' is not a built-in scenario", name), "see 'mbk simulate --list'", ""});
  }
  if (auto ok = print_text(std::string(ready->text)); !ok) return report_error(ok.error());
  return kFine;
}

/// Prints the properties of the perturbation of each trial; simulates nothing.
int show_facts(const SimulateArguments& arguments) {
  const auto jobs = workflow::simulated_trials(arguments);
  if (!jobs) return report_error(jobs.error());
  std::string text;
  for (const workflow::SimulatedTrial& job : *jobs) {
    const auto schedule = perturbation::make_schedule(job.scenario.perturbation, job.scenario.seed);
    if (!schedule) return report_error(schedule.error().in(workflow::place_of(arguments, job)));
    text += fmt::format("{}{}{}, seed {}\n", job.scenario.protocol, job.scenario.name.empty() ? "" : " ",
                        job.scenario.name, job.scenario.seed) +
            report::schedule_text(*schedule);
  }
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

int simulate_elsewhere(const SimulateArguments& arguments, const Trials& jobs) {
  auto request = workflow::simulate_request(arguments, jobs);
  if (!request) return report_error(request.error());
  request->folder = job_folder_here(request->kind, request->specification);
  const fs::path folder = arguments.engine.folder.value_or(request->folder);
  // What a job that was interrupted has written may be there.
  if (!batch::JobFolder::is_there(folder)) {
    if (auto ok = check_files(jobs, arguments); !ok) return report_error(ok.error());
  }
  const auto carried = carry_out(arguments.engine, *request, arguments.quiet);
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

int run(const SimulateArguments& arguments) {
  const auto jobs = workflow::simulated_trials(arguments);
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
        const workflow::SimulatedTrial& job = (*jobs)[static_cast<std::size_t>(i)];
        std::function<void(double)> within;
        if (count == 1) within = [&](double fraction) { progress.reached(fraction); };
        auto line = MBK_TRY(workflow::simulate_recording(arguments, job, within));
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

Action add_simulate(Command app) {
  auto arguments = std::make_shared<SimulateArguments>();
  auto shown = std::make_shared<std::string>();
  const Command command =
      app.add_command("simulate", "simulate a trial and write a recording that contains the true parameters");
  command.footer(
      "Examples:\n"
      "  mbk simulate --list\n"
      "      lists the built-in scenarios, one for each experiment of the thesis\n"
      "  mbk simulate relaxed_sinusoidal --out relaxed.mat\n"
      "      the extension determines the format: .h5, .mat (v5) or .csv\n"
      "  mbk simulate --show relaxed_sinusoidal > mine.toml\n"
      "      prints a commented file to start your own from; every key has its unit in its name\n"
      "  mbk simulate mine.toml --out mine.mat --seeds 20\n"
      "      mine_seed1.mat … mine_seed20.mat, one at a time on each core\n"
      "  mbk simulate mine.toml --out mine.h5 --seeds 10000 --engine slurm\n"
      "      as a job array on the cluster\n"
      "  mbk simulate rig_table_5_1 --trial K5_M5 --out rig.mat\n"
      "  mbk simulate mine.toml --facts\n"
      "      peaks, speed, crest factor and band of the perturbation; simulates nothing\n\n"
      "The metadata of the recording contain the true parameters (truth_M, truth_B, truth_K, …). 'mbk\n"
      "info' shows them, no measuring command reads them, and --blind omits them. The same scenario and\n"
      "seed give the same bytes. Arms that correct their position or force do so with tuned gains, which\n"
      "are not fitted to people.");
  command.add_option("SCENARIO", arguments->scenario, "a .toml file, or the name of a built-in scenario")
      .check(suggests(laboratory::ready_scenario_names()));
  command
      .add_option("--out", arguments->out,
                  "recording to write: .h5, .mat or .csv; several trials or seeds get suffixes")
      .type_name("REC")
      .check(not_empty());
  command.add_option("--trial", arguments->trials, "simulate only this [[trial]] of the file; may be repeated")
      .type_name("NAME");
  command.add_option("--seed", arguments->seed, "random seed; overrides the scenario file")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<std::int64_t>::max()));
  command.add_option("--seeds", arguments->seeds, "number of recordings, with consecutive seeds (default: 1)")
      .type_name("N")
      .check(whole_number(1, 100'000));
  add_threads_option(command, arguments->threads, "number of recordings simulated in parallel");
  command.add_flag("--blind", arguments->blind, "omit the true parameters and the name of the scenario");
  command.add_flag("--overwrite", arguments->overwrite, "replace existing recordings");
  add_readers_option(command, arguments->readers);
  add_engine_options(command, arguments->engine);
  command.add_flag("--list", arguments->list, "list the built-in scenarios");
  command.add_flag("--facts", arguments->facts, "print peaks, speed and band of the perturbation; simulate nothing");
  command.add_option("--show", *shown, "print a built-in scenario")
      .type_name("NAME")
      .check(suggests(laboratory::ready_scenario_names()));
  command.add_flag("--quiet", arguments->quiet, "print no progress and no summary");
  return [arguments, shown] {
    if (arguments->list) return list();
    if (!shown->empty()) return show_scenario(*shown);
    if (arguments->scenario.empty()) {
      return report_error(
          {ErrorKind::usage, "SCENARIO is missing", "name a TOML file, or a scenario of 'mbk simulate --list'", ""});
    }
    if (arguments->facts) return show_facts(*arguments);
    if (arguments->out.empty()) {
      return report_error(
          {ErrorKind::usage, "--out is missing", "name the recording to write: --out recording.mat", ""});
    }
    if (auto format = recording::format_of(arguments->out); !format) return report_error(format.error());
    return run(*arguments);
  };
}

}  // namespace mbk::app
