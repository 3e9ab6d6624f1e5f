#include "mbk/simulate/laboratory/load_cell.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mbk::laboratory {
namespace load_cell_test {

using Eigen::Vector2d;

constexpr double kTick = 1e-3;

LoadCellOptions<2> silent() {
  return {.white_noise = 0.0};
}

TEST(LoadCell, AddsGainErrorCrosstalkAndOffset) {
  LoadCellOptions<2> options = silent();
  options.gain << 1.02, 0.01, -0.03, 0.97;
  options.offset = {0.5, -0.25};
  LoadCell<2> cell = LoadCell<2>::create(options, kTick, 1).value();
  const Vector2d added = cell.added({10.0, 20.0});
  EXPECT_NEAR(added[0], 0.02 * 10.0 + 0.01 * 20.0 + 0.5, 1e-14);
  EXPECT_NEAR(added[1], -0.03 * 10.0 - 0.03 * 20.0 - 0.25, 1e-14);
}

TEST(LoadCell, ADelayReadsTheForceOfBefore) {
  LoadCellOptions<2> options = silent();
  options.delay = 2.5 * kTick;
  LoadCell<2> cell = LoadCell<2>::create(options, kTick, 1).value();
  EXPECT_EQ(cell.delay(), 2.5 * kTick);
  for (int k = 0; k < 10; ++k) {
    const Vector2d force(3.0 * k, -k);
    const Vector2d read = force + cell.added(force);
    const double then = std::max(0.0, k - 2.5);
    if (k == 1 || k == 2) continue;  // the first force is taken for what was there before
    EXPECT_NEAR((read - Vector2d(3.0 * then, -then)).norm(), 0.0, 1e-12) << k;
  }
}

TEST(LoadCell, AResolutionRoundsWhatIsRead) {
  LoadCellOptions<2> options = silent();
  options.resolution = 0.5;
  LoadCell<2> cell = LoadCell<2>::create(options, kTick, 1).value();
  EXPECT_NEAR((Vector2d(1.3, -0.8) + cell.added({1.3, -0.8}) - Vector2d(1.5, -1.0)).norm(), 0.0, 1e-12);
}

TEST(LoadCell, WithEverythingOffAddsNothing) {
  LoadCell<2> cell = LoadCell<2>::create(silent(), kTick, 1).value();
  EXPECT_EQ(cell.added({12.3, -4.5}), Vector2d::Zero());
}

TEST(LoadCell, EachAxisHasTheSumOfItsNoises) {
  LoadCellOptions<2> options;
  options.white_noise = 0.3;
  options.coloured_noise = 0.4;
  options.coloured_bandwidth = Hertz(100.0);
  LoadCell<2> cell = LoadCell<2>::create(options, kTick, 1).value();
  constexpr int kCount = 200000;
  Vector2d square = Vector2d::Zero();
  double product = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const Vector2d added = cell.added({1.0, 1.0});
    square += added.cwiseAbs2() / kCount;
    product += added[0] * added[1] / kCount;
  }
  const double five_errors =
      5.0 * 0.25 * std::sqrt(4.0 / kCount);  // twice the white variance: the other part has memory
  EXPECT_NEAR(square[0], 0.25, five_errors);
  EXPECT_NEAR(square[1], 0.25, five_errors);
  EXPECT_NEAR(product, 0.0, five_errors);
}

TEST(LoadCell, DriftsSteadilyWithoutNoise) {
  LoadCellOptions<2> options = silent();
  options.drift_rate = {0.1, -0.2};
  LoadCell<2> cell = LoadCell<2>::create(options, kTick, 1).value();
  Vector2d added = Vector2d::Zero();
  for (int k = 0; k <= 2000; ++k) added = cell.added({5.0, 5.0});
  EXPECT_LT((added - Vector2d(0.2, -0.4)).norm(), 1e-14);
}

TEST(LoadCell, OneNoiseLeavesTheOthersAsTheyWere) {
  LoadCellOptions<2> walking = silent(), noisy = silent();
  walking.drift_walk = noisy.drift_walk = 0.1;
  noisy.white_noise = 0.02;
  LoadCellOptions<2> white;
  LoadCell<2> drift = LoadCell<2>::create(walking, kTick, 5).value(),
              both = LoadCell<2>::create(noisy, kTick, 5).value(),
              only_white = LoadCell<2>::create(white, kTick, 5).value();
  for (int k = 0; k < 1000; ++k) {
    const Vector2d parts = drift.added({1.0, 2.0}) + only_white.added({1.0, 2.0});
    ASSERT_LT((both.added({1.0, 2.0}) - parts).norm(), 1e-15) << k;
  }
}

TEST(LoadCell, RefusesNegativeNoise) {
  LoadCellOptions<2> options;
  options.white_noise = -0.1;
  EXPECT_THAT(LoadCell<2>::create(options, kTick, 1).error().message,
              AllOf(testing::HasSubstr("noise"), testing::HasSubstr("-0.1 N")));
  options = {};
  options.coloured_bandwidth = Hertz(0.0);
  EXPECT_THAT(LoadCell<2>::create(options, kTick, 1).error().message,
              AllOf(testing::HasSubstr("bandwidth"), testing::HasSubstr(" 0 Hz")));
  options = {};
  options.gain(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(LoadCell<2>::create(options, kTick, 1));
  EXPECT_FALSE(LoadCell<2>::create({}, 0.0, 1));
}

}  // namespace load_cell_test
}  // namespace mbk::laboratory
