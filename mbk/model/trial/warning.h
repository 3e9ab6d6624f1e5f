#pragma once

#include <array>
#include <string>

#include "mbk/base/core/words.h"

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
  held_out_fit_poor,
  fit_poor,
  no_held_out_data,
  clock_jitter,
  resampled,
  held_signal,
  missing_samples,
  clipping,
  too_little_data,
  decimation_changes_model,
  torque_unit,
  residual_not_white,
  input_explains_residual,
  pole_outside_band,
  delay_at_limit,
  uneven_clock,
  closed_loop_bias,
  no_reference,
  unmodelled_response,
  weak_instruments,
  invalid_instruments,
  missing_dynamics,
  nonlinear_stiffness,
  dry_friction,
  stiffness_changes,
  damping_changes,
  memory,
  even_nonlinearity,
  lack_of_fit,
  force_drifts,
  contact_lost,
  tremor,
  mixed_conditions,
  implausible_scale,
  axes_scaled_differently,
  axes_mismatched,
  inertia_not_symmetric,
  same_column,
  other_column,
  handle_mass_too_large,
  consistent_fit_poor,
  low_coherence,
  few_realisations,
  nonlinear_distortion,
  elastic_drive,
  backlash,
  robot_changed,
  excluded_trial,
  excluded_window,
};

/// Stable: scripts may test for these words.
[[nodiscard]] constexpr auto word_table(WarningCode) {
  using enum WarningCode;
  return std::to_array<Word<WarningCode>>({
      {force_sign_reversed, "force-sign-reversed"},
      {inertia_not_positive, "inertia-not-positive"},
      {damping_not_positive, "damping-not-positive"},
      {stiffness_not_positive, "stiffness-not-positive"},
      {band_too_narrow, "band-too-narrow"},
      {motion_on_one_line, "motion-on-one-line"},
      {motion_too_small, "motion-too-small"},
      {poorly_conditioned, "poorly-conditioned"},
      {held_out_fit_poor, "held-out-fit-poor"},
      {fit_poor, "fit-poor"},
      {no_held_out_data, "no-held-out-data"},
      {clock_jitter, "clock-jitter"},
      {resampled, "resampled"},
      {held_signal, "held-signal"},
      {missing_samples, "missing-samples"},
      {clipping, "clipping"},
      {too_little_data, "too-little-data"},
      {decimation_changes_model, "decimation-changes-model"},
      {torque_unit, "torque-unit"},
      {residual_not_white, "residual-not-white"},
      {input_explains_residual, "input-explains-residual"},
      {pole_outside_band, "pole-outside-band"},
      {delay_at_limit, "delay-at-limit"},
      {uneven_clock, "uneven-clock"},
      {closed_loop_bias, "closed-loop-bias"},
      {no_reference, "no-reference"},
      {unmodelled_response, "unmodelled-response"},
      {weak_instruments, "weak-instruments"},
      {invalid_instruments, "invalid-instruments"},
      {missing_dynamics, "missing-dynamics"},
      {nonlinear_stiffness, "nonlinear-stiffness"},
      {dry_friction, "dry-friction"},
      {stiffness_changes, "stiffness-changes"},
      {damping_changes, "damping-changes"},
      {memory, "memory"},
      {even_nonlinearity, "even-nonlinearity"},
      {lack_of_fit, "lack-of-fit"},
      {force_drifts, "force-drifts"},
      {contact_lost, "contact-lost"},
      {tremor, "tremor"},
      {mixed_conditions, "mixed-conditions"},
      {implausible_scale, "implausible-scale"},
      {axes_scaled_differently, "axes-scaled-differently"},
      {axes_mismatched, "axes-mismatched"},
      {inertia_not_symmetric, "inertia-not-symmetric"},
      {same_column, "same-column"},
      {other_column, "other-column"},
      {handle_mass_too_large, "handle-mass-too-large"},
      {consistent_fit_poor, "consistent-fit-poor"},
      {low_coherence, "low-coherence"},
      {few_realisations, "few-realisations"},
      {nonlinear_distortion, "nonlinear-distortion"},
      {elastic_drive, "elastic-drive"},
      {backlash, "backlash"},
      {robot_changed, "robot-changed"},
      {excluded_trial, "excluded-trial"},
      {excluded_window, "excluded-window"},
  });
}

/// Codes that changed since the version before: "was" in JSON, for one version.
[[nodiscard]] constexpr auto former_word_table(WarningCode) {
  using enum WarningCode;
  return std::to_array<Word<WarningCode>>({
      {held_out_fit_poor, "held-back-fit-poor"},
      {no_held_out_data, "no-held-back-data"},
  });
}

/// One thing that the user must know, what it means in words, and what to try.
struct Warning {
  WarningCode code;
  std::string message;
  std::string remedy;        ///< what to try next; "try" in JSON
  std::string was = {};      ///< code by which the last version said it, where that is another
  std::string channel = {};  ///< of the recording that it is about; "" if it is about none, or several
};

}  // namespace mbk
