#include "mbk/study/workflow/measure_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

namespace mbk::workflow {

namespace fs = std::filesystem;

std::string measure_specification(const fs::path& folder, const OptionTexts& options, const Measuring& measuring) {
  OptionTexts whole = options;
  std::error_code ignored;
  for (auto& [name, values] : whole) {
    const auto* const row = measuring_table().find(name);
    if (row == nullptr || !row->facts.names_file) continue;
    for (std::string& file : values) file = fs::absolute(file, ignored).string();  // a task may run in another folder
  }
  return nlohmann::json{
      {"study", fs::absolute(folder, ignored).string()}, {"options", options_to_json(whole)}, {"key", measuring.key}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<batch::UnitFunction> measure_units(const nlohmann::json& specification) {
  const auto options = MBK_TRY(options_from_json(specification.at("options").get<std::string>()));
  const auto measuring = MBK_TRY(measuring_of(options));
  if (measuring->key != specification.at("key").get<std::string>()) {
    return bad_data("a file named by the options has changed since the job was started",
                    "restore it, or start the job again");
  }
  const fs::path folder = specification.at("study").get<std::string>();
  return measure_units(measuring, folder);
}

batch::UnitFunction measure_units(std::shared_ptr<const Measuring> measuring, fs::path folder) {
  return [measuring = std::move(measuring), folder = std::move(folder)](std::int64_t /*number*/,
                                                                        const std::string& key) -> Result<std::string> {
    const auto unit = MBK_TRY(unit_from(key));
    const auto result = MBK_TRY(measure_unit(*measuring, folder, unit));
    return result_to_bytes(result);
  };
}

std::string unit_key(const store::Unit& unit) {
  return fmt::format("{} {} {}", unit.sha256, unit.part, unit.file);
}

Result<store::Unit> unit_from(const std::string& key) {
  std::istringstream fields(key);
  store::Unit unit;
  if (!(fields >> unit.sha256 >> unit.part >> unit.file)) return bad_data("the job's list of recordings is damaged");
  return unit;
}

std::string result_to_bytes(const store::UnitResult& result) {
  return fmt::format("{}{:08x}{}{}", result.usable ? '1' : '0', result.reason.size(), result.reason, result.document);
}

Result<store::UnitResult> result_from(const std::string& bytes) {
  constexpr std::size_t kHead = 9;
  const auto damaged = [] { return bad_data("a result in a shard cannot be read", "start the job again"); };
  if (bytes.size() < kHead) return damaged();
  std::size_t reason = 0;
  if (std::istringstream head(bytes.substr(1, kHead - 1)); !(head >> std::hex >> reason)) return damaged();
  if (reason > bytes.size() - kHead) return damaged();
  return store::UnitResult{bytes.substr(kHead + reason), bytes.front() == '1', bytes.substr(kHead, reason)};
}

}  // namespace mbk::workflow
