#include "mbk/present/result/force_comparison_json.h"

#include <gtest/gtest.h>

#include <limits>

namespace mbk::result {
namespace {


Vector of(double x, double y) {
  return Eigen::Vector2d(x, y);
}

TEST(ForceComparisonJson, HasEveryNumberInSiAndNullForWhatIsUndefined) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  ForceComparison comparison;
  comparison.duration = 12.5;
  comparison.all = {12500, of(0.01, -0.02), of(0.1, 0.2)};
  comparison.rest = {0, of(kNaN, kNaN), of(kNaN, kNaN)};
  comparison.reversals = {500, of(0.3, 0.4), of(0.5, 0.6)};
  comparison.motion = {12000, of(0.03, 0.04), of(0.05, 0.06)};
  comparison.measured_rms = of(4.0, 5.0);
  comparison.vaf = of(99.5, -2.0);
  comparison.gain = of(1.01, 0.97);
  comparison.correlation = of(0.99, 0.5);
  comparison.lag = of(0.0167, kNaN);
  comparison.correlation_at_lag = of(0.999, kNaN);
  comparison.rest_speed = 0.02;
  comparison.reversal_window = 0.05;
  comparison.longest_lag = 0.1;
  const Json read = force_comparison_json(comparison);
  EXPECT_EQ(read["duration_s"], 12.5);
  EXPECT_EQ(read["all"], (Json{{"rows", 12500}, {"bias", {0.01, -0.02}}, {"RMSE", {0.1, 0.2}}}));
  EXPECT_EQ(read["rest"]["rows"], 0);
  EXPECT_EQ(read["rest"]["bias"], Json({nullptr, nullptr}));
  EXPECT_EQ(read["reversals"]["RMSE"], Json({0.5, 0.6}));
  EXPECT_EQ(read["motion"]["bias"], Json({0.03, 0.04}));
  EXPECT_EQ(read["measured_rms"], Json({4.0, 5.0}));
  EXPECT_EQ(read["VAF"], Json({99.5, -2.0}));
  EXPECT_EQ(read["gain"], Json({1.01, 0.97}));
  EXPECT_EQ(read["correlation"], Json({0.99, 0.5}));
  EXPECT_EQ(read["lag_s"], Json({0.0167, nullptr}));
  EXPECT_EQ(read["correlation_at_lag"], Json({0.999, nullptr}));
  EXPECT_EQ(read["rest_speed"], 0.02);
  EXPECT_EQ(read["reversal_window_s"], 0.05);
  EXPECT_EQ(read["longest_lag_s"], 0.1);
}

}  // namespace
}  // namespace mbk::result
