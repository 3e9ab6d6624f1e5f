#pragma once

#include <string>

#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// One trial of a built-in scenario, or of a scenario file.
/// @param trial  the [[trial]] of that name; empty: the first
/// @fails  usage: there is no such trial. data: there is no such scenario or file; as read_scenarios.
[[nodiscard]] Result<Scenario> find_scenario(const std::string& name_or_file, const std::string& trial);

}  // namespace mbk::laboratory
