#pragma once

#include <string>
#include <vector>

#include "mbk/core/result.h"
#include "mbk/laboratory/scenario.h"

namespace mbk::app {

/// The trials behind a SCENARIO argument: a ready scenario by its name, or a TOML file.
/// @fails  data: neither; as read_scenarios.
[[nodiscard]] Result<std::vector<laboratory::Scenario>> read_scenario_argument(const std::string& argument);

/// What `mbk simulate --list` names.
[[nodiscard]] std::vector<std::string> ready_scenario_names();

/// The one that is called so. @fails  usage: none is; the message names those that there are.
[[nodiscard]] Result<laboratory::Scenario> find_trial(const std::vector<laboratory::Scenario>& scenarios,
                                                      const std::string& name);

}  // namespace mbk::app
