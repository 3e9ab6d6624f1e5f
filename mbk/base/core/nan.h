#pragma once

#include <limits>

namespace mbk {

/// An unknown number.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace mbk
