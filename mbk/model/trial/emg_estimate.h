#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/findings.h"

namespace mbk {

/// How EMG is processed.
struct EmgProcessing {
  double rate_hz = 0;
  double low_hz = 20.0, high_hz = 450.0;  ///< band: attenuation of 3 dB at both ends, forward and backward together
  int order = 4;                          ///< of both passes together, at each end of the band
  double envelope_hz = 50.0;              ///< zero-phase low-pass of the rectified signal; 0: moving RMS instead
  double envelope_rms_s = 0.0;            ///< window of the moving RMS; 0: low-pass
};

/// What may be wrong with a raw EMG channel.
enum class EmgProblem {
  not_finite,         ///< missing samples
  constant,           ///< no signal
  few_levels,         ///< the signal spans only a few steps of the converter
  clipping,           ///< the converter or amplifier is saturated
  mains_hum,          ///< 50 or 60 Hz and harmonics
  movement_artefact,  ///< slow motion of electrode and cable
  weak,               ///< far below the other channels
  rectified,          ///< not a raw signal
  artefact,           ///< the same deflection after each onset
  too_early,          ///< sooner than a reflex
};

[[nodiscard]] constexpr auto word_table(EmgProblem) {
  using enum EmgProblem;
  return std::to_array<Word<EmgProblem>>({{not_finite, "not-finite"},
                                          {constant, "constant"},
                                          {few_levels, "few-levels"},
                                          {clipping, "clipping"},
                                          {mains_hum, "mains-hum"},
                                          {movement_artefact, "movement-artefact"},
                                          {weak, "weak"},
                                          {rectified, "rectified"},
                                          {artefact, "artefact"},
                                          {too_early, "too-early"}});
}

/// A finding about a raw EMG channel.
struct EmgFinding {
  EmgProblem problem = EmgProblem::constant;
  std::string message;   ///< quantity, value and limit
  std::string remedy;    ///< what to try next
  bool usable = true;    ///< whether the channel can be analysed nevertheless
  int recording = 0;     ///< 0 for the first
  double frequency = 0;  ///< of the mains [Hz]; 0 for other problems
};

/// Mean rectified EMG in a window compared with the background.
enum class EmgChange { none, increase, decrease };

[[nodiscard]] constexpr auto word_table(EmgChange) {
  using enum EmgChange;
  return std::to_array<Word<EmgChange>>({{none, "none"}, {increase, "increase"}, {decrease, "decrease"}});
}

/// A window after the onset of a perturbation.
struct EmgWindow {
  std::string name;             ///< "short latency"
  double from_s = 0, to_s = 0;  ///< after the onset [s]
};

/// The response of one muscle in one window.
struct EmgWindowResponse {
  double ratio = 1;                      ///< mean rectified EMG over that of the background
  Interval interval95;                   ///< of the ratio, for this window alone
  EmgChange response = EmgChange::none;  ///< at a level of 5 % for all windows of this direction together
};

/// Onset of a response.
struct EmgLatency {
  double value = 0;     ///< after the onset of the perturbation [s]
  Interval interval95;  ///< [s]
};

/// One muscle after perturbations in one direction.
struct EmgDirectionResponse {
  Vector direction;       ///< n, unit vector
  Index trials = 0;       ///< perturbations used
  double background = 0;  ///< mean rectified EMG before the onset [V]
  Vector curve;           ///< trial mean of the envelope, at EmgEstimate::curve_time [V]
  std::vector<EmgWindowResponse> windows;
  std::optional<EmgLatency> latency;  ///< of the first increase; absent: no response, or none with a clear beginning
};

/// One EMG channel.
struct EmgChannelEstimate {
  std::string name;
  std::string unit;    ///< "V", or "" where the recording does not say: amplitudes below are then in its numbers
  bool usable = true;  ///< false: the channel was not analysed; the findings say why
  std::vector<EmgFinding> findings;
  double background = 0;                         ///< mean over all perturbations [V]
  std::optional<double> mvc;                     ///< mean rectified EMG of a maximal voluntary contraction [V]
  std::vector<EmgDirectionResponse> directions;  ///< in the order of EmgEstimate::directions
};

/// Directions of the perturbations.
struct EmgDirection {
  Vector direction;                  ///< n, unit vector
  Index trials = 0;                  ///< perturbations used
  double smallest = 0, largest = 0;  ///< size of the movement [m or rad]
};

/// EMG after the onsets of perturbations, without a model of the limb.
struct EmgEstimate {
  int axes = 1;
  EmgProcessing processing;
  std::string onset_rule;  ///< "reference" or "motion": where the onsets were found
  Index onsets = 0;        ///< used
  Index omitted = 0;       ///< too close to an end of the recording or to the perturbation before
  double background_s = 0.1;
  std::vector<EmgWindow> windows;
  std::vector<EmgDirection> directions;
  Vector curve_time;  ///< after the onset [s]
  std::vector<EmgChannelEstimate> channels;
  std::vector<std::string> notes;
};

}  // namespace mbk
