#pragma once

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>

#include "mbk/core/result.h"

namespace mbk::participant {

/// A number that a user chose, with its name and unit for the message.
struct Choice {
  const char* name;
  double value;
  const char* unit;
};

/// @fails  usage: one of them is below zero or not finite.
[[nodiscard]] inline Result<void> not_negative(std::initializer_list<Choice> choices) {
  for (const Choice& choice : choices) {
    if (!(choice.value >= 0.0 && std::isfinite(choice.value))) {
      return bad_usage(fmt::format("{} {:g}{} is below zero or not finite", choice.name, choice.value, choice.unit));
    }
  }
  return {};
}

/// @fails  usage: one of them is zero, below or not finite.
[[nodiscard]] inline Result<void> above_zero(std::initializer_list<Choice> choices) {
  for (const Choice& choice : choices) {
    if (!(choice.value > 0.0 && std::isfinite(choice.value))) {
      return bad_usage(fmt::format("{} {:g}{} is not above zero", choice.name, choice.value, choice.unit));
    }
  }
  return {};
}

}  // namespace mbk::participant
