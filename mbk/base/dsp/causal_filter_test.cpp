#include "mbk/base/dsp/causal_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace mbk::dsp {
namespace causal_filter_test {

constexpr double kPi = std::numbers::pi;
const Hertz kRate(1000.0);

SectionCascade lowpass(int order, double cutoff) {
  return butterworth_lowpass(order, Hertz(cutoff), kRate).value();
}

TEST(CausalFilter, WithoutSectionsLetsEverythingPass) {
  CausalFilter filter;
  filter.settle(3.0);
  EXPECT_EQ(filter.step(0.1), 0.1);
}

TEST(CausalFilter, AgreesWithTheDifferenceEquationOfItsSections) {
  const SectionCascade sections = lowpass(5, 20.0);
  std::vector<double> signal;
  for (int k = 0; k < 500; ++k) signal.push_back(std::sin(0.3 * k) + (k % 7 == 0 ? 1.0 : 0.0));
  std::vector<double> expected = signal;
  for (const SecondOrderSection& s : sections) {
    const std::vector<double> input = expected;
    const auto past = [](const std::vector<double>& x, std::size_t k, std::size_t lag) {
      return k < lag ? 0.0 : x[k - lag];
    };
    for (std::size_t k = 0; k < input.size(); ++k) {
      expected[k] = s.b0 * input[k] + s.b1 * past(input, k, 1) + s.b2 * past(input, k, 2) -
                    s.a1 * past(expected, k, 1) - s.a2 * past(expected, k, 2);
    }
  }
  CausalFilter filter(sections);
  for (std::size_t k = 0; k < signal.size(); ++k) {
    ASSERT_NEAR(filter.step(signal[k]), expected[k], 1e-12) << k;  // rounding, amplified by poles near 1
  }
}

TEST(CausalFilter, SettledItKeepsAConstant) {
  CausalFilter filter(lowpass(4, 48.2));
  filter.settle(-2.5);
  for (int k = 0; k < 1000; ++k) ASSERT_NEAR(filter.step(-2.5), -2.5, 1e-12) << k;
}

TEST(CausalFilter, DelaysARampByTheDelayAtZero) {
  const SectionCascade sections = lowpass(4, 48.2);
  CausalFilter filter(sections);
  double output = 0.0;
  for (int k = 0; k <= 2000; ++k) output = filter.step(0.001 * k);
  EXPECT_NEAR(2.0 - output, delay_at_zero(sections, kRate), 1e-11);
}

TEST(CausalFilter, DelayOfAButterworthIsItsClosedForm) {
  // Σ over poles of 1/(…) = Σ 2 cos φ_k over pairs, in units of the prewarped 2 tan(π f_c/f_s) per sample
  const double pairs = 2.0 * (std::cos(kPi / 8.0) + std::cos(3.0 * kPi / 8.0));
  const double expected = pairs / (2.0 * std::tan(kPi * 0.0482)) * 1e-3;
  EXPECT_NEAR(delay_at_zero(lowpass(4, 48.2), kRate), expected, 1e-14);
  EXPECT_EQ(delay_at_zero({}, kRate), 0.0);
}

}  // namespace causal_filter_test
}  // namespace mbk::dsp
