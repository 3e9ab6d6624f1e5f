#include "mbk/measure/explore/parallel_cascade.h"

#include <gtest/gtest.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/measure/explore/second_order_reflex.h"
#include "mbk/measure/explore/test_limb_trials.h"

namespace mbk::explore {
namespace parallel_cascade_test {

constexpr Index kSamples = 5000;  ///< 40 s
constexpr Index kLags = 100;
const Vector kIntrinsic{{8.0, 40.0, 15.0}};  ///< at lags −1, 0, 1, times T

Result<ParallelCascadeEstimate> found_of(const ExplorationTrial& trial) {
  const auto signals = limb_signals({&trial, 1});
  if (!signals) return tl::unexpected(signals.error());
  return parallel_cascade(*signals);
}

/// A limb with a reflex of that gain to stretch in one direction, +1 or −1, and a linear response as slow beside it.
ExplorationTrial limb(double gain, double direction, double linear, double noise, std::uint64_t seed) {
  const Vector x = binary_motion(kSamples, seed), v = velocity_of(x);
  const Vector g = reflex_response(1.0, 25.0, 0.06, kLags);
  const Vector f = convolved(x, kIntrinsic, -1) + gain * convolved((direction * v).cwiseMax(0.0), g, 0) +
                   linear * convolved(v, g, 0) + noise * coloured_noise(kSamples, seed);
  ExplorationTrial trial = trial_of(x, f, kStep);
  trial.split = 4000;
  return trial;
}

TEST(ParallelCascade, FindsAReflexAndTheDirectionOfItsStretch) {
  for (const double direction : {1.0, -1.0}) {
    const auto found = found_of(limb(4.0 * direction, direction, 0.0, 3.0, 1));
    ASSERT_TRUE(found) << found.error().line();
    ASSERT_EQ(found->found, DelayedResponse::reflex) << found->why;
    EXPECT_EQ(found->direction[0], direction);
    EXPECT_EQ(found->candidates.front().direction[0], direction);
    EXPECT_NEAR(found->delay, 0.068, 1.5 * kStep);  // it begins at 60 ms with nothing
    EXPECT_LE(found->delay_low, found->delay);
    EXPECT_GE(found->delay_high, found->delay);
    EXPECT_NEAR(found->gain[0].value, 4.0 * direction, 2.0 * found->gain[0].half_width);
    EXPECT_GT(found->gain_along.value, 0.0);
    EXPECT_TRUE(found->gain_identifiable);
    ASSERT_TRUE(found->second_order);
    EXPECT_NEAR(found->second_order->delay.value, 0.06, 0.01);
    EXPECT_NEAR(found->second_order->gain[0].value, 4.0 * direction, 2.0 * found->second_order->gain[0].half_width);
    ASSERT_EQ(found->shares.size(), 1u);
    EXPECT_TRUE(found->held_out);
    EXPECT_GT(found->shares[0].both.vaf, found->shares[0].intrinsic_alone.vaf + 1.0);
    EXPECT_EQ(found->nonlinearity.size(), 1);
  }
}

TEST(ParallelCascade, PutsTheLimbTogetherAgainWhereThereIsNoNoise) {
  const auto found = found_of(limb(4.0, 1.0, 0.0, 0.0, 2));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->found, DelayedResponse::reflex);
  EXPECT_GT(found->shares[0].both.vaf, 99.99);
}

TEST(ParallelCascade, CreditsNoReflexToAResponseInBothDirections) {
  const auto found = found_of(limb(0.0, 1.0, 4.0, 3.0, 1));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->found, DelayedResponse::both_directions) << found->why;
  EXPECT_EQ(found->candidates.front().direction.size(), 0);
  EXPECT_EQ(found->direction.size(), 0);
  EXPECT_FALSE(found->second_order);
}

TEST(ParallelCascade, CreditsNoReflexToALimbWithoutOne) {
  constexpr int kRuns = 25;
  int credited = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto found = found_of(limb(0.0, 1.0, 0.0, 6.0, 10 + static_cast<std::uint64_t>(run)));
    ASSERT_TRUE(found);
    credited += found->found == DelayedResponse::reflex ? 1 : 0;
  }
  EXPECT_LE(credited, 2);  // at 1 %, three of 25 have a chance of 0.2 %
}

TEST(ParallelCascade, FindsTheDirectionInAPlane) {
  const Matrix x = (Matrix(kSamples, 2) << binary_motion(kSamples, 1), binary_motion(kSamples, 2)).finished();
  const Vector e = Vector{{-std::sqrt(0.5), std::sqrt(0.5)}};
  const Vector stretch = (velocity_of(x.col(0)) * e[0] + velocity_of(x.col(1)) * e[1]).cwiseMax(0.0);
  const Vector answer = convolved(stretch, reflex_response(5.0, 25.0, 0.06, kLags), 0);
  Matrix f(kSamples, 2);
  f << 40.0 * x.col(0) - 0.7 * answer + 3.0 * coloured_noise(kSamples, 3),
      60.0 * x.col(1) + 0.7 * answer + 3.0 * coloured_noise(kSamples, 4);
  const auto found = found_of(trial_of(x, f, kStep));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->found, DelayedResponse::reflex) << found->why;
  EXPECT_LT((found->direction - e).norm(), 1e-9);
  EXPECT_NEAR(found->gain[0].value, -3.5, 2.0 * found->gain[0].half_width);
  EXPECT_NEAR(found->gain[1].value, 3.5, 2.0 * found->gain[1].half_width);
  EXPECT_GT(found->gain_along.value, 0.0);
}

TEST(ParallelCascade, FindsThatTheReflexIsNotLinearInSpeed) {
  const Vector x = binary_motion(kSamples, 3), v = velocity_of(x), stretch = v.cwiseMax(0.0);
  const Vector square = stretch.cwiseAbs2() / stretch.maxCoeff();
  const Vector f = convolved(x, kIntrinsic, -1) + convolved(square, reflex_response(6.0, 25.0, 0.06, kLags), 0) +
                   coloured_noise(kSamples, 8);
  const auto found = found_of(trial_of(x, f, kStep));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->found, DelayedResponse::reflex);
  ASSERT_GE(found->nonlinearity.size(), 2);
  const auto N = [&](double share) {
    double sum = 0.0;
    for (Index k = found->nonlinearity.size() - 1; k >= 0; --k) sum = (sum + found->nonlinearity[k]) * share;
    return sum;
  };
  EXPECT_NEAR(N(0.5) / N(1.0), 0.25, 0.05);
}

TEST(ParallelCascade, SaysNotIdentifiableOfAShortRecording) {
  const ExplorationTrial whole = limb(4.0, 1.0, 0.0, 3.0, 1);
  const auto brief = trial_of(whole.input.topRows(900), whole.output.topRows(900), kStep);
  const auto found = found_of(brief);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->found, DelayedResponse::not_identifiable);
  EXPECT_NE(found->why.find("rows"), std::string::npos);
}

TEST(ParallelCascade, RefusesAForceThatNeverVaries) {
  const Vector x = binary_motion(kSamples, 1);
  EXPECT_EQ(found_of(trial_of(x, Vector::Constant(kSamples, 1.0), kStep)).error().kind, ErrorKind::data);
}

TEST(SecondOrderReflex, IsWhatMadeTheResponse) {
  Matrix coefficients = Matrix::Zero(115, 1);  // weighted by a triangle around each lag, in 2000 steps
  constexpr int kSteps = 1000;
  for (Index k = 0; k < 115; ++k) {
    for (int step = -kSteps; step <= kSteps; ++step) {
      const double away = static_cast<double>(step) / kSteps, t = kStep * (static_cast<double>(5 + k) + away) - 0.055;
      if (t > 0.0) {
        coefficients(k, 0) += kStep / kSteps * (1.0 - std::abs(away)) * 3.0 * 400.0 * t * std::exp(-20.0 * t);
      }
    }
  }
  const auto found =
      fit_second_order(Matrix::Identity(115, 115), coefficients, {1e-4 * Matrix::Identity(115, 115)}, kStep, 5, 4000.0);
  ASSERT_TRUE(found);
  constexpr double kOfQuadrature = 2e-3;  // the response has a corner where it begins
  EXPECT_NEAR(found->gain[0].value, 3.0, kOfQuadrature);
  EXPECT_NEAR(found->delay.value, 0.055, kOfQuadrature);
  EXPECT_NEAR(found->frequency.value, 20.0 / (2.0 * std::numbers::pi), kOfQuadrature);
  EXPECT_NEAR(found->damping.value, 1.0, kOfQuadrature);
  EXPECT_GT(found->p_value, 0.5);
  EXPECT_FALSE(fit_second_order(Matrix::Identity(115, 115), coefficients, {Matrix::Zero(115, 115)}, kStep, 5, 4000.0));
}

}  // namespace parallel_cascade_test
}  // namespace mbk::explore
