#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "apps/mbk/options/engine_options.h"

/// A command whose work can be done in other processes, beside those of mbk/study/workflow.
namespace mbk::app {

inline constexpr std::string_view kValidateKind = "validate";

/// Each unit is a run, or a trial, of one stage of a validation study.
[[nodiscard]] Result<void> with_validation_units(const nlohmann::json& specification, const batch::JobFolder& folder,
                                                 const UseUnits& use);

}  // namespace mbk::app
