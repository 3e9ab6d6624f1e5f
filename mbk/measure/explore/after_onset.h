#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/after_onset_estimate.h"
#include "mbk/model/trial/exploration_trial.h"

namespace mbk::explore {

/// M, B and K from the first `window_s` after the onsets of the reference (reference_onsets.h), before the person can
/// answer. Force and position pass a Savitzky–Golay filter of order 4 over 31 ms and no other; the mean of each signal
/// over the 100 ms before an onset is subtracted. With w_g(t) = [−ΔF_h, Δẍ, Δẋ, Δx] after onset g, whose step is u_g,
///   A = Σ_t Σ_{g≠h} u_gᵀ(Σ u uᵀ)⁻¹u_h w_g(t)ᵀ w_h(t),   H = Σ_t Σ_g w_g(t)ᵀ w_g(t),
///   θ = (A_zz − α H_zz)⁻¹ (A_zf − α H_zf)
/// for each force f: instrumental variables by what other onsets move at the same time, so that neither noise of the
/// position nor what the limb does on its own account is taken for mechanics, with α from the least root of |A − a H| =
/// 0 and Fuller's correction by 1/G (Hausman, Newey, Woutersen, Chao & Swanson 2012): where the response to the steps
/// hardly distinguishes M, B and K, the estimate stays finite and is biased towards least squares. The covariance is
/// the jackknife's over onsets (G − 1)/G Σ_g (θ₋g − θ)(θ₋g − θ)ᵀ, as onsets are independent and rows of one are not;
/// the intervals are those of Student's t with G/n − 1 degrees of freedom: each onset tells of one direction. The
/// handle mass, where all trials name the same, is subtracted from M.
/// @param window_s above twice the filter's window
/// @fails  usage: the window is too short. No trial has a reference; fewer than four onsets for each axis after which
/// the limb moved from rest; two axes, and all steps along one line.
[[nodiscard]] Result<AfterOnsetEstimate> after_onset(std::span<const ExplorationTrial> trials, double window_s);

}  // namespace mbk::explore
