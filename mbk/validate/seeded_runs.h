#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <type_traits>
#include <vector>

#include "mbk/validate/each_run.h"
#include "mbk/validate/study.h"

namespace mbk::validation {

/// What a study answers that is asked for no runs.
[[nodiscard]] inline tl::unexpected<Error> no_runs(int runs) {
  return bad_usage(fmt::format("{} runs show nothing", runs), "pass --runs 1 or more");
}

/// perform(seed) for as many seeds as there are runs, several at a time, in the order of the seeds.
/// @fails  usage: no runs. As perform: the first failure.
template <class Perform>
auto seeded_runs(const StudyOptions& options, const Perform& perform)
    -> Result<std::vector<typename std::invoke_result_t<Perform, std::uint64_t>::value_type>> {
  if (options.runs < 1) return no_runs(options.runs);
  return each_run(options, options.runs, [&](int i) { return perform(options.seed + static_cast<std::uint64_t>(i)); });
}

}  // namespace mbk::validation
