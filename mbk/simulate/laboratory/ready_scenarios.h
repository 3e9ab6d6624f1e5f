#pragma once

#include <span>
#include <string_view>

namespace mbk::laboratory {

/// A scenario file that is part of the program: `examples/scenarios/<name>.toml` as it stood when it was built.
struct ReadyScenario {
  std::string_view name;
  std::string_view text;
};

/// All of them, by name.
[[nodiscard]] std::span<const ReadyScenario> ready_scenarios();

/// The one of that name, or nullptr.
[[nodiscard]] const ReadyScenario* find_ready_scenario(std::string_view name);

}  // namespace mbk::laboratory
