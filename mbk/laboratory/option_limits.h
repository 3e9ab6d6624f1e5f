#pragma once

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>

#include "mbk/core/result.h"

namespace mbk::laboratory {

/// A number that a user chose, with its name and unit for the message.
struct Choice {
  const char* name;
  double value;
  const char* unit;
};

/// @fails  usage: one of them is below zero or not finite.
[[nodiscard]] inline Result<void> not_negative(std::initializer_list<Choice> choices) {
  for (const auto& [name, value, unit] : choices) {
    if (!(value >= 0.0 && std::isfinite(value))) {
      return bad_usage(fmt::format("{} {:g} {} is below zero or not finite", name, value, unit));
    }
  }
  return {};
}

/// @fails  usage: one of them is zero, below or not finite.
[[nodiscard]] inline Result<void> above_zero(std::initializer_list<Choice> choices) {
  for (const auto& [name, value, unit] : choices) {
    if (!(value > 0.0 && std::isfinite(value))) {
      return bad_usage(fmt::format("{} {:g} {} is not above zero", name, value, unit));
    }
  }
  return {};
}

/// @fails  usage: the magnitude of one of them is not below the limit.
[[nodiscard]] inline Result<void> magnitude_below(double limit, std::initializer_list<Choice> choices) {
  for (const auto& [name, value, unit] : choices) {
    if (!(std::abs(value) < limit)) {
      return bad_usage(fmt::format("{0} {1:g} {3} is not between -{2:g} and {2:g} {3}", name, value, limit, unit));
    }
  }
  return {};
}

/// @fails  usage: one of them is not finite.
[[nodiscard]] inline Result<void> finite(std::initializer_list<Choice> choices) {
  for (const auto& [name, value, unit] : choices) {
    if (!std::isfinite(value)) return bad_usage(fmt::format("{} {:g} {} is not finite", name, value, unit));
  }
  return {};
}

}  // namespace mbk::laboratory
