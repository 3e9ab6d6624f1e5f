#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/stretch_estimate.h"

namespace mbk::explore {

/// Adds to each direction the muscles, channels emg_* that all recordings have: onsets of EMG in single stretches and
/// the tonic stretch reflex threshold. Nothing changes without EMG.
///
/// Onset: EMG in the band (emg.h), as mean squares over 50 ms, every 25 ms, from where the limb leaves rest to where it
/// comes to rest. The background is the mean square of the rest before, 200 to 500 ms. There is an onset at the first
/// 50 ms that exceed it in an F test, and of which each half exceeds it at 5 %, so that a spike is none. The level of
/// the F test is 5 % over all windows of all stretches of the muscle in both directions. Its degrees of freedom are
/// those of the variation of the mean squares of windows and rests, within and between the rests of the direction
/// (upper limit of their variance, 95 %), so that EMG that is unsteady at rest needs a larger rise.
/// Where it begins: change points of the amplitude, b before, rising along a line in time to a + b, constant after,
///   max over both and a of −Σ_t [ln s(t)² + p(t)/s(t)²],
/// s the amplitude and p the mean square: the likelihood of an amplitude-modulated noise (Staude & Wolf 1999, Med Eng
/// Phys 21:449). A threshold detects a reflex late that grows with the angle; the change point does not.
/// Threshold λ: the position at the onset regressed on the speed over single stretches, at speed 0 (Levin & Feldman
/// 1994, Brain Res 657:23; Calota, Feldman & Levin 2008, Clin Neurophysiol 119:2329). The latency of the reflex adds
/// latency times speed to the position: it changes the slope, not λ. A speed counts if at least nine in ten of its
/// stretches have an onset, at least 50 ms after the velocity has become constant: otherwise the end of the range hides
/// the late ones, or the start the early ones. Three such speeds are needed. The interval is Student's, by the scatter
/// at each speed (Welch–Satterthwaite), or about the line where a speed was not repeated.
/// @param recordings  with an even clock, whole, of the trials that `found` is from, at their rates
/// @fails  as emg_band
[[nodiscard]] Result<void> add_stretch_muscles(std::span<const Recording* const> recordings,
                                               std::span<const ExplorationTrial> trials, StretchEstimate& found);

}  // namespace mbk::explore
