#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "apps/mbk/options/engine_options.h"

/// Commands whose work can be done in other processes, beside measuring a study (measure_units.h).
namespace mbk::app {

inline constexpr std::string_view kSimulateKind = "simulate", kValidateKind = "validate";

/// Each unit is a recording that is written; what it gives is its line of the summary.
[[nodiscard]] Result<batch::UnitFunction> simulate_units(const nlohmann::json& specification);

/// Each unit is a run, or a trial, of one stage of a validation study.
[[nodiscard]] Result<void> with_validation_units(const nlohmann::json& specification, const batch::JobFolder& folder,
                                                 const UseUnits& use);

}  // namespace mbk::app
