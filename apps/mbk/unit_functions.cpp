// What the units of jobs are, by the kind of job.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/mbk/engine_options.h"
#include "apps/mbk/measure_units.h"

namespace mbk::app {

Result<batch::UnitFunction> unit_function_of(const std::string& kind, const std::string& specification) {
  const auto json = nlohmann::json::parse(specification, nullptr, false);
  if (!json.is_object()) return bad_data("the job's specification cannot be read", "start the job again");
  try {
    if (kind == kMeasureKind) return measure_units(json);
  } catch (const nlohmann::json::exception&) {
    return bad_data("the job's specification cannot be read", "start the job again");
  }
  return bad_data(fmt::format("this mbk does not know jobs of the kind '{}'", kind), "use the mbk that began it");
}

}  // namespace mbk::app
