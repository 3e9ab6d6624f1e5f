#include "mbk/base/core/natural_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mbk {
namespace {

TEST(NaturalOrder, NumbersStandByTheirValue) {
  const std::vector<std::string> sorted{"a", "a1b2", "a1b10", "a2", "a007", "a10", "b", "b0", "c"};
  std::vector<std::string> names(sorted.rbegin(), sorted.rend());
  std::ranges::sort(names, in_natural_order);
  EXPECT_EQ(names, sorted);
}

TEST(NaturalOrder, IsNotBeforeItself) {
  for (const char* name : {"", "a", "10", "trial_10"}) EXPECT_FALSE(in_natural_order(name, name)) << name;
}

}  // namespace
}  // namespace mbk
