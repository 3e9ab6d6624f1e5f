#pragma once

#include "mbk/model/trial/force_comparison.h"
#include "mbk/present/result/json_parts.h"

/// For the sources of this module only.
namespace mbk::result {

/// Object `force_comparison` of a result, in SI units; null for what is undefined.
[[nodiscard]] Json force_comparison_json(const ForceComparison& comparison);

}  // namespace mbk::result
