#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// The text of a file, and its name in messages.
struct ScenarioText {
  std::string text;
  std::filesystem::path file;
};

/// The text of a SCENARIO or EXPERIMENT argument: the name of a built-in one, or a TOML file.
/// @fails  data: neither.
[[nodiscard]] Result<ScenarioText> read_scenario_text(const std::string& argument);

/// The trials of a SCENARIO argument.
/// @fails  as read_scenario_text, read_scenarios.
[[nodiscard]] Result<std::vector<Scenario>> read_scenario_argument(const std::string& argument);

/// The built-in scenarios listed by `mbk simulate --list`.
[[nodiscard]] std::vector<std::string> ready_scenario_names();

/// The trial of that name. @fails  usage: there is none; the message lists the existing ones.
[[nodiscard]] Result<Scenario> find_trial(const std::vector<Scenario>& scenarios, const std::string& name);

}  // namespace mbk::laboratory
