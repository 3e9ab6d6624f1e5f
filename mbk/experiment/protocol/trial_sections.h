#pragma once

#include "mbk/base/config/document.h"
#include "mbk/base/core/words.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/experiment/protocol/trial_plan.h"

namespace mbk::protocol {

/// The sections that scenarios and experiments share. What is wrong in one is an error of its document, with file,
/// line, key, value and what is allowed.

enum class Machine { planar, one_axis, space, joint };

[[nodiscard]] constexpr auto word_table(Machine) {
  using enum Machine;
  return std::to_array<Word<Machine>>({{planar, "planar"}, {one_axis, "one_axis"}, {space, "space"}, {joint, "joint"}});
}

/// `kind` of [robot]; planar if absent.
[[nodiscard]] Machine read_machine(const config::Section& robot);

/// What [recording] says of a trial: condition, rate, seed, readers. All else stays as it is by itself.
[[nodiscard]] TrialPlan read_recording(const config::Section& section);

/// [control] of a planar robot.
[[nodiscard]] control::Mode read_control(const config::Section& section);

/// [perturbation]; the unit of a size says what is commanded: peak_deg, peak_mm, peak_N.
[[nodiscard]] perturbation::Plan read_perturbation(const config::Section& section, Machine machine);

}  // namespace mbk::protocol
