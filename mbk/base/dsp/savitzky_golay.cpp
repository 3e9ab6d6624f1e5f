#include "mbk/base/dsp/savitzky_golay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/base/core/vector4.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors are passed between functions that are inlined always
#endif

namespace mbk::dsp {
namespace {

Result<void> check(const SavitzkyGolay& filter, int derivative) {
  if (filter.order < 0 || derivative < 0) {
    return bad_usage(
        fmt::format("Savitzky–Golay order {} and derivative {} must not be negative", filter.order, derivative));
  }
  if (filter.window <= filter.order) {
    return bad_usage(
        fmt::format("Savitzky–Golay window {} is not larger than the order, {}", filter.window, filter.order),
        "choose a larger, odd --sg-window");
  }
  if (filter.window % 2 == 0) {
    return bad_usage(fmt::format("Savitzky–Golay window {} is not odd", filter.window), "choose an odd --sg-window");
  }
  return {};
}

/// out[i] = Σ_k w[k] x[i + k], k = 0…W−1. The weights are even or odd about the centre, so that each is used twice;
/// sixteen running sums stay in registers. Any number of lanes gives the same to the last digit.
[[gnu::always_inline]] inline void correlate_body(const Vector& weights, double sign, const double* x, double* out,
                                                  Index count) {
  constexpr Index kVectors = 4, kAtOnce = 4 * kVectors;
  const Index half = weights.size() / 2;
  const double* const w = weights.data();
  Index i = 0;
  for (; i + kAtOnce <= count; i += kAtOnce) {
    Vector4 sum[kVectors];
    for (Index v = 0; v < kVectors; ++v) sum[v] = w[half] * four(x + i + half + 4 * v);
    for (Index k = 0; k < half; ++k) {
      const double* const older = x + i + k;
      const double* const newer = x + i + 2 * half - k;
      for (Index v = 0; v < kVectors; ++v) sum[v] += w[k] * (four(older + 4 * v) + sign * four(newer + 4 * v));
    }
    for (Index v = 0; v < kVectors; ++v) four(out + i + 4 * v) = sum[v];
  }
  for (; i < count; ++i) {
    double sum = w[half] * x[i + half];
    for (Index k = 0; k < half; ++k) sum += w[k] * (x[i + k] + sign * x[i + 2 * half - k]);
    out[i] = sum;
  }
}

void correlate_any(const Vector& weights, double sign, const double* x, double* out, Index count) {
  correlate_body(weights, sign, x, out, count);
}
#if defined(__x86_64__)
/// Without fused multiply-add, which would round otherwise.
[[gnu::target("avx2")]] void correlate_avx2(const Vector& weights, double sign, const double* x, double* out,
                                            Index count) {
  correlate_body(weights, sign, x, out, count);
}
#endif

void correlate(const Vector& weights, double sign, const double* x, double* out, Index count) {
#if defined(__x86_64__)
  if (has_x86_64_v3()) return correlate_avx2(weights, sign, x, out, count);
#endif
  correlate_any(weights, sign, x, out, count);
}

}  // namespace

Result<SavitzkyGolayWeights> savitzky_golay_polynomial(const SavitzkyGolay& filter, int derivative) {
  MBK_TRY(check(filter, derivative));
  const Index half = filter.half_window(), window = filter.window;
  const double scale = half > 0 ? 1.0 / static_cast<double>(half) : 1.0;
  const Vector t = Vector::LinSpaced(window, -static_cast<double>(half), static_cast<double>(half)) * scale;

  SavitzkyGolayWeights result{Vector::Zero(window), Vector::Zero(filter.order + 1)};
  if (derivative > filter.order) return result;
  const double unit = std::tgamma(derivative + 1.0) * std::pow(scale, derivative);
  Vector p = Vector::Ones(window), p_before = Vector::Zero(window);
  Vector powers = Vector::Unit(filter.order + 2, 0), powers_before = Vector::Zero(filter.order + 2);  // of p_k, by tᵐ
  double norm = static_cast<double>(window), norm_before = 1.0;
  for (int k = 0; k <= filter.order; ++k) {
    const double share = unit * powers[derivative] / norm;
    result.samples += share * p;
    result.powers += share * powers.head(filter.order + 1);
    const double beta = k > 0 ? norm / norm_before : 0.0;
    const Vector p_next = t.cwiseProduct(p) - beta * p_before;
    Vector powers_next = -beta * powers_before;
    powers_next.tail(filter.order + 1) += powers.head(filter.order + 1);
    p_before = p;
    p = p_next;
    powers_before = powers;
    powers = powers_next;
    norm_before = norm;
    norm = p.squaredNorm();
  }
  for (int m = 1; m <= filter.order; ++m) result.powers[m] *= std::pow(scale, m);
  return result;
}

Result<Vector> savitzky_golay_weights(const SavitzkyGolay& filter, int derivative) {
  auto weights = MBK_TRY(savitzky_golay_polynomial(filter, derivative));
  return std::move(weights.samples);
}

Result<Matrix> savitzky_golay(const SavitzkyGolay& filter, int derivative, const Matrix& signals, Hertz sample_rate) {
  auto weights = MBK_TRY(savitzky_golay_weights(filter, derivative));
  const Index count = signals.rows() - filter.window + 1;
  if (count < 1) {
    return bad_data(
        fmt::format("{} samples are fewer than the Savitzky–Golay window of {}", signals.rows(), filter.window),
        "use a longer recording or a smaller --sg-window");
  }
  weights *= std::pow(sample_rate.value, derivative);
  Matrix filtered(count, signals.cols());
  for (Index column = 0; column < signals.cols(); ++column) {
    correlate(weights, derivative % 2 == 0 ? 1.0 : -1.0, signals.col(column).data(), filtered.col(column).data(),
              count);
  }
  return filtered;
}

Result<Vector> savitzky_golay_response(const SavitzkyGolay& filter, int derivative, const Vector& frequency_hz,
                                       Hertz sample_rate) {
  const auto weights = MBK_TRY(savitzky_golay_weights(filter, derivative));
  Vector response(frequency_hz.size());
  for (Index k = 0; k < response.size(); ++k) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz[k] / sample_rate.value;  // per sample
    std::complex<double> sum = 0.0;
    for (Index i = 0; i < weights.size(); ++i) {
      sum += weights[i] * std::polar(1.0, omega * static_cast<double>(i - filter.half_window()));
    }
    response[k] = std::abs(sum) * std::pow(sample_rate.value, derivative);
  }
  return response;
}

Result<double> savitzky_golay_gain(const SavitzkyGolay& filter, int derivative, Hertz frequency, Hertz sample_rate) {
  const auto response =
      MBK_TRY(savitzky_golay_response(filter, derivative, Vector::Constant(1, frequency.value), sample_rate));
  return response[0] / std::pow(2.0 * std::numbers::pi * frequency.value, derivative);
}

Result<Hertz> savitzky_golay_cutoff(const SavitzkyGolay& filter, Hertz sample_rate) {
  const double target = std::numbers::sqrt2 / 2.0;
  const auto gain_at = [&](double hz) { return savitzky_golay_gain(filter, 0, Hertz(hz), sample_rate); };
  MBK_TRY(gain_at(0.0));
  // Below the main lobe's first crossing the gain falls from 1; walk up to bracket it, then bisect.
  const double step = sample_rate.value / (16.0 * filter.window);
  double low = 0.0, high = step;
  while (high<0.5 * sample_rate.value&& * gain_at(high)> target) {
    low = high;
    high += step;
  }
  while (high - low > 1e-9 * high) {
    const double middle = 0.5 * (low + high);
    (*gain_at(middle) > target ? low : high) = middle;
  }
  return Hertz(0.5 * (low + high));
}

int savitzky_golay_window(int order, Hertz cutoff, Hertz sample_rate) {
  const double fraction = cutoff.value / (0.5 * sample_rate.value);
  const double half = std::ceil(((order + 1) / fraction + 4.6) / 3.2);
  const int shortest_half = (order + 3) / 2;
  return 2 * std::max(static_cast<int>(half), shortest_half) + 1;
}

}  // namespace mbk::dsp
