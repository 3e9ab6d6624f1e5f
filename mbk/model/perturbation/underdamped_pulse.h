#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"
#include "mbk/model/perturbation/underdamped_filter.h"

namespace mbk::perturbation {

inline constexpr double kPublishedPulseAmplitude = 0.005;  ///< steady displacement [m] (Dyck 2013, §3.4)
inline constexpr double kPublishedPulseForce = 2.0;        ///< steady force [N] (Dyck 2013, §4.1)

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

  [[nodiscard]] const UnderdampedFilter& filter() const { return filter_; }

 private:
  UnderdampedPulse(double amplitude, const UnderdampedFilter& filter) : amplitude_(amplitude), filter_(filter) {}

  double amplitude_;
  UnderdampedFilter filter_;
};

/// A train of underdamped pulses in directions spaced evenly around a circle, or in space along all combinations of −1,
/// 0 and 1, each repeated, in random order and with random durations and pauses (Dyck 2013, §3.4 and §4.1). After a
/// pulse the signal returns to zero on a minimum-jerk path that takes over value, velocity and acceleration, and rests
/// there until the next one. It is a displacement of the hand or a force on it, depending on the unit of the amplitude.
class PulseSchedule {
 public:
  static constexpr int kMaxPulses = 10000;

  struct Options {
    double amplitude = kPublishedPulseAmplitude;               ///< A [m or N], steady value; > 0
    double damping_ratio = kPublishedDampingRatio;             ///< ζ
    RadPerSec natural_frequency = kPublishedNaturalFrequency;  ///< ωₙ
    int axes = 2;                    ///< 2, or 3: in space, with 26 directions whatever `directions` says
    int directions = 8;              ///< evenly around the circle, the first along +x; 2 gives ±x
    int repetitions = 2;             ///< pulses in each direction; at most kMaxPulses in all
    double shortest_duration = 1.5;  ///< of a pulse, onset to offset [s]
    double longest_duration = 2.0;   ///< [s]
    double shortest_pause = 2.0;     ///< from the end of `quiet`, or from the previous offset, to the onset [s]
    double longest_pause = 7.0;      ///< [s]
    double return_duration = 1.0;    ///< duration of the return, from the offset [s]; not above `shortest_pause`
    double quiet = 16.0;             ///< before the first pause [s]
    std::uint64_t seed = 1;
  };

  struct Pulse {
    double onset = 0.0;      ///< [s]
    double offset = 0.0;     ///< [s]; start of the return
    int direction = 0;       ///< 0 … directions − 1
    double angle = 0.0;      ///< of the pulse from +x, in space of its projection on the xy plane [rad]
    AxesVector direction_B;  ///< unit vector of the pulse, base frame
  };

  /// @fails  a limit stated in Options is violated; a time is not finite or negative.
  [[nodiscard]] static Result<PulseSchedule> create(const Options& options);

  /// Displacement or force and its two derivatives, at t [s]; [m or N], base frame. Exactly zero between the end of a
  /// return and the next onset.
  [[nodiscard]] Jet<AxesVector> at(double t) const;

  /// The step behind the pulse: A·direction from onset up to offset, else exactly zero [m or N], base frame.
  [[nodiscard]] AxesVector reference(double t) const;

  [[nodiscard]] const std::vector<Pulse>& pulses() const { return pulses_; }
  [[nodiscard]] const Options& options() const { return options_; }

  /// −3 dB of G, the excited band of an onset; the spectrum of its velocity is A G(j2πf).
  [[nodiscard]] Hertz bandwidth() const { return shape_.filter().bandwidth(); }

 private:
  PulseSchedule(const Options& options, const UnderdampedPulse& shape) : options_(options), shape_(shape) {}
  [[nodiscard]] const Pulse* last_onset_before(double t) const;

  Options options_;
  UnderdampedPulse shape_;
  std::vector<Pulse> pulses_;  // in time order
};

}  // namespace mbk::perturbation
