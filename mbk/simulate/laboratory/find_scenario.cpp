#include "mbk/simulate/laboratory/find_scenario.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "mbk/base/config/text_file.h"

namespace mbk::laboratory {

Result<Scenario> find_scenario(const std::string& name_or_file, const std::string& trial) {
  std::string text;
  if (const ReadyScenario* ready = find_ready_scenario(name_or_file)) {
    text = ready->text;
  } else {
    constexpr std::size_t kLargest = 1'000'000;
    auto read = config::read_text_file(name_or_file, kLargest);
    std::error_code code;
    if (!read && !std::filesystem::exists(name_or_file, code)) {
      return bad_data("there is no such file and no built-in scenario of that name",
                      "list the built-in scenarios with 'mbk simulate --list'", name_or_file);
    }
    if (!read) return tl::unexpected(read.error());
    text = std::move(*read);
  }
  auto scenarios = MBK_TRY(read_scenarios(text, name_or_file));
  for (Scenario& one : scenarios) {
    if (trial.empty() || one.name == trial) return std::move(one);
  }
  return bad_usage(fmt::format("{1} has no trial '{0}'", trial, name_or_file),
                   "use the name of one of its [[trial]] tables");
}

}  // namespace mbk::laboratory
