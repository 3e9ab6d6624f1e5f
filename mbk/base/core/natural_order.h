#pragma once

#include <string_view>

namespace mbk {

/// Whether `a` comes before `b`: by characters, and by the value of numbers in them, so that trial_2 comes before
/// trial_10.
[[nodiscard]] bool in_natural_order(std::string_view a, std::string_view b);

}  // namespace mbk
