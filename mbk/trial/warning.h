#pragma once

#include <array>
#include <string>
#include <string_view>

namespace mbk {

/// Why an answer needs care. The text form (INTERFACE) is stable: scripts may test for it.
enum class WarningCode {
  inertia_not_positive,
  damping_not_positive,
  stiffness_not_positive,
  band_too_narrow,
  motion_on_one_line,
  motion_too_small,
  poorly_conditioned,
  held_back_fit_poor,
  fit_poor,
  no_held_back_data,
  clock_jitter,
  resampled,
  clipping,
  too_little_data,
  decimation_changes_model,
};

/// All of them, to find a code by its text.
inline constexpr std::array kWarningCodes = {WarningCode::inertia_not_positive,
                                             WarningCode::damping_not_positive,
                                             WarningCode::stiffness_not_positive,
                                             WarningCode::band_too_narrow,
                                             WarningCode::motion_on_one_line,
                                             WarningCode::motion_too_small,
                                             WarningCode::poorly_conditioned,
                                             WarningCode::held_back_fit_poor,
                                             WarningCode::fit_poor,
                                             WarningCode::no_held_back_data,
                                             WarningCode::clock_jitter,
                                             WarningCode::resampled,
                                             WarningCode::clipping,
                                             WarningCode::too_little_data,
                                             WarningCode::decimation_changes_model};

/// "inertia-not-positive", …
[[nodiscard]] std::string_view text(WarningCode code);

/// One thing that the user must know, what it means in words, and what to try.
struct Warning {
  WarningCode code;
  std::string message;
  std::string remedy;  ///< what to try next; "try" in JSON
};

}  // namespace mbk
