#include "mbk/measure/explore/welch_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace welch_response_test {

using Complex = std::complex<double>;
constexpr double kStep = 0.01;

Complex response_of(double a, double b, double hertz) {
  return two_taps_response(a, b, hertz, kStep);
}

TEST(WelchResponse, OfAGainIsThatGainWithoutDoubt) {
  const Vector u = white_noise(4000, 1);
  const auto trial = trial_of(u, -3.0 * u, kStep);
  const auto found = welch_response({&trial, 1}, {1.0, 20.0});
  ASSERT_TRUE(found.has_value()) << found.error().line();
  ASSERT_EQ(found->size(), 20);
  for (Index k = 0; k < found->size(); ++k) {
    EXPECT_NEAR(std::abs(found->response[static_cast<std::size_t>(k)](0, 0) + 3.0), 0.0, 1e-12);
    EXPECT_NEAR(found->multiple_coherence(k, 0), 1.0, 1e-12);
    EXPECT_NEAR(found->partial_coherence(k, 0), 1.0, 1e-12);
    EXPECT_LT(found->radius95(k, 0), 1e-6);
  }
}

TEST(WelchResponse, OfTwoInputsFindsEachPathAndItsCoherence) {
  const Index n = 200'000;
  Matrix u = white_noise(n, 2, 2);
  u.col(1) += 0.7 * u.col(0);  // inputs that are coherent with each other
  Matrix y(n, 2);
  y.col(0) = two_taps(u.col(0), 2.0, -1.0) + 0.5 * u.col(1);
  y.col(1) = two_taps(u.col(1), 1.0, 0.5);  // nothing of the first
  y += 0.3 * white_noise(n, 2, 77);
  const auto trial = trial_of(u, y, kStep);
  const auto found = welch_response({&trial, 1}, {1.0, 40.0});
  ASSERT_TRUE(found.has_value()) << found.error().line();
  Index inside = 0;
  for (Index k = 0; k < found->size(); ++k) {
    const double hertz = found->frequency[k];
    const Complex truth[2][2] = {{response_of(2.0, -1.0, hertz), 0.5}, {0.0, response_of(1.0, 0.5, hertz)}};
    for (Index j = 0; j < 2; ++j) {
      for (Index i = 0; i < 2; ++i) {
        const Complex error = found->response[static_cast<std::size_t>(k)](i, j) - truth[i][j];
        EXPECT_LT(std::abs(error), 0.05) << hertz;
        inside += std::abs(error) <= found->radius95(k, 2 * j + i) ? 1 : 0;
      }
    }
    EXPECT_LT(found->partial_coherence(k, 1), 0.05) << "the first input does nothing to the second output";
    EXPECT_GT(found->multiple_coherence(k, 1), 0.5);
  }
  EXPECT_GT(inside, 4 * found->size() * 85 / 100);
}

TEST(WelchResponse, InAClosedLoopIsRightByTheReferenceAndBiasedWithoutIt) {
  // u = r − y, y = G u + v with G = 2 e^(−jωT): noise goes round the loop.
  const Index n = 200'000;
  const Vector r = white_noise(n, 3), v = white_noise(n, 4);
  Vector u(n), y(n);
  double before = 0.0;
  for (Index i = 0; i < n; ++i) {
    y[i] = 0.5 * before + v[i];
    u[i] = r[i] - y[i];
    before = u[i];
  }
  const auto with = trial_of(u, y, kStep, r), without = trial_of(u, y, kStep);
  const auto right = welch_response({&with, 1}, {1.0, 40.0}), biased = welch_response({&without, 1}, {1.0, 40.0});
  ASSERT_TRUE(right.has_value() && biased.has_value());
  EXPECT_TRUE(right->by_reference);
  EXPECT_FALSE(biased->by_reference);
  double error = 0.0, bias = 0.0;
  Index inside = 0;
  for (Index k = 0; k < right->size(); ++k) {
    const Complex truth = response_of(0.0, 0.5, right->frequency[k]);
    const auto at = static_cast<std::size_t>(k);
    error += std::norm(right->response[at](0, 0) - truth);
    bias += std::norm(biased->response[at](0, 0) - truth);
    inside += std::abs(right->response[at](0, 0) - truth) <= right->radius95(k, 0) ? 1 : 0;
  }
  EXPECT_GT(bias, 50.0 * error);
  EXPECT_GE(inside, 33) << "of 40";
}

TEST(WelchResponse, OfSeveralTrialsAveragesThem) {
  const Vector u = white_noise(6000, 5), y = two_taps(u, 1.0, 1.0) + white_noise(6000, 6);
  const ExplorationTrial two[] = {trial_of(u.head(3000), y.head(3000), kStep),
                                  trial_of(u.tail(3000), y.tail(3000), kStep)};
  const auto both = welch_response(two, {1.0, 40.0}), one = welch_response({two, 1}, {1.0, 40.0});
  ASSERT_TRUE(both.has_value() && one.has_value());
  EXPECT_NEAR(both->averages, 2.0 * one->averages, 1e-9);
}

TEST(WelchResponse, RefusesWhatCannotBeAveraged) {
  const Vector u = white_noise(400, 7);
  const ExplorationTrial one = trial_of(u, u, kStep);
  EXPECT_FALSE(welch_response({}, {}).has_value());
  EXPECT_FALSE(welch_response({&one, 1}, {10.0, 20.0}).has_value()) << "longer than the trial";
  EXPECT_FALSE(welch_response({&one, 1}, {4.0, 20.0}).has_value()) << "one segment shows no noise";
  EXPECT_FALSE(welch_response({&one, 1}, {0.02, 20.0}).has_value()) << "two samples";
  EXPECT_FALSE(welch_response({&one, 1}, {1.0, 0.5}).has_value()) << "no line below";
  const ExplorationTrial other = trial_of(u, u, 2.0 * kStep);
  const ExplorationTrial both[] = {one, other};
  const auto mixed = welch_response(both, {1.0, 20.0});
  ASSERT_FALSE(mixed.has_value());
  EXPECT_NE(mixed.error().line().find("50 Hz"), std::string::npos) << mixed.error().line();
}

}  // namespace welch_response_test
}  // namespace mbk::explore
