#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/width.h"

namespace mbk::result {

/// Schema "mbk.compare/1": how far inertia, damping and stiffness of two results are apart. A matrix without a width is
/// null and `refused` says why.
[[nodiscard]] std::string width_to_json(const std::vector<SourceFile>& first, const std::vector<SourceFile>& second,
                                        const WidthFindings& widths);

}  // namespace mbk::result
