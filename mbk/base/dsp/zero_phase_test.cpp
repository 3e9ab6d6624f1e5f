#include "mbk/base/dsp/zero_phase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mbk/base/dsp/causal_filter.h"

namespace mbk::dsp {
namespace zero_phase_test {

const Hertz kRate(1000.0);

SectionCascade lowpass(double cutoff_hz, int order = 5) {
  return butterworth_lowpass(order, Hertz(cutoff_hz), kRate).value();
}

Matrix noise(Index n, Index columns, unsigned seed) {
  std::mt19937 random(seed);
  Matrix values(n, columns);
  for (double& value : values.reshaped()) value = static_cast<double>(random()) / 4294967296.0 - 0.5;
  return values;
}

/// The slow plain twin: one numerator and denominator in long double (64-bit mantissa, 11 bits more than the filter),
/// direct form, its steady state from the linear equations of the state.
Vector twin(const SectionCascade& filter, const Vector& signal, Index pad) {
  using Real = long double;
  std::vector<Real> b = {1.0L}, a = {1.0L};
  const auto times = [](const std::vector<Real>& x, const std::vector<Real>& y) {
    std::vector<Real> z(x.size() + y.size() - 1, 0.0L);
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < y.size(); ++j) z[i + j] += x[i] * y[j];
    }
    return z;
  };
  for (const SecondOrderSection& s : filter) {
    b = times(b, {s.b0, s.b1, s.b2});
    a = times(a, {1.0L, s.a1, s.a2});
  }
  const std::size_t order = a.size() - 1;
  std::vector<Real> x;
  const Index n = signal.size();
  for (Index i = pad; i >= 1; --i) x.push_back(2.0L * signal[0] - signal[i]);
  for (Index i = 0; i < n; ++i) x.push_back(signal[i]);
  for (Index i = 1; i <= pad; ++i) x.push_back(2.0L * signal[n - 1] - signal[n - 1 - i]);
  Real sum_b = 0.0L, sum_a = 0.0L;
  for (std::size_t k = 0; k <= order; ++k) {
    sum_b += b[k];
    sum_a += a[k];
  }
  const auto pass = [&] {
    // The state after an endless constant input x[0]: transposed direct form II, s_k = Σ_{i>k} (b_i − a_i g) x[0].
    std::vector<Real> state(order + 1, 0.0L);
    for (std::size_t k = order; k-- > 0;) state[k] = state[k + 1] + (b[k + 1] - a[k + 1] * (sum_b / sum_a)) * x[0];
    for (Real& value : x) {
      const Real input = value;
      value = b[0] * input + state[0];
      for (std::size_t k = 0; k < order; ++k) state[k] = b[k + 1] * input - a[k + 1] * value + state[k + 1];
    }
  };
  pass();
  std::reverse(x.begin(), x.end());
  pass();
  std::reverse(x.begin(), x.end());
  Vector result(n);
  for (Index i = 0; i < n; ++i) result[i] = static_cast<double>(x[static_cast<std::size_t>(i + pad)]);
  return result;
}

TEST(ZeroPhase, AgreesWithItsPlainTwin) {
  // At 60 Hz the direct form is well enough conditioned that the twin's extra bits carry it.
  const Matrix signal = noise(400, 1, 1);
  const auto filtered = filter_zero_phase(lowpass(60.0), signal);
  ASSERT_TRUE(filtered);
  EXPECT_LT((filtered->col(0) - twin(lowpass(60.0), signal.col(0), 15)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ZeroPhase, KeepsAConstantExactlyAndARampInTheMiddle) {
  // Three and a half seconds from the ends the slowest pole of the 5 Hz filter has decayed by e^−34.
  const Index n = 8000;
  Matrix signals(n, 2);
  signals.col(0).setConstant(0.3);
  signals.col(1) = Vector::LinSpaced(n, 0.0, 1.0);
  const auto filtered = filter_zero_phase(lowpass(5.0), signals);
  ASSERT_TRUE(filtered);
  EXPECT_LT((filtered->col(0).array() - 0.3).abs().maxCoeff(), 1e-12);
  EXPECT_LT((filtered->col(1) - signals.col(1)).segment(3500, 1000).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(ZeroPhase, DelaysNothingAndSquaresTheGain) {
  const Index n = 20000;
  const double f = 4.0;
  Matrix signal(n, 1);
  for (Index i = 0; i < n; ++i)
    signal(i, 0) = std::sin(2.0 * std::numbers::pi * f * static_cast<double>(i) / kRate.value);
  const auto filtered = filter_zero_phase(lowpass(5.0), signal);
  ASSERT_TRUE(filtered);
  const double expected = std::pow(gain(lowpass(5.0), Hertz(f), kRate), 2);
  EXPECT_LT((filtered->col(0) - expected * signal.col(0)).segment(5000, 10000).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ZeroPhase, KeepsALinearRelationBetweenColumns) {
  const Matrix x = noise(600, 2, 2);
  Matrix all(600, 3);
  all << x, 3.0 * x.col(0) - 2.0 * x.col(1) + Vector::Constant(600, 5.0);
  const auto filtered = filter_zero_phase(lowpass(5.0), all);
  ASSERT_TRUE(filtered);
  const Vector predicted = (3.0 * filtered->col(0) - 2.0 * filtered->col(1)).array() + 5.0;
  EXPECT_LT((filtered->col(2) - predicted).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(ZeroPhase, IsAsTheExtensionSays) {
  // A filter that does nothing shows the extension's choice only through its length.
  const Matrix signal = noise(40, 1, 3);
  for (const Extension extension : {Extension::odd, Extension::even, Extension::constant}) {
    const auto filtered = filter_zero_phase(SectionCascade{SecondOrderSection{}}, signal, {extension, 7});
    ASSERT_TRUE(filtered);
    EXPECT_EQ((*filtered - signal).cwiseAbs().maxCoeff(), 0.0);
  }
  const auto odd = filter_zero_phase(lowpass(60.0), signal, {Extension::odd, 15}).value();
  const auto even = filter_zero_phase(lowpass(60.0), signal, {Extension::even, 15}).value();
  EXPECT_GT((odd - even).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ZeroPhase, RefusesASignalShorterThanItsPadding) {
  EXPECT_TRUE(filter_zero_phase(lowpass(60.0), noise(16, 1, 4)));
  const auto refused = filter_zero_phase(lowpass(60.0), noise(15, 1, 4));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("15 samples"));
}

TEST(FilterZeroPhase, OfColumnsSideBySideIsThatOfEachAloneToTheLastBit) {
  const SectionCascade filter = lowpass(12.0);
  const Padding padding{.samples = 20};
  for (Index columns = 1; columns <= 9; ++columns) {
    const Matrix signals = noise(300, columns, static_cast<unsigned>(columns));
    const Matrix filtered = filter_zero_phase(filter, signals, padding).value();
    for (Index column = 0; column < columns; ++column) {
      const Vector x = signals.col(column);
      std::vector<double> work;
      for (Index i = padding.samples; i >= 1; --i) work.push_back(2.0 * x[0] - x[i]);
      work.insert(work.end(), x.begin(), x.end());
      for (Index i = 1; i <= padding.samples; ++i) work.push_back(2.0 * x[299] - x[299 - i]);
      CausalFilter running(filter);
      for (int pass = 0; pass < 2; ++pass) {
        running.settle(work.front());
        for (double& value : work) value = running.step(value);
        std::ranges::reverse(work);
      }
      for (Index i = 0; i < 300; ++i) {
        ASSERT_EQ(filtered(i, column), work[static_cast<std::size_t>(padding.samples + i)])
            << columns << ", " << column;
      }
    }
  }
}

}  // namespace zero_phase_test
}  // namespace mbk::dsp
