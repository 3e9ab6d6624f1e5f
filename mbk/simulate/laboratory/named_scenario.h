#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// A file's text, and how messages call it.
struct ScenarioText {
  std::string text;
  std::filesystem::path file;
};

/// The text behind a SCENARIO or EXPERIMENT argument: a ready one by its name, or a TOML file.
/// @fails  data: neither.
[[nodiscard]] Result<ScenarioText> read_scenario_text(const std::string& argument);

/// The trials behind a SCENARIO argument.
/// @fails  as read_scenario_text, read_scenarios.
[[nodiscard]] Result<std::vector<Scenario>> read_scenario_argument(const std::string& argument);

/// What `mbk simulate --list` names.
[[nodiscard]] std::vector<std::string> ready_scenario_names();

/// The one that is called so. @fails  usage: none is; the message names those that there are.
[[nodiscard]] Result<Scenario> find_trial(const std::vector<Scenario>& scenarios, const std::string& name);

}  // namespace mbk::laboratory
