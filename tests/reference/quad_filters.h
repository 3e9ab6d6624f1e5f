#pragma once

#include <vector>

/// The published filters in 113-bit arithmetic, each written down as plainly as its definition. Slow on purpose.
namespace mbk::reference {

__extension__ using Quad = __float128;
using Signal = std::vector<Quad>;

/// Weights w[−h … h], h = (window − 1)/2, of the Savitzky–Golay filter: Σ_j w[j] y[c + j] is the derivative of the
/// given order, at its centre, of the polynomial fitted to the window by least squares. From the normal equations
/// (AᵀA) q = e_d d!/(hT)^d, w = A q, A_jk = (j/h)^k.
/// @param window  odd, > order    @param T  sample time [s]
[[nodiscard]] Signal savitzky_golay_weights(int order, int window, int derivative, Quad T);

/// Low-pass filter y[n] = Σ b_k x[n−k] − Σ_{k≥1} a_k y[n−k], a₀ = 1, both of length order + 1.
struct Filter {
  Signal b;
  Signal a;
};

/// Butterworth low-pass filter of the order given, bilinear with its cutoff prewarped: |H| = 1/√2 at `cutoff_hz`.
/// @param order  odd    @param cutoff_hz  below rate_hz/2
[[nodiscard]] Filter butterworth(int order, Quad cutoff_hz, Quad rate_hz);

/// |H|² at a frequency: the gain of the filter applied forward and backward.
[[nodiscard]] Quad squared_gain(const Filter& filter, Quad frequency_hz, Quad rate_hz);

/// The filter forward and backward over a signal extended at both ends by its odd reflection of 3·order samples;
/// each pass starts in the steady state of its first sample.
/// @param signal  longer than 3·order
[[nodiscard]] Signal zero_phase(const Filter& filter, const Signal& signal);

/// argmin_P ‖Z P − Y‖ for every column of Y, by Householder reflections. Columns are contiguous.
/// @param Z, Y  columns of equal length, at least as long as Z has columns; Z of full rank
/// @returns one column of coefficients for each column of Y
[[nodiscard]] std::vector<Signal> least_squares(std::vector<Signal> Z, std::vector<Signal> Y);

}  // namespace mbk::reference
