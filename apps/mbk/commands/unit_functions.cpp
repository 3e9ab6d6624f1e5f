// The function that computes the units of a job, for each kind of job.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/mbk/commands/job_kinds.h"
#include "apps/mbk/options/engine_options.h"
#include "mbk/study/workflow/bootstrap_units.h"
#include "mbk/study/workflow/explore_units.h"
#include "mbk/study/workflow/measure_units.h"
#include "mbk/study/workflow/simulate_recordings.h"

namespace mbk::app {

Result<void> with_units(const batch::JobFolder& folder, const UseUnits& use) {
  const std::string& kind = folder.job().kind;
  const auto json = nlohmann::json::parse(folder.job().specification, nullptr, false);
  Result<batch::UnitFunction> compute =
      bad_data(fmt::format("the job is of the unknown kind '{}'", kind), "use the version of mbk that started it");
  try {
    if (kind == kValidateKind) return with_validation_units(json, folder, use);
    if (kind == workflow::kMeasureKind) compute = workflow::measure_units(json);
    if (kind == workflow::kBootstrapKind) compute = workflow::bootstrap_units(json);
    if (kind == workflow::kExploreKind) compute = workflow::explore_units(json);
    if (kind == workflow::kSimulateKind) compute = workflow::simulate_units(json);
  } catch (const nlohmann::json::exception&) {
    return bad_data("the specification of the job cannot be read", "start the job again", folder.folder().string());
  }
  if (!compute) return tl::unexpected(compute.error());
  return use(*compute);
}

}  // namespace mbk::app
