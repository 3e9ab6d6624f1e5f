#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/after_onset_estimate.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::explore {

/// M, B and K from the first `window_s` after the onsets of the reference (reference_onsets.h), before the person can
/// answer. Force and position pass a Savitzky–Golay filter of order 4 over 31 ms and no other; the mean of each signal
/// over the 100 ms before an onset is subtracted, and the rows of all onsets are pooled:
///   θ = (RᵀZ)⁻¹RᵀY,   Z = [Δẍ Δẋ Δx], Y = −ΔF_h,
/// with instruments R that are what the steps u of the other onsets move at the same time after them,
/// R_g(t) = Ĥ₋g(t) u_g, Ĥ₋g = Σ Z_h(t) u_hᵀ (Σ u_h u_hᵀ)⁻¹ over h ≠ g: neither noise of the position nor what the limb
/// does on its own account is taken for mechanics. The covariance is the jackknife's over onsets
/// (G − 1)/G Σ_g (θ₋g − θ)(θ₋g − θ)ᵀ, as onsets are independent and rows of one are not; the intervals are those of
/// Student's t with G/n − 1 degrees of freedom: each onset tells of one direction.
/// The handle mass, where all trials name the same, is subtracted from M.
/// @param window_s above twice the filter's window
/// @fails  usage: the window is too short. No trial has a reference; fewer than four onsets for each axis after which
/// the limb moved from rest; two axes, and all steps along one line.
[[nodiscard]] Result<AfterOnsetEstimate> after_onset(std::span<const ExplorationTrial> trials, double window_s);

}  // namespace mbk::explore
