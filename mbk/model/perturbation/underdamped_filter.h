#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"

namespace mbk::perturbation {

inline constexpr double kPublishedDampingRatio = 0.1;         ///< ζ     (Dyck 2013, below eq. 3.5)
inline constexpr RadPerSec kPublishedNaturalFrequency{15.0};  ///< ωₙ [s⁻¹]

/// G(s) = ωₙ² / (s² + 2ζωₙ s + ωₙ²) (Dyck 2013, eq. 3.5), solved exactly for constant input.
class UnderdampedFilter {
 public:
  /// @fails  ζ outside (0, 1); ωₙ ≤ 0 or not finite.
  [[nodiscard]] static Result<UnderdampedFilter> create(double damping_ratio = kPublishedDampingRatio,
                                                        RadPerSec natural_frequency = kPublishedNaturalFrequency);

  /// The output t ≥ 0 [s] after it was y₀, ẏ₀, with the input u constant since then. With d = y₀ − u,
  ///   y = u + e^{−ζωₙt} (d cos ω_d t + (ẏ₀ + ζωₙ d)/ω_d sin ω_d t),   ω_d = ωₙ √(1−ζ²).
  /// ÿ at t = 0 is that after the input has changed.
  /// @param value  y₀ [u]    @param rate  ẏ₀ [u/s]    @param input  u
  [[nodiscard]] Jet<double> response(double value, double rate, double input, double t) const;

  /// The highest frequency at which |G|² is one half: f = ωₙ/2π √(1 − 2ζ² + √((1 − 2ζ²)² + 1)).
  [[nodiscard]] Hertz bandwidth() const;

  /// |G(j2πf)|²
  [[nodiscard]] double power_gain(Hertz frequency) const;

 private:
  UnderdampedFilter(double damping_ratio, double natural_frequency);

  double damping_ratio_;
  double natural_frequency_;
  double decay_;   // ζωₙ
  double damped_;  // ω_d
};

}  // namespace mbk::perturbation
