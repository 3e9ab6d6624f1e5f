#include "mbk/base/dsp/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/dsp/complex_transform.h"
namespace mbk::dsp {

namespace {

bool is_fast(Index n) {
  for (const Index factor : {2, 3, 5}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

Index fast_length_below(Index n) {
  while (n > 1 && !is_fast(n)) --n;
  return n;
}

Index fast_length_above(Index n) {
  Index length = std::max<Index>(2, n + n % 2);
  while (!is_fast(length)) length += 2;
  return length;
}

Index segment_length(Hertz sample_rate, Hertz resolution, Index longest) {
  const auto requested = static_cast<Index>(std::min(sample_rate.value / resolution.value, 1e9));
  return 2 * fast_length_below(std::min(std::max<Index>(requested, 8), longest) / 2);
}

Vector hann_window(Index length) {
  Vector window(length);
  for (Index i = 0; i <= length / 2; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
  }
  for (Index i = length / 2 + 1; i < length; ++i) window[i] = window[length - i];
  return window;
}

Result<Spectrum> welch(const Eigen::Ref<const Vector>& signal, Hertz sample_rate, Hertz resolution) {
  if (!(sample_rate.value > 0.0 && resolution.value > 0.0)) {
    return bad_usage(fmt::format("sample rate {:g} Hz and resolution {:g} Hz must be positive", sample_rate.value,
                                 resolution.value));
  }
  if (signal.size() < 8) return bad_data(fmt::format("{} samples are too few for a spectrum", signal.size()));
  const Index length = segment_length(sample_rate, resolution, signal.size());
  const Vector window = hann_window(length);
  const Index lines = length / 2 + 1;
  ComplexTransform transform(length);
  Vector both = Vector::Zero(length);
  Index pieces = 0;
  for (Index start = 0; start + length <= signal.size(); start += length / 2, ++pieces) {
    // Two pieces at a time, as real and imaginary part: |A_k|² + |B_k|² = (|Z_k|² + |Z_{n−k}|²)/2.
    Vector& to = pieces % 2 == 0 ? transform.real() : transform.imaginary();
    const auto piece = signal.segment(start, length);
    to = (piece.array() - piece.mean()) * window.array();
    const bool last = start + length / 2 + length > signal.size();
    if (pieces % 2 == 0 && !last) continue;
    if (pieces % 2 == 0) transform.imaginary().setZero();
    transform.run();
    both += transform.real().cwiseAbs2() + transform.imaginary().cwiseAbs2();
  }
  Vector power = both.head(lines);
  power.segment(1, lines - 2) = 0.5 * (power.segment(1, lines - 2) + both.tail(lines - 2).reverse());
  power *= 1.0 / (sample_rate.value * window.squaredNorm() * static_cast<double>(pieces));
  power.segment(1, lines - 2) *= 2.0;
  const double spacing = sample_rate.value / static_cast<double>(length);
  return Spectrum{Vector::LinSpaced(lines, 0.0, spacing * static_cast<double>(lines - 1)), power};
}

Hertz power_quantile(const Spectrum& spectrum, double fraction, Hertz limit) {
  Index lines = 0;
  while (lines < spectrum.frequency.size() && spectrum.frequency[lines] <= limit.value) ++lines;
  if (lines == 0) return Hertz(0.0);
  const double target = fraction * spectrum.density.head(lines).sum();
  double sum = 0.0;
  for (Index i = 0; i < lines; ++i) {
    sum += spectrum.density[i];
    if (sum >= target) return Hertz(spectrum.frequency[i]);
  }
  return Hertz(spectrum.frequency[lines - 1]);
}

}  // namespace mbk::dsp
