#pragma once

#include <optional>
#include <span>

#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Looks for a rhythm of the limb's own between 3 and 14 Hz: a line in the spectrum of the force, as recorded, that
/// stands five times above the spectrum on both sides of it (0.75 to 2 Hz away), where no axis' reference has one,
/// whose coherence with all of them is below one half, and that makes 8 % of the force. What a perturbation with a
/// broad spectrum makes has no such line, and neither has the resonance of limb and robot, which is wider.
/// @returns the clearest over axes and recordings; none where no reference is known, which could tell a perturbation
/// from a tremor, or where a recording is too short (16 s) or has gaps.
[[nodiscard]] std::optional<AssumptionTest> test_tremor(std::span<const Recording* const> recordings,
                                                        std::span<const PreparedTrial> trials);

/// Says of a tremor that it biases least squares; instrumental variables take it for noise, which it is to them.
void warn_of_tremor(const AssumptionTest& tremor, Identification& identification);

}  // namespace mbk::analyse
