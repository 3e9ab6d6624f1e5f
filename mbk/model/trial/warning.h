#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace mbk {

/// Why an answer needs care.
enum class WarningCode {
  force_sign_reversed,
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
  torque_unit,
  residual_not_white,
  input_explains_residual,
  pole_outside_band,
  uneven_clock,
};

/// Every code with its text, which is stable: scripts may test for it.
inline constexpr auto kWarningTexts = std::to_array<std::pair<WarningCode, std::string_view>>({
    {WarningCode::force_sign_reversed, "force-sign-reversed"},
    {WarningCode::inertia_not_positive, "inertia-not-positive"},
    {WarningCode::damping_not_positive, "damping-not-positive"},
    {WarningCode::stiffness_not_positive, "stiffness-not-positive"},
    {WarningCode::band_too_narrow, "band-too-narrow"},
    {WarningCode::motion_on_one_line, "motion-on-one-line"},
    {WarningCode::motion_too_small, "motion-too-small"},
    {WarningCode::poorly_conditioned, "poorly-conditioned"},
    {WarningCode::held_back_fit_poor, "held-back-fit-poor"},
    {WarningCode::fit_poor, "fit-poor"},
    {WarningCode::no_held_back_data, "no-held-back-data"},
    {WarningCode::clock_jitter, "clock-jitter"},
    {WarningCode::resampled, "resampled"},
    {WarningCode::clipping, "clipping"},
    {WarningCode::too_little_data, "too-little-data"},
    {WarningCode::decimation_changes_model, "decimation-changes-model"},
    {WarningCode::torque_unit, "torque-unit"},
    {WarningCode::residual_not_white, "residual-not-white"},
    {WarningCode::input_explains_residual, "input-explains-residual"},
    {WarningCode::pole_outside_band, "pole-outside-band"},
    {WarningCode::uneven_clock, "uneven-clock"},
});

/// "inertia-not-positive", …
[[nodiscard]] constexpr std::string_view text(WarningCode code) {
  for (const auto& [known, words] : kWarningTexts) {
    if (known == code) return words;
  }
  return "unknown";
}

/// The code of that text, where there is one.
[[nodiscard]] constexpr std::optional<WarningCode> warning_code(std::string_view words) {
  for (const auto& [known, its_words] : kWarningTexts) {
    if (its_words == words) return known;
  }
  return std::nullopt;
}

/// One thing that the user must know, what it means in words, and what to try.
struct Warning {
  WarningCode code;
  std::string message;
  std::string remedy;  ///< what to try next; "try" in JSON
};

}  // namespace mbk
