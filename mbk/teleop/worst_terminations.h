#pragma once

#include <optional>
#include <span>

#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {

/// What makes a network oscillate that is not absolutely stable: the terminations with Re z ≥ −a at `port` and a
/// passive one at the other that let it grow most in a turn, among those of the frequencies; of those that grow by more
/// than 1 % in a radian, the slowest, which a sampled controller shows best.
///
/// At ω₀, with the z matrix after a is subtracted from z_ii, one port is closed by the reactance jX₂ that makes
/// R = Re(z₁₁ − z₁₂ z₂₁/(z₂₂ + jX₂)) lowest, which is a mass X₂/ω₀ or a spring −X₂ω₀. Where R < 0, the other is closed
/// by a mass and a spring together that cancel the imaginary part that is left. What goes round is then R alone, and
/// near jω₀ the loop has the root
///   σ ≈ −R / (dX/dω + m + k/ω₀²),   X the imaginary part that was cancelled
/// The more mass and spring, with the same reactance, the slower it grows and the nearer it stays to ω₀: they are taken
/// so large that the root lies right of the axis whatever dX/dω, and σ ≤ ω₀/50. Both ports are tried as the first. What
/// grows at another frequency too, more than half as fast, comes last.
/// @param sample_time  of the controllers [s], or 0 (Teleoperator::with_exact_delay)
/// @returns  none where no frequency shows R < 0, or the network has no z matrix
[[nodiscard]] std::optional<WorstTerminations> worst_terminations(const Teleoperator& teleoperator,
                                                                  std::span<const RadPerSec> frequencies,
                                                                  double sample_time, Port port = Port::one,
                                                                  double a = 0.0);

/// Frequencies in the bands in which a condition of the axis is violated, none above `highest`.
[[nodiscard]] std::vector<RadPerSec> violated_frequencies(const AbsoluteStability& stability, RadPerSec highest);

}  // namespace mbk::teleop
