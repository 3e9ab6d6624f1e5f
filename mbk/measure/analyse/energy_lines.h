#pragma once

#include <span>
#include <vector>

#include "mbk/model/trial/energy.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Energy that the limb absorbed at each line of a periodic perturbation, −∫ F_h·v dt of the Fourier components of
/// force and motion at its frequency, over the whole periods that the window holds, counted from its end; what the
/// perturbation takes to grow from rest is left out. The samples as recorded; no filter. The period is the shortest lag
/// at which the reference repeats itself to 1 % of its variance; lines are the harmonics that hold at least 0.5 % of
/// the variance of an axis of it. Intervals are Student's, from how the periods differ, at 95 % for all lines at once
/// (Bonferroni).
/// @param trials  one for each recording; several are periods of one experiment
/// @returns empty where there are no lines to speak of: no reference, pulses, a reference that does not repeat itself
/// three times, a clock with gaps, a value that is not a number, or recordings whose periods differ
[[nodiscard]] std::vector<EnergyLine> energy_lines(std::span<const Recording* const> recordings,
                                                   std::span<const PreparedTrial> trials);

}  // namespace mbk::analyse
