#include "mbk/present/report/force_comparison_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "mbk/base/core/nan.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::report {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

ForceComparison comparison() {
  const auto of = [](double x, double y) -> Vector { return Eigen::Vector2d(x, y); };
  ForceComparison one;
  one.duration = 50.0;
  one.all = {50000, of(0.0101, -0.0202), of(0.1, 0.2)};
  one.rest = {0, of(kNaN, kNaN), of(kNaN, kNaN)};
  one.reversals = {10000, of(-1e-9, 0.4), of(0.5, 0.6)};
  one.motion = {40000, of(0.03, 0.04), of(0.05, 0.06)};
  one.measured_rms = of(4.0, 5.0);
  one.vaf = of(99.5, -2.0);
  one.gain = of(1.01, 0.97);
  one.correlation = of(0.99, 0.5);
  one.lag = of(0.0167, kNaN);
  one.correlation_at_lag = of(0.999, kNaN);
  one.rest_speed = 0.02;
  one.reversal_window = 0.05;
  return one;
}

TEST(ForceComparisonText, HasOneLineForEachAxisAndEachPart) {
  const std::string text = force_comparison_text(comparison(), "virtual sensor", "force sensor");
  EXPECT_THAT(text, AllOf(HasSubstr("virtual sensor"), HasSubstr("force sensor"), HasSubstr(" 50.0 s")));
  EXPECT_THAT(text, ContainsRegex("Fx +4.00 +0.100 +99.50 +1.010 +0.9900 +16.7"));
  EXPECT_THAT(text, ContainsRegex("Fy +5.00 +0.200 +-2.00 +0.970 +0.5000 +–"));
  EXPECT_THAT(text, ContainsRegex("in motion +80 +0.030 +0.040 +0.050 +0.060"));
  EXPECT_THAT(text, ContainsRegex("all +100 +0.010 +-0.020 +0.100 +0.200"));
  EXPECT_THAT(text, HasSubstr("0.02 rad/s"));
  EXPECT_THAT(text, HasSubstr("50 ms"));
}

TEST(ForceComparisonText, ShowsADashForWhatIsUndefinedAndNoMinusZero) {
  const std::string text = force_comparison_text(comparison(), "a", "b");
  EXPECT_THAT(text, ContainsRegex("at rest +0 +– +– +– +–"));
  EXPECT_THAT(text, ContainsRegex("at reversals +20 +0.000 +0.400"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, Not(HasSubstr("-0.000")));
}

TEST(ForceComparisonText, OfThreeAxesFitsInTheTerminal) {
  ForceComparison one = comparison();
  const Vector large = Vector::Constant(3, -12.345);
  for (ForceAgreement* part : {&one.all, &one.rest, &one.reversals, &one.motion}) part->bias = part->rmse = large;
  for (Vector* of : {&one.measured_rms, &one.vaf, &one.gain, &one.correlation, &one.lag}) *of = large;
  const std::string text = force_comparison_text(one, "virtual sensor", "force sensor");
  EXPECT_THAT(text, HasSubstr("\n  Fz "));
  EXPECT_THAT(text, HasSubstr("RMSE Fz"));
  EXPECT_THAT(text, HasSubstr("bias and RMSE in N"));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(columns(line), kLineColumns) << line;
}

}  // namespace
}  // namespace mbk::report
