#include "mbk/base/dsp/integral.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::dsp {
namespace {

constexpr double kRounding = 1e-13;

TEST(CumulativeIntegral, IsExactForAParabolaAndInsideForACubic) {
  const double T = 0.1;
  for (const Index samples : {3, 4, 5, 40}) {
    const Vector t = T * Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
    const Vector parabola = 3.0 * t.array().square() - 4.0 * t.array() + 1.0;
    const Vector want = t.array().cube() - 2.0 * t.array().square() + t.array();
    EXPECT_LT((cumulative_integral(parabola, T) - want).cwiseAbs().maxCoeff(), kRounding * want.cwiseAbs().maxCoeff());
  }
  const Vector t = T * Vector::LinSpaced(40, 0.0, 39.0);
  const Vector got = cumulative_integral(4.0 * t.array().cube(), T), want = t.array().pow(4);
  for (Index i = 2; i < 39; ++i) EXPECT_NEAR(got[i] - got[1], want[i] - want[1], kRounding * want[39]) << i;
}

TEST(CumulativeIntegral, OfASineErrsWithTheFourthPowerOfItsStep) {
  for (const double per_period : {20.0, 40.0, 80.0}) {
    const double step = 2.0 * M_PI / per_period;
    Vector cosine(2000);
    for (Index i = 0; i < cosine.size(); ++i) cosine[i] = std::cos(step * static_cast<double>(i));
    const Vector sine = cumulative_integral(cosine, step);
    double largest = 0.0;
    for (Index i = 0; i < sine.size(); ++i) {
      largest =
          std::max(largest, std::abs(sine[i] - sine[1] - (std::sin(step * static_cast<double>(i)) - std::sin(step))));
    }
    // Counted from the second sample, behind the end, the error is the given one once or, where signs differ, twice.
    EXPECT_LT(largest, 3.0 * 11.0 / 720.0 * std::pow(step, 4)) << per_period;
    EXPECT_GT(largest, 0.5 * 11.0 / 720.0 * std::pow(step, 4)) << per_period;
  }
}

TEST(CumulativeIntegral, OfFewSamplesIsOfStraightLines) {
  EXPECT_EQ(cumulative_integral(Vector(), 1.0).size(), 0);
  EXPECT_EQ(cumulative_integral(Vector::Constant(1, 5.0), 1.0), Vector::Zero(1));
  EXPECT_EQ(cumulative_integral((Vector(2) << 1.0, 3.0).finished(), 0.5), (Vector(2) << 0.0, 1.0).finished());
}

}  // namespace
}  // namespace mbk::dsp
