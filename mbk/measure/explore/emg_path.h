#pragma once

#include <vector>

#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"

namespace mbk::explore {

/// Columns of a path that was fitted before, and what the reference explains of them (the same, where there is none).
struct PathColumns {
  Matrix measured, explained;  ///< rows that identify ×r, centred
  Matrix judged;               ///< rows that judge ×r
};

/// The rectified EMG of muscles as a third path beside the intrinsic one and the reflex,
///   −F_h(t) = … + Σ_m Σ_{0 ≤ l ≤ 0.5 s} k_m(l) e_m(t − l) T
/// A muscle's force lasts about 0.3 s after its activity (Milner-Brown, Stein & Yemm 1973, J Physiol 228:285). EMG is
/// its own instrument: noise of the force that returns to the muscles through the motion is taken to be small.
///
/// EMG explains where the paths together predict the force better than without it by two standard errors in eight-fold
/// cross-validation, which also chooses the directions that are kept, and where the chance of EMG that adds nothing is
/// below 0.1 %: an F test of whitened rows with the EMG summed over 100 ms, Bonferroni over the axes. It does not where
/// the EMG of the 0.5 s after predicts better than that of the 0.5 s before, by two standard errors: it follows the
/// force. Changes slower than 20 s are removed from all signals: force drifts, and EMG grows with fatigue. Gains are
/// given where EMG explains, of F_h; they are those of the EMG that was measured, a noisy measure of activity.
///
/// The coherence bands use segments of 2 s of all rows, freed of changes slower than 3 s. Of K independent segments and
/// q unrelated signals γ² is q/K on average; 1 − (1 − γ²) K/(K − q) is given, 0 at the least.
/// @param rows    those that identify; 0.5 s of their piece stand before each
/// @param judged  those that judge, likewise
/// @param reflex  without columns where there is none
/// @returns `explains` false with a reason where there are fewer than ten rows for each coefficient
[[nodiscard]] EmgPath emg_path(const LimbSignals& signals, const std::vector<RowRange>& rows,
                               const std::vector<RowRange>& judged, const PathColumns& intrinsic,
                               const PathColumns& reflex);

}  // namespace mbk::explore
