#include "mbk/base/numeric/random.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace mbk::numeric {
namespace {

TEST(Random, IsThatOfTheStandardBitForBit) {
  for (const std::uint64_t seed :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{5'489'000'000'123}, ~std::uint64_t{0}}) {
    for (const std::uint32_t stream : {0U, 1U, 0x80000000U}) {
      std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U), stream};
      std::mt19937_64 standard(sequence);
      Random ours(seed, stream);
      for (int i = 0; i < 4 * 312 + 1; ++i) {
        ASSERT_EQ(ours.uniform(), static_cast<double>(standard() >> 11U) * 0x1p-53)
            << seed << ' ' << stream << ' ' << i;
        // Of every number but the least likely 2⁻⁶⁴: all bits of a draw.
        ASSERT_EQ(ours.below(~std::uint64_t{0}), standard() % ~std::uint64_t{0}) << seed << ' ' << stream << ' ' << i;
      }
    }
  }
}

TEST(Random, StreamsOfOneSeedDiffer) {
  EXPECT_NE(Random(1, 0).uniform(), Random(1, 1).uniform());
  EXPECT_NE(Random(1, 0).uniform(), Random(2, 0).uniform());
  EXPECT_NE(Random(1).uniform(), Random(1 + (std::uint64_t{1} << 32)).uniform());
}

TEST(Random, BelowReachesEveryNumberAboutEquallyOften) {
  Random random(3);
  std::vector<int> counts(7);
  for (int i = 0; i < 70000; ++i) ++counts[random.below(7)];
  for (const int count : counts) EXPECT_NEAR(count, 10000, 5 * 93);  // 5 standard deviations, √(n p (1−p)) = 92.6
}

TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  Random random(5);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0, fourths = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double w = random.normal();
    sum += w;
    squares += w * w;
    fourths += w * w * w * w;
  }
  // 5 standard errors of each moment: √(1/n), √(2/n), √(96/n)
  EXPECT_NEAR(sum / kDraws, 0.0, 5 * 0.00224);
  EXPECT_NEAR(squares / kDraws, 1.0, 5 * 0.00317);
  EXPECT_NEAR(fourths / kDraws, 3.0, 5 * 0.0219);
}

}  // namespace
}  // namespace mbk::numeric
