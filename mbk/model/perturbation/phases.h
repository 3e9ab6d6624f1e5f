#pragma once

#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/model/perturbation/multisine.h"

namespace mbk::perturbation {

/// The same lines with Schroeder's phases (1970, eq. 10): the instantaneous frequency sweeps once through the lines
/// and stays at each for a time that is proportional to its power pⱼ (Σ pⱼ = 1),
///   φᵢ = φᵢ₋₁ − 2π (kᵢ − kᵢ₋₁) Σ_{j<i} pⱼ,   φ₁ = π/2 (a cosine),   lines ascending.
/// Crest factor 1.92 for ten flat lines 1…10. For lines with gaps it is hardly better than random.
[[nodiscard]] Multisine with_schroeder_phases(const Multisine& signal);

struct LowCrestOptions {
  int starts = 20;  ///< the first from Schroeder's phases, the others from random ones; ≥ 1
  std::uint64_t seed = 1;
};

/// The same lines with phases of low crest factor: the smallest of all starts, each of which minimises
///   ‖r‖_p = (Σ_n |r(t_n)|^p)^{1/p},   p = 4, 8, 16, …, 1024 in turn,
/// by Levenberg–Marquardt on the residuals |r|^{p/2} at 16 samples to the period of the highest line, the last steps of
/// the best at 64 (Guillaume, Schoukens, Pintelon & Kollár 1991, IEEE Trans. Instrum. Meas. 40:982). For large p this
/// is the peak. The minimum is a local one; more starts may find a lower one. The same options give the same phases.
/// With the default options ten flat lines 1…10 have the crest factor 1.388, and {1, 4, 7, 10, 13, 16, 20, 23, 26, 29}
/// 1.700.
/// @fails  starts < 1; every amplitude is zero; a harmonic above 10 000, which would take too much memory.
[[nodiscard]] Result<Multisine> with_low_crest_phases(const Multisine& signal, const LowCrestOptions& options = {});

}  // namespace mbk::perturbation
