#pragma once

#include <span>
#include <string>
#include <vector>

#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/width.h"

namespace mbk::result {

/// How far inertia, damping and stiffness of two results are apart.
struct Comparison {
  std::vector<SourceFile> first, second;
  WidthFindings widths;
};

/// Schema "mbk.compare/1": a matrix without a width is null and `refused` says why; "mbk.comparisons/1" with `results`
/// for several.
[[nodiscard]] std::string to_json(std::span<const Comparison> all);

}  // namespace mbk::result
