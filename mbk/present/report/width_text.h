#pragma once

#include <string>

#include "mbk/model/trial/width.h"

namespace mbk::report {

/// How far two results are apart, matrix by matrix, and along which directions most and least.
[[nodiscard]] std::string width_text(const WidthFindings& widths);

}  // namespace mbk::report
