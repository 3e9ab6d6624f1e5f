#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/batch/job_request.h"
#include "mbk/study/statistics/people_bootstrap.h"

/// Draws of a study's people, in this process or as the units of a job.
namespace mbk::workflow {

inline constexpr std::string_view kBootstrapKind = "bootstrap";

struct Bootstrap {
  std::vector<statistics::PeopleTable> tables;
  std::uint64_t seed = 1;
  int draws = 0;
};

using Draws = std::vector<std::vector<double>>;

/// @param progress  is told how many draws are done, of how many
[[nodiscard]] Result<Draws> draws_here(const Bootstrap& bootstrap, const std::function<void(int, int)>& progress);

/// The same as a job. Tasks read the tables in its specification, and no database.   @param study  its folder
[[nodiscard]] batch::JobRequest draws_request(const Bootstrap& bootstrap, const std::filesystem::path& study);
/// What the finished job gave.   @fails  as batch::results_of
[[nodiscard]] Result<Draws> draws_of(const batch::JobFolder& job);

/// Each unit is a draw.   @fails  data: no such specification.
[[nodiscard]] Result<batch::UnitFunction> bootstrap_units(const nlohmann::json& specification);

}  // namespace mbk::workflow
