#include "mbk/model/perturbation/underdamped_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::perturbation {
namespace {

TEST(UnderdampedFilter, PassesHalfThePowerAtItsBandwidthAndLessAbove) {
  for (const double damping_ratio : {0.01, 0.1, 0.5, 0.9}) {
    const UnderdampedFilter filter = UnderdampedFilter::create(damping_ratio).value();
    const double edge = filter.bandwidth().value;
    EXPECT_NEAR(filter.power_gain(Hertz(edge)), 0.5, 1e-13) << damping_ratio;
    for (double f = edge * 1.001; f < 20.0 * edge; f *= 1.1) {
      EXPECT_LT(filter.power_gain(Hertz(f)), 0.5) << damping_ratio << ", " << f << " Hz";
    }
  }
}

TEST(UnderdampedFilter, TwoStepsOfTimeAreOne) {
  const UnderdampedFilter filter = UnderdampedFilter::create().value();
  const Jet<double> once = filter.response(0.3, -2.0, 1.5, 0.7);
  const Jet<double> half = filter.response(0.3, -2.0, 1.5, 0.25);
  const Jet<double> twice = filter.response(half.value, half.first, 1.5, 0.45);
  EXPECT_NEAR(twice.value, once.value, 1e-14);  // values up to 3, rates up to 50, second derivatives up to 500
  EXPECT_NEAR(twice.first, once.first, 1e-13);
  EXPECT_NEAR(twice.second, once.second, 1e-12);
}

TEST(UnderdampedFilter, KeepsTheStateItIsGiven) {
  const Jet<double> start = UnderdampedFilter::create().value().response(0.3, -2.0, 1.5, 0.0);
  EXPECT_NEAR(start.value, 0.3, 1e-15);
  EXPECT_EQ(start.first, -2.0);
  EXPECT_NEAR(start.second, 225.0 * 1.2 + 3.0 * 2.0, 1e-12);
}

}  // namespace
}  // namespace mbk::perturbation
