#pragma once

#include <string>
#include <string_view>

#include "mbk/model/trial/force_comparison.h"

namespace mbk::report {

/// Two tables for the terminal: agreement of the forces overall, and their differences in each part of the motion.
/// @param estimated, measured  names of the forces: "virtual sensor", "force sensor"
[[nodiscard]] std::string force_comparison_text(const ForceComparison& comparison, std::string_view estimated,
                                                std::string_view measured, std::string_view unit = "N");

}  // namespace mbk::report
