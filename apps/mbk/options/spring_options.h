#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/springs.h"

namespace mbk::app {

/// "k=120,l=90mm,anchor=565:183[,hole=8:8]": N/m and mm, each key once; the units N/m and mm may be written.
/// @fails  usage: a key is unknown, missing or twice; a value is not a number (which one is named).
[[nodiscard]] Result<Spring> parse_spring(const std::string& given);

/// "393:-55", two numbers in mm, as metres.
[[nodiscard]] Result<Eigen::Vector2d> parse_place(const std::string& option, const std::string& given);

/// "20:400", two numbers, the first below the second.
[[nodiscard]] Result<std::pair<double, double>> parse_range(const std::string& option, const std::string& given);

/// "443.86,232.34,16.74": k_xx, k_yy and k_s [N/m].
[[nodiscard]] Result<Eigen::Matrix2d> parse_stiffness(const std::string& given);

}  // namespace mbk::app
