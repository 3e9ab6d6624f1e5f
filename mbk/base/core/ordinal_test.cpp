#include "mbk/base/core/ordinal.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

TEST(Ordinal, HasTheEndingOfEnglish) {
  for (const auto& [n, word] : {std::pair{0, "0th"},
                                {1, "1st"},
                                {2, "2nd"},
                                {3, "3rd"},
                                {4, "4th"},
                                {11, "11th"},
                                {12, "12th"},
                                {13, "13th"},
                                {20, "20th"},
                                {62, "62nd"},
                                {101, "101st"},
                                {111, "111th"}}) {
    EXPECT_EQ(ordinal(n), word);
  }
}

}  // namespace
}  // namespace mbk
