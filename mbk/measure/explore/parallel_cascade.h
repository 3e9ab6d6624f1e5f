#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"

namespace mbk::explore {

/// Intrinsic and reflex force in parallel (Kearney, Stein & Parameswaran 1997),
///   −F_h(t) = Σ_{|l| ≤ 40 ms} h(l) x(t − l) T + Σ_{l ≥ d} g(l) N(v⁺(t − l)) T + c,   v⁺ = max(eᵀẋ, 0)
/// Both responses are fitted together, which is where swapping between them ends; N is a polynomial, swapped with g.
/// By the data are chosen, on the rows that identify:
/// - the direction of stretch e (one axis: ±1; two: eight), the longest lag, up to 0.99 s, and the ranks: least
///   error in eight-fold cross-validation over consecutive rows;
/// - the delay d, from 40 to 200 ms: least BIC of the whitened residual, fitted with lags from d on;
/// - the order of N, up to 5: the lowest within one standard error of the least cross-validated error.
///
/// A reflex is found where stretch in one direction predicts the force better than no delayed response, by two standard
/// errors over the folds; better than stretch in the opposite direction, by as much and by a tenth of its error (an
/// even nonlinearity, such as the geometry of a limb of two links, answers both); better than motion in both directions
/// alike (a linear limb with a long memory); and where |eᵀẋ| adds to the latter, by an F test of the whitened rows at
/// 0.1 %, Bonferroni over axes and directions.
/// Where the signals have muscles, their EMG is a third path beside those that were found (emg_path.h); what is found
/// of the two does not depend on it.
/// @returns `not_identifiable` where there are fewer than ten rows for each coefficient
/// @fails  a force or motion that does not vary
[[nodiscard]] Result<ParallelCascadeEstimate> parallel_cascade(const LimbSignals& signals);

}  // namespace mbk::explore
