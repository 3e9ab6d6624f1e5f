#include "tests/reference/quad_filters.h"

#include <gtest/gtest.h>
#include <quadmath.h>

#include <cmath>

namespace mbk::reference {
namespace {

const Quad kMilli = Quad(1) / 1000;
const Quad kQuadEps = scalbnq(1, -112);

/// |a − b| over |b|, as a double for printing.
double relative(Quad a, Quad b) {
  return static_cast<double>(fabsq((a - b) / b));
}

TEST(SavitzkyGolay, ReproducesPolynomialsOfItsOrderAndTheirDerivatives) {
  // p(t) = Σ_{k≤6} (k + 1) (20 t)ᵏ about the centre: p(0) = 1, ṗ(0) = 2·20, p̈(0) = 3·2·400
  const Quad expected[] = {1, 40, 2400};
  for (const int window : {101, 151}) {
    const int h = (window - 1) / 2;
    for (int derivative = 0; derivative <= 2; ++derivative) {
      const Signal weights = savitzky_golay_weights(6, window, derivative, kMilli);
      ASSERT_EQ(weights.size(), static_cast<std::size_t>(window));
      Quad sum = 0, magnitude = 0;
      for (int j = -h; j <= h; ++j) {
        Quad power = 1, p = 0;
        for (int k = 0; k <= 6; ++k, power *= 20 * j * kMilli) p += (k + 1) * power;
        const Quad term = weights[static_cast<std::size_t>(j + h)] * p;
        sum += term;
        magnitude += fabsq(term);
      }
      // Condition of the normal equations in j/h: below 1e6
      EXPECT_LE(static_cast<double>(fabsq(sum - expected[derivative]) / magnitude), 1e6 * static_cast<double>(kQuadEps))
          << "window " << window << ", derivative " << derivative;
    }
  }
}

TEST(SavitzkyGolay, MatchesPublishedIntegers) {
  // Savitzky & Golay (1964), quadratic/cubic smoothing over 5 points: (−3 12 17 12 −3)/35
  const Signal weights = savitzky_golay_weights(2, 5, 0, 1);
  const int integers[] = {-3, 12, 17, 12, -3};
  for (std::size_t j = 0; j < 5; ++j) EXPECT_LE(relative(weights[j], Quad(integers[j]) / 35), 1e-32);
}

TEST(SavitzkyGolay, HasTheBandwidthOfThePublishedFilter) {
  const Signal weights = savitzky_golay_weights(6, 101, 0, kMilli);
  const auto gain = [&](Quad frequency_hz) {
    Quad sum = 0;
    for (int j = -50; j <= 50; ++j) {
      sum += weights[static_cast<std::size_t>(j + 50)] * cosq(2 * acosq(-1) * frequency_hz * j / 1000);
    }
    return static_cast<double>(sum);
  };
  EXPECT_GT(gain(23.025), std::sqrt(0.5));  // −3 dB at 23.03 Hz
  EXPECT_LT(gain(23.035), std::sqrt(0.5));
}

TEST(Butterworth, HasHalfPowerAtItsCutoffAndUnitGainAtRest) {
  for (const Quad cutoff : {Quad(5), Quad(9) / 2}) {
    const Filter filter = butterworth(5, cutoff, 1000);
    ASSERT_EQ(filter.a.size(), 6u);
    EXPECT_EQ(filter.a[0], 1);
    // Σa is about (2π·5/1000)⁵ = 3e-8 of the coefficients: 8 digits are lost, squared gain doubles the error
    EXPECT_LE(relative(squared_gain(filter, 0, 1000), 1), 1e-23);
    EXPECT_LE(relative(squared_gain(filter, cutoff, 1000), Quad(1) / 2), 1e-23);
  }
}

TEST(Butterworth, ForwardAndBackwardGainsAreThePublishedFilters) {
  const Filter filter = butterworth(5, 5, 1000);
  EXPECT_NEAR(static_cast<double>(squared_gain(filter, 3, 1000)), 0.994, 0.0005);  // printed to three digits
  EXPECT_NEAR(static_cast<double>(squared_gain(filter, 4, 1000)), 0.903, 0.0005);
  EXPECT_NEAR(static_cast<double>(squared_gain(filter, 5, 1000)), 0.5, 1e-15);
}

TEST(ZeroPhase, KeepsAConstantAndALine) {
  const Filter filter = butterworth(5, 5, 1000);
  Signal constant(500, 3), line(20000);
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = static_cast<int>(i);
  for (const Quad value : zero_phase(filter, constant)) ASSERT_LE(relative(value, 3), 1e-23);
  // Away from the ends a line passes unchanged; what the ends leave decays with the slowest pole, 2π·5·0.309 s⁻¹:
  // e^{−9.7·10} = 6e-43
  EXPECT_LE(relative(zero_phase(filter, line)[10000], 10000), 1e-20);
}

TEST(ZeroPhase, CommutesWithReversalAwayFromTheEnds) {
  const Filter filter = butterworth(5, 5, 1000);
  Signal pulse(8001, 0);
  pulse[4000] = 1;
  const Signal y = zero_phase(filter, pulse);
  for (std::size_t k = 1; k <= 1000; ++k) {
    ASSERT_LE(static_cast<double>(fabsq(y[4000 - k] - y[4000 + k])), 1e-15 * static_cast<double>(y[4000])) << k;
  }
}

TEST(LeastSquares, RecoversCoefficientsAndLeavesAnOrthogonalResidual) {
  std::vector<Signal> Z(3), Y(1);
  for (int i = 0; i < 40; ++i) {
    const Quad t = Quad(i) / 39;
    Z[0].push_back(1), Z[1].push_back(t), Z[2].push_back(t * t);
    Y[0].push_back(2 - 3 * t + 5 * t * t + (i % 2 ? Quad(1) / 100 : -Quad(1) / 100));
  }
  const Signal p = least_squares(Z, Y)[0];
  EXPECT_NEAR(static_cast<double>(p[2]), 5.0, 0.1);
  for (const Signal& column : Z) {
    Quad dot = 0;
    for (std::size_t i = 0; i < column.size(); ++i) {
      dot += column[i] * (Y[0][i] - p[0] * Z[0][i] - p[1] * Z[1][i] - p[2] * Z[2][i]);
    }
    EXPECT_LE(static_cast<double>(fabsq(dot)), 1e4 * static_cast<double>(kQuadEps));
  }
}

}  // namespace
}  // namespace mbk::reference
