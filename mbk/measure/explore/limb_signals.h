#pragma once

#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::explore {

using numeric::RowRange;

/// Highest frequency at which a limb is looked at in the time domain [Hz].
inline constexpr double kResponseBand = 50.0;

/// Trials as impulse responses are fitted to them: freed of what is beyond the band, decimated, under each other.
struct LimbSignals {
  int axes = 1;
  double sample_time = 0;         ///< T [s] after decimation
  Index every = 1;                ///< samples of the recording per row
  Matrix position;                ///< N×n, x [m or rad], without its mean
  Matrix velocity, acceleration;  ///< N×n
  Matrix resistance;              ///< N×n, −F_h [N or N·m]
  Matrix explained;               ///< N×3n, [x ẋ ẍ] as the reference explains them; empty where it does not
  Matrix muscles;                 ///< N×m, rectified EMG behind the same low-pass; m = 0 where none was named
  std::vector<std::string> muscle_names, muscle_units;  ///< m, as in ExplorationTrial
  Vector explained_share;                ///< n, of the variance of x that the reference explains; empty without one
  std::vector<RowRange> pieces;          ///< rows without a break
  Index first_sample = 0;                ///< of each trial: the one of its first row
  std::vector<RowRange> identification;  ///< rows that are fitted
  std::vector<RowRange> validation;      ///< rows that are predicted; empty where nothing was held out
};

/// Motion, its derivatives and the force behind one low-pass (dsp::decimate), at the lowest rate at which it is flat
/// enough up to kResponseBand: every ⌊f_s/(2.5·50 Hz)⌋-th sample. Derivatives are those of the polynomial of degree 8
/// through nine samples, taken before. Twelve rows at each end of a trial,
/// which the low-pass makes of its own continuation, are dropped. Where a reference was recorded, the motion is
/// regressed on the reference from 1 s before to 0.05 s after, each half of the rows with the response of the other
/// half; what that explains stands for the motion without the noise of the loop, where it is at least half of the
/// variance of every axis.
/// @fails  no trial; trials of different axes or sample times; too few samples for the filters
[[nodiscard]] Result<LimbSignals> limb_signals(std::span<const ExplorationTrial> trials);

}  // namespace mbk::explore
