#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/impulse_response_estimate.h"

namespace mbk {

/// Type of delayed response in the force.
enum class DelayedResponse {
  none,              ///< no predictor of the force
  reflex,            ///< responds to stretch in one direction
  both_directions,   ///< responds equally to motion in both directions: linear, no evidence of a reflex
  not_identifiable,  ///< too short or too poor a recording
};

[[nodiscard]] constexpr auto word_table(DelayedResponse) {
  using enum DelayedResponse;
  return std::to_array<Word<DelayedResponse>>({{none, "none"},
                                               {reflex, "reflex"},
                                               {both_directions, "both-directions"},
                                               {not_identifiable, "not-identifiable"}});
}

/// A direction of stretch, and how well velocity in it, rectified and delayed, predicts the force.
struct StretchCandidate {
  Vector direction;      ///< n, unit vector; empty: both directions alike
  double vaf = 0;        ///< [%], cross-validated on the rows that were fitted, mean over the axes
  double vaf_error = 0;  ///< [%], standard error of its difference from the selected one
};

/// Intrinsic and reflex part of the force of one axis.
struct PathShares {
  ExplainedForce intrinsic_alone;              ///< a limb without reflex, fitted alone
  ExplainedForce both;                         ///< the two paths together
  ExplainedForce intrinsic_path, reflex_path;  ///< each path alone; they overlap and need not add up
};

/// A value and half of its 95 % interval.
struct Margin {
  double value = 0, half_width = 0;
};

/// The reflex as a second-order low-pass with a delay, G ω²/(s² + 2ζωs + ω²) e^{−s d}, fitted to its response.
struct SecondOrderReflex {
  std::vector<Margin> gain;  ///< n, G [N·s/m]
  Margin delay;              ///< d [s]
  Margin frequency;          ///< ω/2π [Hz]
  Margin damping;            ///< ζ
  double p_value = 1;        ///< VAF of the response by this model
};

/// A muscle of the EMG path.
struct EmgMuscle {
  std::string channel;
  std::string unit;          ///< of its EMG: "MVC" or "mean", the mean of the recordings
  std::vector<Margin> gain;  ///< n, F_h at a steady EMG of 1 [N or N·m], −Σ k T over all lags; empty: not explained
};

/// Force that EMG explains, axis by axis.
struct EmgShares {
  ExplainedForce intrinsic_and_emg;  ///< fitted together, without the reflex path
  ExplainedForce all;                ///< with the reflex path; the same where there is none
  ExplainedForce emg_path;           ///< of `all`, alone
};

/// Share of the power of −F_h that linear responses explain, in bands: multiple coherence, corrected for what as many
/// signals without any relation explain, weighted by the power of the force.
struct CoherenceBand {
  double from_hz = 0, to_hz = 0;
  Vector motion, motion_and_emg;  ///< n, in [0, 1]
};

/// The rectified EMG e of muscles as a third path, −F_h(t) = … + Σ_m Σ_{0 ≤ l ≤ 0.5 s} k_m(l) e_m(t − l) T.
struct EmgPath {
  std::vector<EmgMuscle> muscles;  ///< m
  double memory = 0;               ///< last lag [s]
  bool explains = false;           ///< the force is predicted better with EMG
  std::string why;                 ///< in words
  double p_value = 1;              ///< of EMG that adds nothing to the other paths
  std::vector<EmgShares> shares;   ///< n
  std::vector<CoherenceBand> coherence;
};

/// Force as the sum of an intrinsic path, linear in motion, and a reflex path, which responds to stretch in one
/// direction after a delay:
///   −F_h(t) = Σ_l h(l) x(t − l) T + Σ_l g(l) N(v⁺(t − l)) T + c,   v⁺ = max(eᵀẋ, 0)
struct ParallelCascadeEstimate {
  int axes = 1;
  double sample_time = 0;    ///< T [s]
  bool instruments = false;  ///< the reference was used as instrument
  bool held_out = false;     ///< shares are for held-out rows
  DelayedResponse found = DelayedResponse::none;
  std::string why;                           ///< in words
  double p_value = 1;                        ///< p-value of equal responses to stretch in both directions
  double intrinsic_vaf = 0;                  ///< [%], cross-validated, without a delayed response
  std::vector<StretchCandidate> candidates;  ///< in decreasing order of vaf
  Vector intrinsic_lag;                      ///< [s]
  Matrix intrinsic, intrinsic_half_width;    ///< (2L+1)×n², as in ImpulseResponseEstimate
  // Only where a reflex was found:
  Vector direction;                      ///< e, n
  double delay = 0;                      ///< first lag with a visible response [s]
  double delay_low = 0, delay_high = 0;  ///< lags that the data do not exclude as the first [s]
  bool delay_at_limit = false;           ///< the earliest tried: the true value may be smaller
  double memory = 0;                     ///< last lag [s]
  Vector reflex_lag;                     ///< [s]
  Matrix reflex, reflex_half_width;      ///< lags×n, g [N/m]
  Index reflex_rank = 0;                 ///< directions kept
  std::vector<Margin> gain;        ///< n, Σ g T over all lags that were tried: force for a steady stretch [N·s/m]
  Margin gain_along;               ///< eᵀ gain: positive resists the stretch
  bool gain_identifiable = false;  ///< its interval is smaller than its value
  std::optional<SecondOrderReflex> second_order;  ///< absent where no such response could be fitted
  Vector nonlinearity;                            ///< N(v) = Σ c_k (v/s)^k, k = 1 …, with s = speed_scale
  double speed_scale = 1;                         ///< [m/s], the largest that was seen
  ResponseModel intrinsic_model;                  ///< M, B and K of the intrinsic path
  // Always:
  std::vector<PathShares> shares;  ///< n; without a reflex only the intrinsic path
  std::optional<EmgPath> emg;      ///< where muscles were named
};

}  // namespace mbk
