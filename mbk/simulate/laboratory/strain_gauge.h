#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/base/dsp/causal_filter.h"
#include "mbk/simulate/laboratory/analogue_converter.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// The strain-gauge sensor (Dyck 2013, appendix E): a bending beam, so that its voltage follows force times lever arm.
/// Voltages are at the converter, after amplifier and level shifter.
struct StrainGaugeOptions {
  Eigen::Vector2d slope = {-8.56, -8.15};  ///< a [N/V] ≠ 0, found with the calibration's lever arm (eq. E.2)
  Eigen::Vector2d offset = {0.54, 2.3};    ///< b [N]: the force that eq. E.2 gives for 0 V
  double calibration_arm = 0.0688;         ///< L₀ from gauges to force during the calibration [m] > 0
  double arm = 0.0688;                     ///< L, true lever arm of the hand force [m] > 0
  Eigen::Vector2d crosstalk = {0.0, 0.0};  ///< crosstalk of y on x, and of x on y [N/N]; measured below 0.5 N in 20 N
  double bridge_noise = 1.66e-4;  ///< density of white noise before the filter [V/√Hz] ≥ 0: 0.01 N rms behind
  Hertz cutoff{48.2};             ///< of the anti-aliasing filter ≥ 0; 0 for none
  int filter_order = 4;           ///< two Sallen–Key stages, here as a Butterworth filter; 1 … 20
  int converter_bits = 12;        ///< 0 for no converter, else 2 … 24
  double converter_range = 10.0;  ///< ± [V] > 0

  /// Assumed values, if different from the true ones: the lever arm L̂ [m] > 0, and the offset b̂ [N].
  double assumed_arm = 0.0688;
  Eigen::Vector2d assumed_offset = {0.54, 2.3};
};

/// From force to force through the whole chain, each axis i, in the sensor's axes:
///   V = V₀ + (L/L₀)(f + crosstalk)/a,   V₀ = −b/a,
///   then white noise, the anti-aliasing filter and the converter,
///   f_read = (L₀/L̂) a (V − V̂₀),   V̂₀ = −b̂/a                               (Dyck 2013, eqs. E.1–E.3)
/// The lever arm scales only the slope; the voltage V₀ of no force does not depend on it. With 12 bits and ±10 V, one
/// step is 4.88 mV, so 0.042 N in x (0.012 N rms, as the noise). The filter is the bilinear image of the
/// analogue one, exact at its −3 dB; it delays slow forces by `delay()`, 8.6 ms by default. It is settled at the first
/// reading.
class StrainGauge {
 public:
  /// @fails  usage: a slope is zero; an arm or the range is not above zero; crosstalk is not within ±1; noise is
  ///         negative; the converter bits are not 0 or 2 … 24; order outside 1 … 20; the cutoff is not below Nyquist; a
  ///         number is not finite.
  [[nodiscard]] static Result<StrainGauge> create(const StrainGaugeOptions& options, double sample_time,
                                                  std::uint64_t seed);

  /// f_read for the next sample [N].
  Eigen::Vector2d read(const Eigen::Vector2d& force) noexcept;

  /// Error of the next reading, f_read − f [N].
  Eigen::Vector2d added(const Eigen::Vector2d& force) noexcept { return read(force) - force; }

  /// Number of samples so far with an axis outside the converter range.
  [[nodiscard]] std::int64_t clipped_samples() const { return clipped_; }

  /// Delay of slow forces [s].
  [[nodiscard]] double delay() const { return delay_; }

 private:
  StrainGauge(const StrainGaugeOptions& options, const dsp::SectionCascade& filter, double sample_time,
              std::uint64_t seed);

  static WhiteNoise noise(const StrainGaugeOptions& options, double sample_time, std::uint64_t seed,
                          std::uint32_t axis);

  Eigen::Vector2d zero_voltage_, voltage_per_force_, crosstalk_;  // what is
  Eigen::Vector2d assumed_zero_voltage_, force_per_voltage_;      // what its user believes
  double delay_;
  AnalogueConverter converter_;
  std::array<WhiteNoise, 2> noise_;
  std::array<dsp::CausalFilter, 2> filters_;
  bool settled_ = false;
  std::int64_t clipped_ = 0;
};

}  // namespace mbk::laboratory
