#include "mbk/base/dsp/savitzky_golay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mbk/base/dsp/test_twins.h"

namespace mbk::dsp {
namespace savitzky_golay_test {

constexpr double kEps = 2.3e-16;
const Hertz kRate(1000.0);

TEST(SavitzkyGolay, HasTheWeightsOfAPolynomialFitToRounding) {
  for (const SavitzkyGolay filter : {SavitzkyGolay{2, 5}, {4, 31}, {6, 31}, {6, 101}, {6, 151}, {9, 151}, {3, 1001}}) {
    for (int derivative = 0; derivative <= 3; ++derivative) {
      const auto weights = savitzky_golay_weights(filter, derivative);
      ASSERT_TRUE(weights);
      const twin::Signal wide = twin::weights_of(filter, derivative);
      Vector twin(filter.window);
      for (Index i = 0; i < twin.size(); ++i) twin[i] = static_cast<double>(wide[static_cast<std::size_t>(i)]);
      const double scale = twin.cwiseAbs().maxCoeff();
      if (derivative > filter.order) continue;
      EXPECT_LT((*weights - twin).cwiseAbs().maxCoeff(), 64 * kEps * std::max(scale, 1e-300))
          << "N " << filter.order << ", W " << filter.window << ", derivative " << derivative;
    }
  }
}

TEST(SavitzkyGolay, HasTheTextbookWeightsOfFivePoints) {
  // Savitzky & Golay 1964: (−3, 12, 17, 12, −3)/35 and (−2, −1, 0, 1, 2)/10.
  const Vector smooth = savitzky_golay_weights({2, 5}, 0).value(), slope = savitzky_golay_weights({2, 5}, 1).value();
  EXPECT_TRUE(smooth.isApprox((Vector(5) << -3, 12, 17, 12, -3).finished() / 35.0, 4 * kEps));
  EXPECT_TRUE(slope.isApprox((Vector(5) << -2, -1, 0, 1, 2).finished() / 10.0, 4 * kEps));
}

TEST(SavitzkyGolay, ReproducesAPolynomialAndItsDerivatives) {
  const Index n = 400;
  const auto t = [](Index i) { return static_cast<double>(i) / kRate.value; };
  Matrix signal(n, 1);
  for (Index i = 0; i < n; ++i) signal(i, 0) = 1.0 + t(i) * (2.0 + t(i) * (-3.0 + t(i) * t(i) * t(i) * 40.0));
  const SavitzkyGolay filter{6, 151};
  const Matrix value = savitzky_golay(filter, 0, signal, kRate).value(),
               first = savitzky_golay(filter, 1, signal, kRate).value(),
               second = savitzky_golay(filter, 2, signal, kRate).value();
  ASSERT_EQ(value.rows(), n - 150);
  for (Index row = 0; row < value.rows(); ++row) {
    const double s = t(row + 75);
    EXPECT_NEAR(value(row, 0), signal(row + 75, 0), 1e-14);
    EXPECT_NEAR(first(row, 0), 2.0 - 6.0 * s + 200.0 * std::pow(s, 4), 1e-11);
    // The rounding of a value near 1, twice differentiated at 1 kHz over 151 samples: eps·1e6/75²·√(norm).
    EXPECT_NEAR(second(row, 0), -6.0 + 800.0 * std::pow(s, 3), 1e-9);
  }
}

TEST(SavitzkyGolay, HasTheKnownCutoffsOfTheThesisFilter) {
  // Dyck's filter (6, 101) at 1 kHz: −3 dB at 23.03 Hz; its derivatives against the ideal ones at 18.8 and 20.7 Hz.
  const SavitzkyGolay filter{6, 101};
  EXPECT_NEAR(savitzky_golay_cutoff(filter, kRate)->value, 23.03, 0.005);
  EXPECT_NEAR(savitzky_golay_gain(filter, 1, Hertz(18.8), kRate).value(), std::sqrt(0.5), 0.01);
  EXPECT_NEAR(savitzky_golay_gain(filter, 2, Hertz(20.7), kRate).value(), std::sqrt(0.5), 0.01);
}

TEST(SavitzkyGolay, ChoosesAWindowThatCutsNearTheExpectedFrequency) {
  for (const double cutoff : {10.0, 23.0, 50.0, 100.0}) {
    const SavitzkyGolay filter{6, savitzky_golay_window(6, Hertz(cutoff), kRate)};
    EXPECT_EQ(filter.window % 2, 1);
    const double true_cutoff = savitzky_golay_cutoff(filter, kRate)->value;
    EXPECT_LT(true_cutoff, 1.05 * cutoff);  // Schafer's formula is an estimate
    EXPECT_GT(true_cutoff, 0.75 * cutoff);  // short windows are coarse
  }
}

TEST(SavitzkyGolay, GivesEachColumnItsOwnAnswer) {
  std::mt19937 random(5);
  Matrix signals(3000, 3);
  for (double& value : signals.reshaped()) value = static_cast<double>(random()) * 1e-9;
  for (int derivative = 0; derivative <= 2; ++derivative) {
    const Matrix together = savitzky_golay({6, 31}, derivative, signals, kRate).value();
    const Vector weights = savitzky_golay_weights({6, 31}, derivative).value() * std::pow(kRate.value, derivative);
    for (Index column = 0; column < 3; ++column) {
      for (Index row = 0; row < together.rows(); row += 97) {
        const double plain = weights.dot(signals.col(column).segment(row, 31));
        EXPECT_NEAR(together(row, column), plain, 1e-13 * weights.cwiseAbs().sum() * 5.0);
      }
    }
  }
}

TEST(SavitzkyGolay, RefusesWhatCannotBe) {
  EXPECT_FALSE(savitzky_golay_weights({6, 100}, 0));
  EXPECT_FALSE(savitzky_golay_weights({6, 5}, 0));
  EXPECT_FALSE(savitzky_golay_weights({-1, 5}, 0));
  EXPECT_FALSE(savitzky_golay_weights({6, 101}, -1));
  EXPECT_FALSE(savitzky_golay({6, 101}, 0, Matrix::Zero(100, 1), kRate));
  EXPECT_TRUE(savitzky_golay({6, 101}, 0, Matrix::Zero(101, 1), kRate));
}

}  // namespace savitzky_golay_test
}  // namespace mbk::dsp
