#include "mbk/experiment/control/way_prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "tests/support/allocations.h"

namespace mbk::control {
namespace way_prediction_test {

/// A hand that passes the trigger at t = 0 on a cubic of its own.
struct Hand {
  Vector2d speed, acceleration, jerk;
  [[nodiscard]] Vector2d at(double t) const { return t * speed + t * t / 2.0 * acceleration + t * t * t / 6.0 * jerk; }
  [[nodiscard]] Vector2d velocity_at(double t) const { return speed + t * acceleration + t * t / 2.0 * jerk; }
};

Hand drawn(numeric::Random& random) {
  const auto about = [&](double mean, double spread) { return mean + spread * random.normal(); };
  return {
      {about(0.02, 0.03), about(0.5, 0.05)}, {about(0.0, 0.2), about(1.0, 0.5)}, {about(0.0, 0.2), about(-8.0, 0.3)}};
}

WayPrediction::Past past_of(const Hand& hand) {
  WayPrediction::Past past;
  past[0] = 1.0;
  for (int k = 0; k < WayPrediction::kLags; ++k) past.segment<2>(1 + 2 * k) = hand.at(-(k + 1) * WayPrediction::kLag);
  return past;
}

WayPrediction::Future future_of(const Hand& hand) {
  WayPrediction::Future future;
  for (int k = 0; k < WayPrediction::kKnots; ++k) future.col(k) = hand.at((k + 1) * WayPrediction::kStep);
  return future;
}

WayPrediction taught(int reaches, std::uint64_t seed) {
  numeric::Random random(seed);
  WayPrediction prediction;
  for (int i = 0; i < reaches; ++i) {
    const Hand hand = drawn(random);
    prediction.learn(past_of(hand), future_of(hand));
  }
  return prediction;
}

WayPrediction::Way predicted(const WayPrediction& prediction, const Hand& hand) {
  return prediction.predict(past_of(hand), hand.at(-WayPrediction::kStep));
}

TEST(WayPrediction, IsTheRidgeRegressionOfTheStackedReaches) {
  constexpr int kReaches = 30, kF = WayPrediction::kFeatures, kTargets = 2 * WayPrediction::kKnots;
  numeric::Random random(1);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(kReaches + kF - 1, kF), Y = Eigen::MatrixXd::Zero(P.rows(), kTargets);
  WayPrediction prediction;
  for (int i = 0; i < kReaches; ++i) {
    const Hand hand = drawn(random);
    prediction.learn(past_of(hand), future_of(hand));
    P.row(i) = past_of(hand).transpose();
    Y.row(i) = future_of(hand).reshaped().transpose();
  }
  for (int k = 1; k < kF; ++k) P(kReaches + k - 1, k) = std::sqrt(kReaches) * WayPrediction::kSigma;  // the penalty
  const Eigen::MatrixXd twin = numeric::PivotedQr(P).solve(Y);
  const Hand hand = drawn(random);
  const Eigen::VectorXd expected = twin.transpose() * past_of(hand);
  const WayPrediction::Way way = predicted(prediction, hand);
  for (int k = 0; k < WayPrediction::kKnots; ++k) {
    // squaring the condition of P costs digits: 0.1 µm
    EXPECT_LT((way.at((k + 1) * WayPrediction::kStep).value - expected.segment<2>(2 * k)).norm(), 1e-7) << k;
  }
}

TEST(WayPrediction, LeavesATenthOfHowHandsDifferWhoseFutureIsLinearInTheirPast) {
  const WayPrediction prediction = taught(40, 1);
  numeric::Random random(2);
  constexpr double kLater = 0.2;
  constexpr int kHands = 100;
  const Vector2d mean = Hand{{0.02, 0.5}, {0.0, 1.0}, {0.0, -8.0}}.at(kLater);
  double left = 0.0, differing = 0.0;
  for (int i = 0; i < kHands; ++i) {
    const Hand hand = drawn(random);
    left += (predicted(prediction, hand).at(kLater).value - hand.at(kLater)).squaredNorm();
    differing += (hand.at(kLater) - mean).squaredNorm();
  }
  EXPECT_LT(std::sqrt(left / differing), 0.1);
  EXPECT_GT(std::sqrt(differing / kHands), 0.01);
}

TEST(WayPrediction, BeginsWhereTheHandIsAndGoesOnAsItWent) {
  const WayPrediction prediction = taught(30, 3);
  numeric::Random random(4);
  const Hand hand = drawn(random);
  const WayPrediction::Way way = predicted(prediction, hand);
  EXPECT_EQ(way.at(0.0).value, Vector2d(0.0, 0.0));
  EXPECT_LT((way.at(0.0).first - hand.speed).norm(), 0.01);
}

TEST(WayPrediction, HasAVelocityThatIsTheSlopeOfItsPlace) {
  const WayPrediction prediction = taught(20, 5);
  numeric::Random random(6);
  const WayPrediction::Way way = predicted(prediction, drawn(random));
  constexpr double kStep = 1e-6;
  for (double t = 0.0013; t < 0.6; t += 0.0171) {
    const Vector2d slope = (way.at(t + kStep).value - way.at(t - kStep).value) / (2.0 * kStep);
    EXPECT_LT((way.at(t).first - slope).norm(), 1e-6) << t;
  }
  EXPECT_EQ(way.at(10.0).value, way.at(0.64).value);
}

TEST(WayPrediction, ToldTheSameReachAgainAndAgainPredictsIt) {
  numeric::Random random(7);
  const Hand hand = drawn(random);
  WayPrediction prediction;
  for (int i = 0; i < 12; ++i) prediction.learn(past_of(hand), future_of(hand));
  const WayPrediction::Way way = predicted(prediction, hand);
  EXPECT_LT((way.at(0.2).value - hand.at(0.2)).norm(), 1e-9);
  EXPECT_NEAR(way.leverage(), 1.0 / 12.0, 1e-9);
}

TEST(WayPrediction, HasALargeLeverageForAReachUnlikeTheOthers) {
  const WayPrediction prediction = taught(40, 8);
  numeric::Random random(9);
  Hand hand = drawn(random);
  EXPECT_LT(predicted(prediction, hand).leverage(), 0.7);
  hand.speed = {0.5, -0.1};
  EXPECT_GT(predicted(prediction, hand).leverage(), 1.0);
}

TEST(WayPrediction, DoesNotAllocate) {
  WayPrediction prediction = taught(12, 10);
  numeric::Random random(11);
  const Hand hand = drawn(random);
  const WayPrediction::Past past = past_of(hand);
  const WayPrediction::Future future = future_of(hand);
  const long before = testing_support::allocations();
  prediction.learn(past, future);
  const Vector2d place = prediction.predict(past, {0.0, -0.005}).at(0.123).value;
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_TRUE(place.allFinite());
}

}  // namespace way_prediction_test
}  // namespace mbk::control
