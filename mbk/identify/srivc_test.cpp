#include "mbk/identify/srivc.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/numeric/random.h"

namespace mbk::identify {
namespace {

/// Rao & Garnier (2002): (−6400 s + 1600)/(s⁴ + 5 s³ + 408 s² + 416 s + 1600).
struct RaoGarnier {
  Vector a{{1600.0, 416.0, 408.0, 5.0}}, b{{1600.0, -6400.0}};
  Vector theta{{1600.0, 416.0, 408.0, 5.0, 1600.0, -6400.0}};
};

/// Maximum-length binary sequence from a register of 10 bits, each held for `hold` samples: 1023·hold of them.
Vector binary_sequence(int hold) {
  unsigned bits = 1023;
  Vector u(1023 * hold);
  for (Index i = 0; i < u.size(); ++i) {
    if (i % hold == 0) bits = ((bits << 1U) | (((bits >> 9U) ^ (bits >> 6U)) & 1U)) & 1023U;
    u[i] = (bits & 1U) != 0U ? 1.0 : -1.0;
  }
  return u;
}

SignalPair experiment(int hold, double step) {
  SignalPair pair;
  pair.input = binary_sequence(hold);
  pair.time = Vector::LinSpaced(pair.input.size(), 0.0, static_cast<double>(pair.input.size() - 1)) * step;
  pair.step = step;
  return pair;
}

SignalPair rao_garnier(double signal_to_noise, std::uint64_t seed, double colour = 0.0) {
  SignalPair pair = experiment(7, 0.01);
  const RaoGarnier truth;
  pair.output = simulate_continuous(truth.a, truth.b, pair);
  const double level = std::sqrt((pair.output.array() - pair.output.mean()).square().mean() / signal_to_noise);
  numeric::Random random(seed);
  double noise = 0.0;
  for (double& y : pair.output) {
    noise = colour * noise + std::sqrt(1.0 - colour * colour) * random.normal();
    y += level * noise;
  }
  return pair;
}

ContinuousFitOptions order_4_1() {
  ContinuousFitOptions options;
  options.poles = 4;
  options.zeros = 1;
  return options;
}

Vector both(const ContinuousFit& fit) {
  Vector theta(fit.a.size() + fit.b.size());
  theta << fit.a, fit.b;
  return theta;
}

TEST(Srivc, GivesANoiseFreeModelToEightDigits) {
  const auto fit = fit_continuous({rao_garnier(1e300, 1)}, order_4_1());
  ASSERT_TRUE(fit.has_value());
  EXPECT_TRUE(fit->converged);
  const Vector truth = RaoGarnier().theta;
  EXPECT_LT(((both(*fit) - truth).array() / truth.array()).abs().maxCoeff(), 1e-8) << both(*fit).transpose();
}

TEST(Srivc, MeetsThePublishedMeansAndSpreads) {
  constexpr int kRuns = 50;
  const Vector truth = RaoGarnier().theta;
  const Vector published{{6.5, 3.4, 1.0, 0.07, 68.0, 37.0}};
  Matrix found(6, kRuns), errors(6, kRuns);
  for (int run = 0; run < kRuns; ++run) {
    const auto fit = fit_continuous({rao_garnier(10.0, 100 + run)}, order_4_1());
    ASSERT_TRUE(fit.has_value() && fit->converged) << run;
    found.col(run) = both(*fit);
    errors.col(run) = fit->covariance.diagonal().cwiseSqrt();
  }
  for (Index k = 0; k < 6; ++k) {
    const double mean = found.row(k).mean();
    const double spread = std::sqrt((found.row(k).array() - mean).square().sum() / (kRuns - 1));
    EXPECT_LT(std::abs(mean - truth[k]), 3.0 * spread / std::sqrt(kRuns)) << k;
    EXPECT_NEAR(spread / published[k], 1.0, 0.25) << k;
    EXPECT_NEAR(errors.row(k).mean() / spread, 1.0, 0.3) << k;
  }
}

}  // namespace
}  // namespace mbk::identify
