#include "mbk/study/workflow/simulate_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/recording/write.h"
#include "mbk/simulate/laboratory/named_scenario.h"

namespace mbk::workflow {
namespace {

namespace fs = std::filesystem;

/// out.mat → out_NAME_seedN.mat, where there are several trials or seeds.
fs::path file_name(const SimulateOptions& options, const std::string& trial, std::optional<std::uint64_t> seed) {
  std::string stem = options.out.stem().string();
  if (!trial.empty()) stem += "_" + trial;
  if (seed) stem += fmt::format("_seed{}", *seed);
  return options.out.parent_path() / (stem + options.out.extension().string());
}

/// "absorbed +1.759 J" or "delivered 0.473 J".
std::string energy_text(double absorbed) {
  return absorbed < 0.0 ? fmt::format("delivered {:.3f} J", -absorbed) : fmt::format("absorbed {:+.3f} J", absorbed);
}

/// "relaxed.mat: 62.1 s at 1000 Hz, seed 1; relaxed, sinusoidal …; the limb absorbed +1.759 J".
std::string summary_line(const SimulatedTrial& job, const laboratory::Performance& performance) {
  const Recording& recording = performance.recording;
  const auto note = recording.metadata.find("truth_note");
  return fmt::format(
      "{}: {:.1f} s at {:g} Hz, seed {}; {}the limb {}{}\n", job.file.string(), recording.time[recording.samples() - 1],
      job.scenario.rate.value, job.scenario.seed, job.scenario.condition.empty() ? "" : job.scenario.condition + "; ",
      energy_text(performance.energy_absorbed), note == recording.metadata.end() ? "" : "; " + note->second);
}

/// The scenario's text, which a job rests on.
Result<std::string> scenario_sum(const std::string& scenario) {
  if (const auto* ready = laboratory::find_ready_scenario(scenario); ready != nullptr) {
    return recording::sha256(std::as_bytes(std::span(ready->text)));
  }
  return files::file_sha256(scenario);
}

Result<std::string> specification_of(const SimulateOptions& options) {
  const auto sum = MBK_TRY(scenario_sum(options.scenario));
  nlohmann::json json = {{"scenario", options.scenario},         {"scenario_sha256", sum}, {"trials", options.trials},
                         {"out", options.out.string()},          {"seeds", options.seeds}, {"blind", options.blind},
                         {"folder", fs::current_path().string()}};
  if (options.seed) json["seed"] = *options.seed;
  if (options.readers) json["readers"] = word_of(*options.readers);
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// What does the recordings by their numbers. One that is there was written by a process that ended afterwards.
Result<batch::UnitFunction> units_of(SimulateOptions options) {
  options.overwrite = true;
  auto trials = MBK_TRY(simulated_trials(options));
  return [options = std::move(options), trials = std::move(trials)](std::int64_t number,
                                                                    const std::string&) -> Result<std::string> {
    if (number >= std::ssize(trials)) return bad_data("the scenario now has fewer trials", "start the job again");
    return simulate_recording(options, trials[static_cast<std::size_t>(number)]);
  };
}

}  // namespace

Result<std::vector<SimulatedTrial>> simulated_trials(const SimulateOptions& options) {
  const auto scenarios = MBK_TRY(laboratory::read_scenario_argument(options.scenario));
  std::vector<laboratory::Scenario> chosen;
  for (const std::string& name : options.trials) {
    if (std::ranges::count(options.trials, name) > 1) {
      return bad_usage(fmt::format("trial '{}' is requested twice", name), "name each --trial once");
    }
    const auto trial = MBK_TRY(laboratory::find_trial(scenarios, name));
    chosen.push_back(trial);
  }
  std::vector<SimulatedTrial> all;
  for (const laboratory::Scenario& scenario : options.trials.empty() ? scenarios : chosen) {
    for (int k = 0; k < options.seeds; ++k) {
      SimulatedTrial job{scenario, {}};
      job.scenario.seed = options.seed.value_or(scenario.seed) + static_cast<std::uint64_t>(k);
      job.file = file_name(options, scenarios.size() > 1 ? scenario.name : "",
                           options.seeds > 1 ? std::optional(job.scenario.seed) : std::nullopt);
      all.push_back(std::move(job));
    }
  }
  return all;
}

std::string place_of(const SimulateOptions& options, const SimulatedTrial& one) {
  const std::string& trial = one.scenario.name;
  return trial.empty() ? options.scenario : fmt::format("{}, trial '{}'", options.scenario, trial);
}

Result<std::string> simulate_recording(const SimulateOptions& options, const SimulatedTrial& trial,
                                       const std::function<void(double fraction)>& progress) {
  const auto format = MBK_TRY(recording::format_of(options.out));
  laboratory::SimulateOptions how;
  if (progress) how.progress = progress;
  auto performance = laboratory::simulate(trial.scenario, how);
  if (!performance) return tl::unexpected(performance.error().in(place_of(options, trial)));
  const std::string line = summary_line(trial, *performance);
  if (options.blind) performance->recording = laboratory::without_truth(std::move(performance->recording));
  MBK_TRY(recording::write(performance->recording, trial.file, format, options.overwrite,
                           options.readers.value_or(trial.scenario.readers)));
  return line;
}

Result<batch::JobRequest> simulate_request(const SimulateOptions& options, const std::vector<SimulatedTrial>& trials) {
  batch::JobRequest request;
  request.kind = kSimulateKind;
  request.specification = MBK_TRY(specification_of(options));
  request.title = fmt::format("mbk simulate {}, {} recordings", options.scenario, trials.size());
  for (std::size_t k = 0; k < trials.size(); ++k) request.keys.push_back(std::to_string(k));
  request.weights.assign(trials.size(), 1.0);
  request.compute = [trials](std::int64_t number, const std::string&) -> Result<std::string> {
    MBK_TRY(laboratory::simulate(trials[static_cast<std::size_t>(number)].scenario, {}));
    return std::string();
  };
  return request;
}

Result<batch::UnitFunction> simulate_units(const nlohmann::json& specification) {
  SimulateOptions options;
  std::error_code error;
  fs::current_path(specification.at("folder").get<std::string>(), error);
  if (error) return bad_data(error.message(), "make the folder in which the job was started visible to every computer");
  options.scenario = specification.at("scenario");
  const auto sum = MBK_TRY(scenario_sum(options.scenario));
  if (sum != specification.at("scenario_sha256").get<std::string>()) {
    return bad_data("it has changed since the job was started", "restore it, or start the job again", options.scenario);
  }
  options.trials = specification.at("trials").get<std::vector<std::string>>();
  options.out = specification.at("out").get<std::string>();
  options.seeds = specification.at("seeds");
  options.blind = specification.at("blind");
  if (specification.contains("seed")) options.seed = specification.at("seed").get<std::uint64_t>();
  if (specification.contains("readers")) {
    options.readers = value_of<Readers>(specification.at("readers").get<std::string>());
  }
  return units_of(std::move(options));
}

}  // namespace mbk::workflow
