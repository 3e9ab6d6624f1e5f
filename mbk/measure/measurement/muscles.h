#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/emg_estimate.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// The schedule that is the co-contraction of the two muscles named.
inline constexpr const char* kCoContraction = "co-contraction";

/// Puts the rectified EMG of the muscles into a trial, whose rows are those of the recording from trial.from_s on. What
/// explore::check_emg finds becomes notes.
/// @param processing  band
/// @fails  data: a muscle that the recording lacks (its EMG channels are named); a channel that cannot be analysed; the
/// rate (explore::emg_processing_at)
[[nodiscard]] Result<void> add_muscles(const Recording& recording, const std::vector<std::string>& muscles,
                                       const EmgProcessing& processing, ExplorationTrial& trial);

/// Divides the EMG of all trials by the EMG of maximal contraction, or by its mean over the trials where none is known;
/// where the schedule is a muscle, its envelope becomes the schedule, where it is the co-contraction of two, the lesser
/// of both envelopes at each instant (Thoroughman & Shadmehr 1999, J Neurosci 19:8573).
/// @param mvc  by channel [V]
/// @param processing  envelope
/// Notes say where a muscle's mean differs several-fold between trials, and where the schedule changes with time.
/// @fails  usage: co-contraction of other than two muscles; a mean above 1.5 times that of maximal contraction. data:
/// two muscles of the same signal. As explore::emg_envelope
[[nodiscard]] Result<void> scale_muscles(std::span<ExplorationTrial> trials, const std::map<std::string, double>& mvc,
                                         const std::string& schedule, const EmgProcessing& processing);

}  // namespace mbk::measurement
