#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/warning.h"

/// @file
/// Layout of tables and paragraphs in the terminal. For the sources of this module only.
namespace mbk::report {

inline constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

/// A value and its half width with their significant digits: 1.2002 ± 0.0011.
[[nodiscard]] std::string with_interval(double value, double half_width);

/// The components of a unit vector, each as wide: " 0.71 -0.71  0.00".
[[nodiscard]] std::string direction_text(const Vector& direction);

/// `first`, then the text, in lines of the terminal's width; they stand under each other.
[[nodiscard]] std::string paragraph(std::string_view first, std::string_view text);

/// Left-aligned columns; the width of each is that of its longest cell. A last cell that is too long is broken.
[[nodiscard]] std::string table(const std::vector<std::vector<std::string>>& rows);

/// Every warning with its advice.
[[nodiscard]] std::string warnings_text(const std::vector<Warning>& warnings);

/// The filters of a preparation in one line.
[[nodiscard]] std::string filters_text(const Preparation& how);

}  // namespace mbk::report
