#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/batch/job_request.h"
#include "mbk/model/trial/readers.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/simulate/laboratory/simulation.h"

/// Simulated trials as recordings: in this process, or as the units of a job.
namespace mbk::workflow {

inline constexpr std::string_view kSimulateKind = "simulate";

/// What is asked for.
struct SimulateOptions {
  std::string scenario;             ///< a file, or the name of a ready one
  std::vector<std::string> trials;  ///< of it; empty: all
  std::filesystem::path out;        ///< several trials or seeds get suffixes
  std::optional<std::uint64_t> seed;
  int seeds = 1;
  std::optional<Readers> readers;
  bool blind = false, overwrite = false;
};

/// One recording that is to be made.
struct SimulatedTrial {
  laboratory::Scenario scenario;
  std::filesystem::path file;
};

/// @fails  as read_scenario_argument; usage: a trial that is not there, or is asked for twice.
[[nodiscard]] Result<std::vector<SimulatedTrial>> simulated_trials(const SimulateOptions& options);

/// The scenario as it was asked for, and the trial in it: where an experiment that cannot be is described.
[[nodiscard]] std::string place_of(const SimulateOptions& options, const SimulatedTrial& trial);

/// Makes one recording.   @returns  its line of the summary
[[nodiscard]] Result<std::string> simulate_recording(const SimulateOptions& options, const SimulatedTrial& trial,
                                                     const std::function<void(double fraction)>& progress = {});

/// All of them as a job; its folder is to be set.
[[nodiscard]] Result<batch::JobRequest> simulate_request(const SimulateOptions& options,
                                                         const std::vector<SimulatedTrial>& trials);

/// Each unit is a recording that is written; what it gives is its line of the summary.
/// @fails  data: no such specification; the scenario has changed.
[[nodiscard]] Result<batch::UnitFunction> simulate_units(const nlohmann::json& specification);

}  // namespace mbk::workflow
