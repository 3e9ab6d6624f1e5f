#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk {

/// A number that a user chose, with its name and unit for the message.
struct Choice {
  const char* name;
  double value;
  const char* unit;  ///< "" for none

  /// "handle mass -0.1 kg".
  [[nodiscard]] std::string text() const {
    return fmt::format("{} {:g}{}{}", name, value, *unit == '\0' ? "" : " ", unit);
  }
};

/// @fails  usage: one of them is below zero or not finite.
[[nodiscard]] inline Result<void> not_negative(const std::vector<Choice>& choices) {
  for (const Choice& choice : choices) {
    if (!(choice.value >= 0.0 && std::isfinite(choice.value))) {
      return bad_usage(choice.text() + " is below zero or not finite");
    }
  }
  return {};
}

/// @fails  usage: one of them is zero, below or not finite.
[[nodiscard]] inline Result<void> above_zero(const std::vector<Choice>& choices) {
  for (const Choice& choice : choices) {
    if (!(choice.value > 0.0 && std::isfinite(choice.value))) {
      return bad_usage(choice.text() + " is not above zero");
    }
  }
  return {};
}

/// @fails  usage: the magnitude of one of them is not below the limit.
[[nodiscard]] inline Result<void> magnitude_below(double limit, const std::vector<Choice>& choices) {
  for (const auto& [name, value, unit] : choices) {
    if (!(std::abs(value) < limit)) {
      return bad_usage(fmt::format("{0} {1:g} {3} is not between -{2:g} and {2:g} {3}", name, value, limit, unit));
    }
  }
  return {};
}

/// @fails  usage: one of them is not finite.
[[nodiscard]] inline Result<void> finite(const std::vector<Choice>& choices) {
  for (const Choice& choice : choices) {
    if (!std::isfinite(choice.value)) return bad_usage(choice.text() + " is not finite");
  }
  return {};
}

}  // namespace mbk
