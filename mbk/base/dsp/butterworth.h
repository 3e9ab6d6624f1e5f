#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"

namespace mbk::dsp {

/// One second-order section, H(z) = (b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²).
/// A first-order section has b2 = a2 = 0.
struct SecondOrderSection {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0;
  double a1 = 0.0, a2 = 0.0;

  /// H(1): what a constant is multiplied by.
  [[nodiscard]] double gain_at_zero() const { return (b0 + b1 + b2) / (1.0 + a1 + a2); }
};

/// A digital filter as a cascade; in this form a low cutoff costs no digits (in one numerator and denominator of
/// order five, 5 Hz at 1 kHz is only defined to 6e-7).
using SectionCascade = std::vector<SecondOrderSection>;

/// Butterworth low-pass filter by the bilinear transform with prewarping: |H(f_c)|² = 1/2, |H(0)| = 1.
///   analogue prototype  Π 1/(s² + 2 cos φ_k s + 1), φ_k = π(2k − 1)/(2n) for even, πk/n for odd order,
///   s → tan(π f_c/f_s)⁻¹ (1 − z⁻¹)/(1 + z⁻¹)
/// @fails order outside 1…20; cutoff not in (0, rate/2).
[[nodiscard]] Result<SectionCascade> butterworth_lowpass(int order, Hertz cutoff, Hertz sample_rate);

/// Butterworth high-pass filter: that low-pass with s → 1/s, which after the bilinear transform is the low-pass at
/// f_s/2 − f_c with z → −z; |H(f_c)|² = 1/2, |H(f_s/2)| = 1.
/// @fails as butterworth_lowpass
[[nodiscard]] Result<SectionCascade> butterworth_highpass(int order, Hertz cutoff, Hertz sample_rate);

/// |H(e^{jω})| of a cascade at one frequency.
[[nodiscard]] double gain(const SectionCascade& filter, Hertz frequency, Hertz sample_rate);

}  // namespace mbk::dsp
