#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/springs.h"

namespace mbk::result {

// Schema "mbk.springs/1", in SI units; `what` says which of the three it is.

/// what = "field".
[[nodiscard]] std::string to_json(const SpringField& field);

/// what = "find": a field with its target.
[[nodiscard]] std::string to_json(const SpringDesign& design);

/// what = "calibrate": one entry of `constants` for each recording.
[[nodiscard]] std::string to_json(const std::vector<SpringConstant>& constants);

}  // namespace mbk::result
