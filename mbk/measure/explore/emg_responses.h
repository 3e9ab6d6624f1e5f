#pragma once

#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/reference_onsets.h"
#include "mbk/model/trial/emg_estimate.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::explore {

struct EmgOptions {
  EmgProcessing processing;
  double background_s = 0.1;  ///< before an onset
  std::vector<double> edges_s = {0.02, 0.05, 0.1,
                                 0.15};    ///< of the windows after an onset; each ends where the next begins
  std::map<std::string, double> mvc = {};  ///< by channel, mean rectified EMG at maximal contraction [V]
};

/// Where a motion leaves a rest of `rest` samples or more, and the displacement to its largest in the 150 ms after.
/// It moves where the displacement over 10 ms is above a fifth of its maximum. The onset is where the displacement from
/// the mean of the rest passes a threshold (six standard deviations of the rest, at least 0.2 % of the displacement),
/// extrapolated backwards by the time that it takes from there to four times the threshold: exact for a constant
/// acceleration.
/// @param position N×n
[[nodiscard]] std::vector<Onset> motion_onsets(const Matrix& position, double sample_time, Index rest);

/// Onsets of perturbations in rows of a trial, of its reference or, if it has none, of its motion. The step is the
/// largest displacement of that signal in the 150 ms after the onset.
[[nodiscard]] std::vector<Onset> perturbation_onsets(const ExplorationTrial& trial, Index rest);

/// Amplitude and latency of one muscle's response.
struct EmgResponse {
  std::vector<EmgWindowResponse> windows;
  std::optional<EmgLatency> latency;
};

/// Response of one muscle to perturbations in one direction, from the rectified EMG of its trials (rows: samples from
/// background_s before the onset on, columns: trials; row of the onset: background_s/T).
///
/// Windows: ratio r = Σ_g w_g/Σ_g b_g of the means in the window and before the onset. The interval is that of the
/// bootstrap-t by trials of ln r (Efron & Tibshirani 1993, An Introduction to the Bootstrap, §12.5). There is a
/// response if the mean of w_g − b_g differs from 0 by Student's t at a level of 3 %/(number of windows): 1 % in each
/// of three.
///
/// Latency, of the first window with an increase: change points τ < σ of the trial mean m(t)
///   max over τ, σ of −Σ_t [ln μ(t) + m(t)/μ(t)],  μ = a₀ before τ, a₁ > a₀ to σ, a₂ ≤ a₁ after,
/// which is the likelihood of an amplitude-modulated noise whose standard deviation follows its mean (Staude & Wolf
/// 1999, Med Eng Phys 21:449), with τ from the onset to the end of that window and data to 10 ms after it. The
/// interval: 2.5 % and 97.5 % of τ in trials drawn with replacement, each τ anywhere between the two samples beside it.
/// A threshold of background plus some standard deviations detects late, by what the response needs to reach it; the
/// change point does not. Of a response that rises slowly it is the middle of the rise.
/// @param rectified N×G, G ≥ 5    @param seed  of the bootstrap
/// @fails data: fewer than 5 trials; no signal before the onset.
[[nodiscard]] Result<EmgResponse> emg_response(const Matrix& rectified, double sample_time, const EmgOptions& options,
                                               std::uint64_t seed);

/// A recording whose clock is even, and the onsets in it.
struct EmgRecording {
  const Recording* recording = nullptr;
  std::vector<Onset> onsets;  ///< in samples of the recording
};

/// Whether a channel is EMG: its name is emg or begins with emg_.
[[nodiscard]] bool is_emg(const Channel& channel);

/// "emg_biceps" of "biceps" and of itself.
[[nodiscard]] std::string emg_channel_of(const std::string& muscle);

/// Responses of all channels emg_* that all recordings have, with their epochs pooled. One channel at a time is
/// processed, so that only one is in memory beside the recordings. Directions differ by 15° or more. An onset is
/// omitted if the epoch is not within the recording or if the onset before it is less than an epoch away.
/// @fails usage: windows not rising. data: no recording has EMG; rates differ; fewer than 5 onsets in every direction.
/// As emg_processing_at.
[[nodiscard]] Result<EmgEstimate> emg_responses(std::span<const EmgRecording> recordings, double sample_time,
                                                const EmgOptions& options);

}  // namespace mbk::explore
