#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <vector>

#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/dsp/zero_phase.h"

/// Slow plain twins of the filters, in arithmetic of 64 bits and more. For the tests of this module only.
namespace mbk::dsp::twin {

using Real = long double;
using Signal = std::vector<Real>;

inline Signal signal_of(const Vector& values) {
  return {values.begin(), values.end()};
}

/// The polynomial's least squares by QR of the Vandermonde matrix on [−1, 1].
inline Signal weights_of(const SavitzkyGolay& filter, int derivative) {
  using MatrixL = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Index half = filter.half_window();
  MatrixL V(filter.window, filter.order + 1);
  for (Index i = 0; i < filter.window; ++i) {
    const Real t = static_cast<Real>(i - half) / static_cast<Real>(half);
    Real power = 1.0L;
    for (int k = 0; k <= filter.order; ++k, power *= t) V(i, k) = power;
  }
  Signal weights(static_cast<std::size_t>(filter.window), 0.0L);
  if (derivative > filter.order) return weights;
  const MatrixL inverse = V.householderQr().solve(MatrixL::Identity(filter.window, filter.window));
  Real factor = 1.0L;
  for (int k = 1; k <= derivative; ++k) factor *= static_cast<Real>(k) / static_cast<Real>(half);
  for (Index i = 0; i < filter.window; ++i) weights[static_cast<std::size_t>(i)] = factor * inverse(derivative, i);
  return weights;
}

inline Signal smoothed(const SavitzkyGolay& filter, int derivative, const Signal& signal, Hertz rate) {
  Signal weights = weights_of(filter, derivative), result;
  for (int d = 0; d < derivative; ++d) {
    for (Real& weight : weights) weight *= rate.value;
  }
  for (std::size_t i = 0; i + weights.size() <= signal.size(); ++i) {
    Real sum = 0.0L;
    for (std::size_t j = 0; j < weights.size(); ++j) sum += weights[j] * signal[i + j];
    result.push_back(sum);
  }
  return result;
}

/// One section after the other in direct form I, forward and backward, on an odd, even or constant extension.
inline Signal zero_phase(const SectionCascade& filter, const Signal& signal, const Padding& padding) {
  const std::size_t n = signal.size();
  const auto pad = static_cast<std::size_t>(padding.samples);
  const auto beyond = [&](Real end, Real inside) {
    if (padding.extension == Extension::odd) return 2.0L * end - inside;
    return padding.extension == Extension::even ? inside : end;
  };
  Signal x;
  for (std::size_t i = pad; i >= 1; --i) x.push_back(beyond(signal[0], signal[i]));
  x.insert(x.end(), signal.begin(), signal.end());
  for (std::size_t i = 1; i <= pad; ++i) x.push_back(beyond(signal[n - 1], signal[n - 1 - i]));
  const auto pass = [&] {
    for (const SecondOrderSection& s : filter) {
      const Real gain = (static_cast<Real>(s.b0) + s.b1 + s.b2) / (1.0L + s.a1 + s.a2);
      Real x1 = x[0], x2 = x[0], y1 = gain * x[0], y2 = y1;
      for (Real& value : x) {
        const Real y = s.b0 * value + s.b1 * x1 + s.b2 * x2 - s.a1 * y1 - s.a2 * y2;
        x2 = x1;
        x1 = value;
        y2 = y1;
        y1 = y;
        value = y;
      }
    }
  };
  pass();
  std::reverse(x.begin(), x.end());
  pass();
  std::reverse(x.begin(), x.end());
  return {x.begin() + static_cast<std::ptrdiff_t>(pad), x.end() - static_cast<std::ptrdiff_t>(pad)};
}

}  // namespace mbk::dsp::twin
