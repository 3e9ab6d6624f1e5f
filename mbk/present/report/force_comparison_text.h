#pragma once

#include <string>
#include <string_view>

#include "mbk/model/trial/force_comparison.h"

namespace mbk::report {

/// Two small tables for the terminal: how the forces belong together, and how far they are apart in each part of the
/// motion.
/// @param estimated, measured  what the forces are called: "virtual sensor", "force sensor"
[[nodiscard]] std::string force_comparison_text(const ForceComparison& comparison, std::string_view estimated,
                                                std::string_view measured, std::string_view unit = "N");

}  // namespace mbk::report
