#include "mbk/base/numeric/golden_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace mbk::numeric {
namespace {

TEST(GoldenSection, ClosesInOnAMinimum) {
  double low_end = 0.0, high_end = 0.0;
  golden_section(
      -1.0, 5.0, [](double x) { return std::abs(x - 1.25); }, std::less<>{},
      [&](double low, double high) {
        low_end = low;
        high_end = high;
        return high - low > 1e-9;
      });
  EXPECT_LE(low_end, 1.25);
  EXPECT_GE(high_end, 1.25);
  EXPECT_LT(high_end - low_end, 1e-9);
}

TEST(GoldenSection, LooksOnceForEachSection) {
  int looks = 0, sections = 0;
  double width = 0.0;
  golden_section(
      0.0, 1.0,
      [&](double x) {
        ++looks;
        return x * (1.0 - x);
      },
      std::greater<>{},
      [&](double low, double high) {
        width = high - low;
        return sections++ < 10;
      });
  EXPECT_EQ(looks, 12);
  EXPECT_NEAR(width, std::pow(0.6180339887498949, 10), 1e-12);
}

}  // namespace
}  // namespace mbk::numeric
