#include "mbk/model/perturbation/minimum_jerk.h"

#include <gtest/gtest.h>

#include <limits>

namespace mbk::perturbation {
namespace minimum_jerk_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(MinimumJerk, FromRestToRestIsThePublishedPolynomial) {
  const MinimumJerk path({0, 0, 0}, {1, 0, 0}, 2.0);
  const double s = 0.3;  // 10s³ − 15s⁴ + 6s⁵ and its derivatives
  const Jet<double> p = path.at(2.0 * s);
  EXPECT_NEAR(p.value, s * s * s * (10 - 15 * s + 6 * s * s), 8 * kEps);
  EXPECT_NEAR(p.first, 30 * s * s * (1 - s) * (1 - s) / 2.0, 32 * kEps);
  EXPECT_NEAR(p.second, 60 * s * (1 - s) * (1 - 2 * s) / 4.0, 64 * kEps);
}

TEST(MinimumJerk, MeetsBothStates) {
  const Jet<double> from{0.3, -2.0, 5.0}, to{-0.1, 0.7, -4.0};
  const MinimumJerk path(from, to, 0.8);
  const double step = 1e-9;  // jerk up to about 300 turns into 300·step
  for (const auto& [t, state] : {std::pair{step, from}, std::pair{0.8 - step, to}}) {
    EXPECT_NEAR(path.at(t).value, state.value, 1e-8);
    EXPECT_NEAR(path.at(t).first, state.first, 1e-7);
    EXPECT_NEAR(path.at(t).second, state.second, 1e-6);
  }
  EXPECT_EQ(path.at(-1.0).value, from.value);
  EXPECT_EQ(path.at(9.0).second, to.second);
}

}  // namespace minimum_jerk_test
}  // namespace mbk::perturbation
