#include "mbk/simulate/laboratory/named_scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "mbk/files/contents/read_text.h"

namespace mbk::laboratory {

Result<ScenarioText> read_scenario_text(const std::string& argument) {
  if (const auto* ready = find_ready_scenario(argument)) {
    return ScenarioText{std::string(ready->text), std::string(ready->name) + ".toml"};
  }
  std::error_code error;
  if (!std::filesystem::exists(argument, error)) {
    return bad_data("there is no such file and no built-in scenario or experiment of that name",
                    "list the built-in scenarios with 'mbk simulate --list'", argument);
  }
  auto text = read_text(argument);
  if (!text) return tl::unexpected(text.error());
  return ScenarioText{*std::move(text), argument};
}

Result<std::vector<Scenario>> read_scenario_argument(const std::string& argument) {
  const auto text = MBK_TRY(read_scenario_text(argument));
  return read_scenarios(text.text, text.file);
}

std::vector<std::string> ready_scenario_names() {
  std::vector<std::string> names;
  for (const ReadyScenario& one : ready_scenarios()) names.emplace_back(one.name);
  return names;
}

Result<Scenario> find_trial(const std::vector<Scenario>& scenarios, const std::string& name) {
  const auto found = std::ranges::find(scenarios, name, &Scenario::name);
  if (found != scenarios.end()) return *found;
  std::string known;
  for (const Scenario& one : scenarios) known += (known.empty() ? "" : ", ") + one.name;
  return bad_usage(fmt::format("{1} has no trial '{0}'", name, scenarios.front().protocol),
                   known.empty() ? "it has no [[trial]]" : "use one of: " + known);
}

}  // namespace mbk::laboratory
