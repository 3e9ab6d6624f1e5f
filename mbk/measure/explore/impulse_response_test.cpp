#include "mbk/measure/explore/impulse_response.h"

#include <gtest/gtest.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/measure/explore/test_limb_trials.h"

namespace mbk::explore {
namespace impulse_response_test {

const Vector kResponse{{0.0, 2.0, -5.0, 11.0, 3.0, -1.0, 0.5}};  ///< at lags −3 … 3, times T

Result<ImpulseResponseEstimate> found_of(const ExplorationTrial& trial, const ImpulseResponseOptions& options = {}) {
  const auto signals = limb_signals({&trial, 1});
  if (!signals) return tl::unexpected(signals.error());
  return impulse_response(*signals, options);
}

/// White motion, so that every lag is excited, and a finite response to it.
ExplorationTrial finite(Index samples, std::uint64_t seed, double noise) {
  const Vector x = white_noise(samples, static_cast<unsigned>(seed));
  return trial_of(x, convolved(x, kResponse, -3) + noise * coloured_noise(samples, seed), kStep);
}

/// M ẍ + B ẋ + K x with ẍ and ẋ in closed form: sines of random phases from 0.2 to 12 Hz, at 1 kHz for 40 s.
ExplorationTrial mass_spring_damper(double M, double B, double K, double noise, std::uint64_t seed, double late = 0.0) {
  constexpr Index kSamples = 40000, kSines = 60;
  numeric::Random random(seed);
  Vector x = Vector::Zero(kSamples), f = Vector::Zero(kSamples);
  for (Index k = 1; k <= kSines; ++k) {
    const double omega = 2.0 * std::numbers::pi * 0.2 * static_cast<double>(k);
    const double phase = 2.0 * std::numbers::pi * random.uniform(), height = 0.01 / static_cast<double>(k);
    for (Index i = 0; i < kSamples; ++i) {
      const double at = 1e-3 * omega * static_cast<double>(i) + phase, then = at - omega * late;
      x[i] += height * std::sin(at);
      f[i] += height * ((K - M * omega * omega) * std::sin(then) + B * omega * std::cos(then));
    }
  }
  numeric::Random noises(seed, 1);
  double state = 0.0;
  for (double& value : f) {
    state = 0.99 * state + std::sqrt(1.0 - 0.99 * 0.99) * noises.normal();
    value += noise * state;
  }
  return trial_of(x, f, 1e-3);
}

TEST(ImpulseResponse, OfAFiniteResponseIsThatResponse) {
  const auto found = found_of(finite(3000, 1, 0.0), {.memory_s = 4 * kStep});
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_EQ(found->lag.size(), 9);
  EXPECT_DOUBLE_EQ(found->lag[0], -4 * kStep);
  EXPECT_EQ(found->rank, 9);
  Vector expected = Vector::Zero(9);
  expected.segment(1, 7) = kResponse / kStep;
  constexpr double kRounding = 1e-8;
  EXPECT_LT((found->response.col(0) - expected).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_TRUE((found->excited.array() > 1.0 - 1e-9).all());
  EXPECT_NEAR(found->explained[0].vaf, 100.0, 1e-9);
  EXPECT_FALSE(found->held_out);
}

TEST(ImpulseResponse, IsLeastSquaresOnTheLaggedMotionWhereNothingIsCutOff) {
  const auto trial = finite(2000, 4, 1.0);
  const auto signals = limb_signals({&trial, 1});
  const auto found = impulse_response(*signals, {.memory_s = 2 * kStep, .rank = 5});
  ASSERT_TRUE(found);
  const Index rows = signals->position.rows();
  Matrix X(rows - 4, 6);
  for (Index t = 2; t + 2 < rows; ++t) {
    for (Index lag = -2; lag <= 2; ++lag) X(t - 2, lag + 2) = signals->position(t - lag, 0);
    X(t - 2, 5) = 1.0;
  }
  const Matrix plain = numeric::householder_solve(X, signals->resistance.middleRows(2, rows - 4));
  constexpr double kRounding = 1e-8;
  EXPECT_LT((found->response.col(0) - plain.topRows(5) / kStep).cwiseAbs().maxCoeff(), kRounding);
}

TEST(ImpulseResponse, ChoosesTheShortestMemoryThatHoldsTheResponse) {
  const auto found = found_of(finite(4000, 2, 1.0));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->memory, 0.024, kStep + 1e-12);  // 2 or 3 lags: the third is small
  EXPECT_FALSE(found->memory_at_limit);
}

TEST(ImpulseResponse, SaysWhereTheMemoryIsLongerThanWasTried) {
  const Vector x = binary_motion(6000, 3);
  const auto found = found_of(trial_of(x, convolved(x, reflex_response(100.0, 8.0, 0.0, 120), 0), kStep));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->memory_at_limit);
}

TEST(ImpulseResponse, OfTwoAxesHasEachPathInItsColumn) {
  const Matrix x = white_noise(4000, 2, 7);
  const Vector a{{1.0, 2.0, 0.0}}, b{{0.0, -1.0, 0.0}}, c{{0.5, 0.0, 0.0}}, d{{0.0, 3.0, 1.0}};
  Matrix f(4000, 2);
  f << convolved(x.col(0), a, -1) + convolved(x.col(1), c, -1), convolved(x.col(0), b, -1) + convolved(x.col(1), d, -1);
  const auto found = found_of(trial_of(x, f, kStep), {.memory_s = kStep});
  ASSERT_TRUE(found);
  Matrix expected(3, 4);
  expected << a, b, c, d;
  constexpr double kRounding = 1e-8;
  EXPECT_LT((found->response - expected / kStep).cwiseAbs().maxCoeff(), kRounding);
}

TEST(ImpulseResponse, LeavesOutDirectionsThatTheMotionDoesNotExcite) {
  const auto found = found_of(mass_spring_damper(1.5, 10.0, 120.0, 0.02, 1), {.memory_s = 0.1});
  ASSERT_TRUE(found);
  EXPECT_LT(found->rank, found->directions);
  EXPECT_LT(found->excited.minCoeff(), 0.9);
}

TEST(ImpulseResponse, OfAMassSpringDamperIsOneWithoutBias) {
  const auto found = found_of(mass_spring_damper(1.5, 10.0, 120.0, 0.02, 1));
  ASSERT_TRUE(found) << found.error().line();
  const ResponseModel& model = found->model;
  ASSERT_TRUE(model.identifiable);
  EXPECT_TRUE(model.M_identifiable && model.B_identifiable && model.K_identifiable);
  EXPECT_NEAR(model.M(0, 0), 1.5, 2.0 * model.M_half_width(0, 0));
  EXPECT_NEAR(model.B(0, 0), 10.0, 2.0 * model.B_half_width(0, 0));
  EXPECT_NEAR(model.K(0, 0), 120.0, 2.0 * model.K_half_width(0, 0));
  EXPECT_TRUE(model.enough) << model.p_value;
  EXPECT_LT(model.K_half_width(0, 0), 6.0);
}

TEST(ImpulseResponse, SaysThatMBKIsNotEnoughForAForceThatIsLate) {
  const auto found = found_of(mass_spring_damper(1.5, 10.0, 120.0, 0.02, 1, 0.02));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->model.enough);
  EXPECT_GT(found->explained[0].vaf, found->explained_by_model[0].vaf);
}

TEST(ImpulseResponse, CallsMBKNotIdentifiableUnderOneSine) {
  Vector x(5000);
  for (Index i = 0; i < x.size(); ++i) x[i] = std::sin(0.05 * static_cast<double>(i));
  const auto found = found_of(trial_of(x, 3.0 * x + 0.1 * coloured_noise(5000, 1), kStep));
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_LE(found->rank, 3);
  EXPECT_FALSE(found->model.identifiable && found->model.M_identifiable && found->model.K_identifiable);
}

TEST(ImpulseResponse, HoldsInClosedLoopWhereAReferenceIsKnown) {
  constexpr Index kSamples = 8000;
  const Vector r = binary_motion(kSamples, 5), w = coloured_noise(kSamples, 6);
  const Vector x = r + 0.4 * w;  // the limb moves the robot by its own force
  const Vector f = 50.0 * x - 40.0 * w;
  const auto blind = found_of(trial_of(x, f, kStep), {.memory_s = kStep});
  const auto seeing = found_of(trial_of(x, f, kStep, r), {.memory_s = kStep});
  ASSERT_TRUE(blind && seeing);
  EXPECT_TRUE(seeing->instruments);
  EXPECT_FALSE(blind->instruments);
  const auto stiffness = [](const ImpulseResponseEstimate& found) { return kStep * found.response.col(0).sum(); };
  EXPECT_NEAR(stiffness(*seeing), 50.0, 5.0);
  EXPECT_LT(stiffness(*blind), 40.0);
}

TEST(ImpulseResponse, HasIntervalsThatHoldTheTruth) {
  constexpr int kRuns = 60;
  int held = 0, contradicted = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto found =
        found_of(finite(1200, 50 + static_cast<std::uint64_t>(run), 3.0), {.memory_s = 3 * kStep, .rank = 7});
    ASSERT_TRUE(found);
    for (Index k = 0; k < 7; ++k) {
      held += std::abs(found->response(k, 0) - kResponse[k] / kStep) <= found->half_width(k, 0) ? 1 : 0;
    }
    contradicted += found->model.enough ? 0 : 1;
  }
  // of 420; four standard errors about 95 %
  EXPECT_GE(held, 380);
  EXPECT_LE(held, 417);
  EXPECT_EQ(contradicted, kRuns);  // no M, B and K
}

TEST(ImpulseResponse, RefusesTooLittleAndNothing) {
  EXPECT_EQ(found_of(finite(60, 1, 0.0), {.memory_s = 0.1}).error().kind, ErrorKind::data);
  const Vector x = white_noise(2000, 1), still = Vector::Constant(2000, 2.0);
  EXPECT_EQ(found_of(trial_of(x, still, kStep)).error().kind, ErrorKind::data);
  EXPECT_EQ(found_of(trial_of(still, x, kStep)).error().kind, ErrorKind::data);
}

}  // namespace impulse_response_test
}  // namespace mbk::explore
