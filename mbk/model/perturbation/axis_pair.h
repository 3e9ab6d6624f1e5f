#pragma once

#include <array>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/perturbation/multisine.h"

namespace mbk::perturbation {

/// Two axes that move at the same time. Over whole periods they are uncorrelated at every delay exactly where no line
/// of one is a line of the other.
struct AxisPair {
  Multisine first;
  Multisine second;

  /// Both axes times a factor.
  [[nodiscard]] AxisPair scaled(double factor) const { return {first.scaled(factor), second.scaled(factor)}; }
};

/// Largest √(r₁² + r₂²) of the continuous signal over one common period.
/// @fails  the periods differ.
[[nodiscard]] Result<double> peak_norm(const AxisPair& pair);

/// One experiment: the lines, in ascending order, go to the axes in turn (first, second, first, …), so that the axes
/// are uncorrelated over every whole period. Each axis is measured at its own lines; amplitudes and phases stay, and
/// `with_low_crest_phases` may follow on each axis.
/// @fails  fewer than two lines.
[[nodiscard]] Result<AxisPair> interleaved(const Multisine& signal);

/// Two experiments of all lines on both axes: (r₁, r₂) and then (r₁, −r₂). At each line the spectra of the two
/// experiments form
///   U(k) = diag(R₁(k), R₂(k)) [1 1; 1 −1],   U Uᴴ = 2 diag(|R₁|², |R₂|²),
/// a Hadamard matrix: over both together, in whole periods, the axes are uncorrelated at every delay, and the two
/// columns of a frequency response come out with equal and smallest variance (Dobrowiecki & Schoukens 2007; Guillaume,
/// Pintelon & Schoukens 1996). In either experiment alone they are correlated.
/// @fails  periods or harmonics of the axes differ.
[[nodiscard]] Result<std::array<AxisPair, 2>> hadamard_experiments(const Multisine& first, const Multisine& second);

}  // namespace mbk::perturbation
