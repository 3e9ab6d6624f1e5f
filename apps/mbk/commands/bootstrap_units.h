#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/mbk/options/engine_options.h"
#include "mbk/study/statistics/people_bootstrap.h"

/// Draws of a study's people, in this process or as the units of a job.
namespace mbk::app {

inline constexpr std::string_view kBootstrapKind = "bootstrap";

struct Bootstrap {
  std::vector<statistics::PeopleTable> tables;
  std::uint64_t seed = 1;
  int draws = 0;
};

[[nodiscard]] Result<std::vector<std::vector<double>>> draws_here(const Bootstrap& bootstrap, bool quiet);

/// Tasks read the tables in the job's specification, and no database.
/// @param study  its folder    @param code  what the command ends with where the job did not come to its end
/// @fails  as carry_out; where `code` is set.
[[nodiscard]] Result<std::vector<std::vector<double>>> draws_elsewhere(const Bootstrap& bootstrap,
                                                                       const EngineArguments& engine,
                                                                       const std::filesystem::path& study, bool quiet,
                                                                       std::optional<int>& code);

/// Each unit is a draw.   @fails  data: no such specification.
[[nodiscard]] Result<batch::UnitFunction> bootstrap_units(const nlohmann::json& specification);

}  // namespace mbk::app
