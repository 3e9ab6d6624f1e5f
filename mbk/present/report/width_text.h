#pragma once

#include <string>

#include "mbk/model/trial/width.h"

namespace mbk::report {

/// Width between two results for each matrix, with the minimum and maximum ratio and their directions.
[[nodiscard]] std::string width_text(const WidthFindings& widths);

}  // namespace mbk::report
