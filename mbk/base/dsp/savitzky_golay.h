#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"

namespace mbk::dsp {

/// A Savitzky–Golay filter: the polynomial of degree `order` that fits `window` consecutive samples best, evaluated
/// (value or derivative) at the window's centre (Savitzky & Golay 1964).
struct SavitzkyGolay {
  int order = 6;     ///< N ≥ 0, degree of the polynomial
  int window = 101;  ///< W, odd, > N

  /// Samples lost at each end, (W − 1)/2.
  [[nodiscard]] Index half_window() const { return (window - 1) / 2; }
};

/// The weights of one filter, twice.
struct SavitzkyGolayWeights {
  Vector samples;  ///< W of them, oldest sample first
  Vector powers;   ///< c, N + 1: the weight of sample j from the centre is Σ_m c_m jᵐ
};

/// Weights w, so that Σ_i w_i x_i is the derivative of order `derivative` at the centre, in units of x per sampleᵈ.
///   w_i = Σ_k p_k(t_i) p_k^(d)(0) / ‖p_k‖²
/// with the monic polynomials p_k that are orthogonal on the window (Gram polynomials), by their three-term
/// recursion on an abscissa scaled to [−1, 1]: no matrix is inverted, and the weights are exact to rounding at any
/// usable window.
/// @fails W even, W ≤ N, N < 0, derivative < 0.
[[nodiscard]] Result<SavitzkyGolayWeights> savitzky_golay_polynomial(const SavitzkyGolay& filter, int derivative);

/// Their samples alone.
[[nodiscard]] Result<Vector> savitzky_golay_weights(const SavitzkyGolay& filter, int derivative);

/// Applies the filter wherever the whole window is inside the signal.
/// @param signals N×n, one per column    @returns (N − W + 1)×n; row i belongs to sample i + (W − 1)/2, in units of
/// the signal per second^derivative.   @fails as the weights; fewer samples than the window.
[[nodiscard]] Result<Matrix> savitzky_golay(const SavitzkyGolay& filter, int derivative, const Matrix& signals,
                                            Hertz sample_rate);

/// |H(f)| at each frequency, in 1/s^derivative.
[[nodiscard]] Result<Vector> savitzky_golay_response(const SavitzkyGolay& filter, int derivative,
                                                     const Vector& frequency_hz, Hertz sample_rate);

/// |H(f)| of the smoothing filter (derivative 0), or that of the derivative divided by (2πf)ᵈ, the ideal one.
[[nodiscard]] Result<double> savitzky_golay_gain(const SavitzkyGolay& filter, int derivative, Hertz frequency,
                                                 Hertz sample_rate);

/// The frequency at which the smoothing filter's gain is 1/√2, to 1e-9 relative by bisection.
[[nodiscard]] Result<Hertz> savitzky_golay_cutoff(const SavitzkyGolay& filter, Hertz sample_rate);

/// The shortest window of that order whose −3 dB frequency does not exceed `cutoff`, within 5 %, by Schafer's estimate
/// f_c ≈ (N + 1)/(3.2 m − 4.6) of Nyquist with W = 2m + 1 (Schafer 2011; eq. 3.6 of Dyck 2013 misprints it),
/// and at least the shortest window that smooths at all, N + 3 made odd.
[[nodiscard]] int savitzky_golay_window(int order, Hertz cutoff, Hertz sample_rate);

}  // namespace mbk::dsp
