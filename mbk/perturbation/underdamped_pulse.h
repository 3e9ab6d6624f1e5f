#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/core/result.h"
#include "mbk/core/units.h"
#include "mbk/perturbation/jet.h"
#include "mbk/perturbation/minimum_jerk.h"

namespace mbk::perturbation {

inline constexpr double kPublishedDampingRatio = 0.1;         ///< ζ     (Dyck 2013, below eq. 3.5)
inline constexpr RadPerSec kPublishedNaturalFrequency{15.0};  ///< ωₙ [s⁻¹]
inline constexpr double kPublishedPulseAmplitude = 0.005;     ///< steady displacement [m]

/// Response of G(s) = ωₙ² / (s² + 2ζωₙ s + ωₙ²) to a step of height A at t = 0, from rest (Dyck 2013, eq. 3.5):
///   r(t) = A [1 − e^{−ζωₙt} (cos ω_d t + ζ/√(1−ζ²) sin ω_d t)],   ω_d = ωₙ √(1−ζ²)
/// in the unit of A. Overshoots to A (1 + e^{−πζ/√(1−ζ²)}). Zero before t = 0; r̈ jumps to A ωₙ² at t = 0.
class UnderdampedPulse {
 public:
  /// @fails  ζ outside (0, 1); ωₙ ≤ 0; A not finite.
  [[nodiscard]] static Result<UnderdampedPulse> create(double amplitude, double damping_ratio = kPublishedDampingRatio,
                                                       RadPerSec natural_frequency = kPublishedNaturalFrequency);

  /// r, ṙ, r̈ at t [s] after the step.
  [[nodiscard]] Jet<double> at(double t) const;

 private:
  UnderdampedPulse(double amplitude, double damping_ratio, double natural_frequency);

  double amplitude_;
  double natural_frequency_;
  double decay_;   // ζωₙ
  double damped_;  // ω_d
  double skew_;    // ζ/√(1−ζ²)
};

/// A train of underdamped pulses in directions spaced evenly around a circle, each repeated, in random order and with
/// random durations and pauses (Dyck 2013, §3.4). After a pulse the hand returns to the start on a minimum-jerk path
/// that takes over position, velocity and acceleration, and rests there until the next one.
class PulseSchedule {
 public:
  struct Options {
    double amplitude = kPublishedPulseAmplitude;               ///< A [m], steady displacement; > 0
    double damping_ratio = kPublishedDampingRatio;             ///< ζ
    RadPerSec natural_frequency = kPublishedNaturalFrequency;  ///< ωₙ
    int directions = 8;              ///< evenly around the circle, the first along +x; 2 gives ±x
    int repetitions = 2;             ///< pulses in each direction
    double shortest_duration = 1.5;  ///< of a pulse, onset to offset [s]
    double longest_duration = 2.0;   ///< [s]
    double shortest_pause = 2.0;     ///< from the end of `quiet`, or from the previous offset, to the onset [s]
    double longest_pause = 7.0;      ///< [s]
    double return_duration = 1.0;    ///< of the way back, from the offset [s]; not above `shortest_pause`
    double quiet = 16.0;             ///< before the first pause [s]
    std::uint64_t seed = 1;
  };

  struct Pulse {
    double onset = 0.0;                        ///< [s]
    double offset = 0.0;                       ///< [s]; the way back begins
    int direction = 0;                         ///< 0 … directions − 1
    double angle = 0.0;                        ///< of the displacement from +x [rad]
    Eigen::Vector2d direction_B = {1.0, 0.0};  ///< unit vector of the displacement, base frame
  };

  /// @fails  a limit named at Options is not kept; a time is not finite or negative.
  [[nodiscard]] static Result<PulseSchedule> create(const Options& options);

  /// Displacement of the hand from the start, and its two derivatives, at t [s]; [m], base frame. Exactly zero
  /// between the end of a way back and the next onset.
  [[nodiscard]] Jet<Eigen::Vector2d> at(double t) const;

  /// The step behind the pulse: A·direction from onset up to offset, else exactly zero [m], base frame.
  [[nodiscard]] Eigen::Vector2d reference(double t) const;

  [[nodiscard]] const std::vector<Pulse>& pulses() const { return pulses_; }

 private:
  PulseSchedule(const Options& options, const UnderdampedPulse& shape) : options_(options), shape_(shape) {}
  [[nodiscard]] const Pulse* last_onset_before(double t) const;

  Options options_;
  UnderdampedPulse shape_;
  std::vector<Pulse> pulses_;  // in time order
};

}  // namespace mbk::perturbation
