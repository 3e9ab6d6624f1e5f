#pragma once

#include <string>

#include "mbk/trial/force_comparison.h"

namespace mbk::result {

/// Schema "mbk.force_comparison/1", in SI units; null for what is undefined.
[[nodiscard]] std::string to_json(const ForceComparison& comparison);

}  // namespace mbk::result
