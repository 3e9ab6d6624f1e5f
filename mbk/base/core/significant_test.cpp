#include "mbk/base/core/significant.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

TEST(Significant, HasNoExponentBelowAHundredThousand) {
  EXPECT_EQ(significant(628.3, 2), "630");
  EXPECT_EQ(significant(7912.4, 3), "7910");
  EXPECT_EQ(significant(-356.0, 2), "-360");
  EXPECT_EQ(significant(99960.0, 2), "100000");
  EXPECT_EQ(significant(1.54321, 2), "1.5");
  EXPECT_EQ(significant(123456.0, 2), "1.2e+05");
}

}  // namespace
}  // namespace mbk
