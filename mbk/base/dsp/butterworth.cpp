#include "mbk/base/dsp/butterworth.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace mbk::dsp {

namespace {

Result<void> check_butterworth(int order, Hertz cutoff, Hertz sample_rate) {
  const double nyquist = 0.5 * sample_rate.value;
  if (order < 1 || order > 20) {
    return bad_usage(fmt::format("Butterworth order {} is not between 1 and 20", order));
  }
  if (!(cutoff.value > 0.0 && cutoff.value < nyquist)) {
    return bad_usage(fmt::format("cutoff {:g} Hz is not between 0 and Nyquist {:g} Hz", cutoff.value, nyquist),
                     "choose a lower --cutoff");
  }
  return {};
}

}  // namespace

Result<SectionCascade> butterworth_lowpass(int order, Hertz cutoff, Hertz sample_rate) {
  MBK_TRY(check_butterworth(order, cutoff, sample_rate));
  const double k = std::tan(std::numbers::pi * cutoff.value / sample_rate.value);
  SectionCascade filter;
  if (order % 2 == 1) {
    filter.push_back({.b0 = k / (1.0 + k), .b1 = k / (1.0 + k), .a1 = (k - 1.0) / (k + 1.0)});
  }
  for (int i = 0; i < order / 2; ++i) {
    const double angle =
        order % 2 == 1 ? std::numbers::pi * (i + 1) / order : std::numbers::pi * (2 * i + 1) / (2.0 * order);
    const double c = 2.0 * std::cos(angle);  // 2 × damping ratio of this pole pair
    const double a0 = 1.0 + c * k + k * k;
    const double b0 = k * k / a0;
    filter.push_back(
        {.b0 = b0, .b1 = 2.0 * b0, .b2 = b0, .a1 = 2.0 * (k - 1.0) * (k + 1.0) / a0, .a2 = (1.0 - c * k + k * k) / a0});
  }
  return filter;
}

Result<SectionCascade> butterworth_highpass(int order, Hertz cutoff, Hertz sample_rate) {
  MBK_TRY(check_butterworth(order, cutoff, sample_rate));
  auto filter = MBK_TRY(butterworth_lowpass(order, Hertz(0.5 * sample_rate.value - cutoff.value), sample_rate));
  for (SecondOrderSection& section : filter) {
    section.b1 = -section.b1;
    section.a1 = -section.a1;
  }
  return filter;
}

double gain(const SectionCascade& filter, Hertz frequency, Hertz sample_rate) {
  const std::complex<double> z1 = std::polar(1.0, -2.0 * std::numbers::pi * frequency.value / sample_rate.value);
  double product = 1.0;
  for (const SecondOrderSection& s : filter) {
    product *= std::abs((s.b0 + (s.b1 + s.b2 * z1) * z1) / (1.0 + (s.a1 + s.a2 * z1) * z1));
  }
  return product;
}

}  // namespace mbk::dsp
