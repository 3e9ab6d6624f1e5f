#pragma once

#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/perturbation/jet.h"

namespace mbk::perturbation {

/// Sum of sines on harmonics of one base period,
///   r(t) = Σ aᵢ sin(2π kᵢ t/T + φᵢ)
/// in the unit of the amplitudes. Its derivatives are exact.
class Multisine {
 public:
  static constexpr int kHighestHarmonic = 100'000;

  struct Line {
    int harmonic = 1;        ///< 0 < k ≤ kHighestHarmonic: the frequency is k/T
    double amplitude = 0.0;  ///< a [u]
    double phase = 0.0;      ///< φ [rad]
  };

  /// @param period  T [s]
  /// @fails  T ≤ 0; no lines; k < 1 or above kHighestHarmonic; a repeated harmonic; a value is not finite.
  [[nodiscard]] static Result<Multisine> create(double period, std::vector<Line> lines);

  /// Phases uniform on [0, 2π), drawn in the order of the harmonics from the given stream of the seed.
  /// @fails  harmonics and amplitudes differ in number; as `create`.
  [[nodiscard]] static Result<Multisine> with_random_phases(double period, const std::vector<int>& harmonics,
                                                            const std::vector<double>& amplitudes, std::uint64_t seed,
                                                            std::uint32_t stream = 0);

  /// r, ṙ, r̈ at t [s], any finite t.
  [[nodiscard]] Jet<double> at(double t) const;

  /// √(Σ aᵢ²/2), over whole periods.
  [[nodiscard]] double root_mean_square() const;

  /// Largest |r| of the continuous signal: found on 64 samples to the period of the highest line, which miss at most
  /// 0.12 % of it (Bernstein: |r̈| ≤ ω² max|r|), then refined.
  [[nodiscard]] double peak() const;

  /// Peak over root mean square; √2 for one line.   Zero where every amplitude is zero.
  [[nodiscard]] double crest_factor() const;

  /// The same signal times a factor.
  [[nodiscard]] Multisine scaled(double factor) const;

  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }

 private:
  /// A line as `at` takes it, one after another by harmonic: e^(jωt) is that of the line before times e^(2πj t/T)^rise.
  struct Step {
    int rise = 0;
    double omega = 0.0;                  ///< [rad/s]
    double in_phase = 0.0, ahead = 0.0;  ///< a cos φ, a sin φ [u]
  };

  Multisine(double period, std::vector<Line> lines);

  double period_;
  std::vector<Line> lines_;
  std::vector<Step> steps_;
};

}  // namespace mbk::perturbation
