#include "mbk/measure/explore/local_polynomial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "mbk/measure/explore/test_signals.h"
#include "mbk/measure/explore/welch_response.h"

namespace mbk::explore {
namespace local_polynomial_test {

using Complex = std::complex<double>;
constexpr double kStep = 0.01;

/// A lightly damped resonance, y[i] = 2 ρ cos φ y[i−1] − ρ² y[i−2] + u[i], which remembers for long.
struct Resonance {
  double radius = 0.985, angle = 0.6;
  [[nodiscard]] Vector filtered(const Vector& u) const {
    Vector y(u.size());
    double one = 0.0, two = 0.0;
    for (Index i = 0; i < u.size(); ++i) {
      y[i] = u[i] + 2.0 * radius * std::cos(angle) * one - radius * radius * two;
      two = one;
      one = y[i];
    }
    return y;
  }
  [[nodiscard]] Complex response(double hertz) const {
    const Complex z = std::polar(1.0, -2.0 * std::numbers::pi * hertz * kStep);
    return 1.0 / (1.0 - 2.0 * radius * std::cos(angle) * z + radius * radius * z * z);
  }
};

TEST(LocalPolynomial, OfAGainIsThatGain) {
  const Vector u = white_noise(4000, 1);
  const auto trial = trial_of(u, 2.5 * u, kStep);
  const auto found = local_polynomial_response({&trial, 1}, {1.0, 40.0});
  ASSERT_TRUE(found.has_value()) << found.error().line();
  for (const auto& G : found->response) EXPECT_NEAR(std::abs(G(0, 0) - 2.5), 0.0, 1e-10);
  EXPECT_GT(found->multiple_coherence.minCoeff(), 1.0 - 1e-12);
}

TEST(LocalPolynomial, FollowsAResonanceThatAveragedSegmentsFlatten) {
  const Resonance truth;
  const Vector u = white_noise(12'000, 2);
  const auto trial = trial_of(u, truth.filtered(u), kStep);
  const auto local = local_polynomial_response({&trial, 1}, {0.2, 40.0});
  const auto averaged = welch_response({&trial, 1}, {2.0, 40.0});
  ASSERT_TRUE(local.has_value() && averaged.has_value());
  const auto worst = [&](const FrequencyResponseEstimate& found) {
    double error = 0.0;
    for (Index k = 0; k < found.size(); ++k) {
      const Complex exact = truth.response(found.frequency[k]);
      error = std::max(error, std::abs(found.response[static_cast<std::size_t>(k)](0, 0) - exact) / std::abs(exact));
    }
    return error;
  };
  EXPECT_LT(worst(*local), 0.05);
  EXPECT_GT(worst(*averaged), 3.0 * worst(*local));
}

TEST(LocalPolynomial, HasTheDegreesOfFreedomOfItsModel) {
  const Matrix u = white_noise(4000, 2, 3);
  const auto trial = trial_of(u, u + 0.1 * white_noise(4000, 2, 60), kStep);
  const auto found = local_polynomial_response({&trial, 1}, {1.0, 20.0});
  ASSERT_TRUE(found.has_value());
  // 40 s and 1 Hz: 41 lines, of which 3 (n_u + 1) = 9 go to the model
  EXPECT_DOUBLE_EQ(found->degrees_of_freedom[0], 41.0 - 9.0);
}

TEST(LocalPolynomial, IntervalsCoverTheTruthInOpenAndInClosedLoop) {
  for (const bool closed : {false, true}) {
    int inside = 0, magnitude_inside = 0, all = 0;
    for (unsigned run = 0; run < 60; ++run) {
      const Index n = 4000;
      const Vector r = white_noise(n, 17 * run + 1), v = white_noise(n, 17 * run + 100'000);
      Vector u(n), y(n);
      double before = 0.0;
      for (Index i = 0; i < n; ++i) {
        y[i] = 0.5 * before + v[i];
        u[i] = closed ? r[i] - y[i] : r[i];
        before = u[i];
      }
      const auto trial = closed ? trial_of(u, y, kStep, r) : trial_of(u, y, kStep);
      const auto found = local_polynomial_response({&trial, 1}, {1.0, 40.0});
      ASSERT_TRUE(found.has_value()) << found.error().line();
      EXPECT_EQ(found->by_reference, closed);
      for (Index k = 0; k < found->size(); ++k, ++all) {
        const Complex truth = two_taps_response(0.0, 0.5, found->frequency[k], kStep);
        const double error = std::abs(found->response[static_cast<std::size_t>(k)](0, 0) - truth);
        inside += error <= found->radius95(k, 0) ? 1 : 0;
        const bool within =
            std::abs(truth) >= found->magnitude_low(k, 0) && std::abs(truth) <= found->magnitude_high(k, 0);
        magnitude_inside += within ? 1 : 0;
      }
    }
    for (const int covered : {inside, magnitude_inside}) {
      EXPECT_GT(covered, 0.92 * all) << closed;
      EXPECT_LT(covered, 0.98 * all) << closed;
    }
  }
}

TEST(LocalPolynomial, RefusesAPeriodicInputAndATrialThatIsTooShort) {
  const Vector u = periodic_signal(odd_lines(39), 200, 4000, 5);
  const auto periodic = trial_of(u, u, kStep);
  EXPECT_FALSE(local_polynomial_response({&periodic, 1}, {1.0, 20.0}).has_value());
  const Vector few = white_noise(60, 6);
  const auto brief = trial_of(few, few, kStep);
  EXPECT_FALSE(local_polynomial_response({&brief, 1}, {1.0, 20.0}).has_value());
}

}  // namespace local_polynomial_test
}  // namespace mbk::explore
