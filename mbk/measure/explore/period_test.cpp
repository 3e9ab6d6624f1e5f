#include "mbk/measure/explore/period.h"

#include <gtest/gtest.h>

#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace period_test {

TEST(Period, OfAMultisineIsFoundAndNoFractionOfIt) {
  for (const Index period : {200, 251, 1000}) {
    const Vector r = periodic_signal(odd_lines(39), period, 5 * period + 37, 3);
    EXPECT_EQ(find_period(r, true), period);
    EXPECT_EQ(find_period(r, false), period);
    EXPECT_EQ(find_period(r + 0.1 * r.norm() / std::sqrt(double(r.size())) * white_noise(r.size(), 4), false), period);
  }
}

TEST(Period, OfTwoColumnsIsThatOfBoth) {
  Matrix r(3000, 2);
  r.col(0) = periodic_signal({1, 3, 5, 11}, 300, 3000, 5);
  r.col(1) = periodic_signal({1, 3, 7}, 600, 3000, 6);
  EXPECT_EQ(find_period(r, true), 600);
}

TEST(Period, OfWhatDoesNotRepeatItselfIsNone) {
  EXPECT_FALSE(find_period(white_noise(4000, 7), true).has_value());
  EXPECT_FALSE(find_period(white_noise(4000, 8), false).has_value());
  EXPECT_FALSE(find_period(Vector::Ones(4000), false).has_value()) << "it never moves";
  EXPECT_FALSE(find_period(Vector::LinSpaced(4000, 0.0, 1.0), false).has_value()) << "a ramp";
  const Vector once = periodic_signal(odd_lines(39), 1000, 1500, 9);
  EXPECT_FALSE(find_period(once, true).has_value()) << "one and a half periods";
}

TEST(PeriodicParts, AreTheRealisationsOfAReference) {
  Vector r(3000);
  r << periodic_signal(odd_lines(39), 200, 1000, 1), periodic_signal(odd_lines(39), 200, 1200, 2),
      periodic_signal(odd_lines(39), 200, 800, 3);
  ASSERT_EQ(find_period(r, true), 200);
  const auto parts = periodic_parts(r, 200);
  ASSERT_EQ(parts.size(), 3U);
  const Index ends[] = {1000, 2200, 3000};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(static_cast<double>(parts[k].end), static_cast<double>(ends[k]), 2.0);
    EXPECT_GE(parts[k].end - parts[k].begin, 798);
  }
}

}  // namespace period_test
}  // namespace mbk::explore
