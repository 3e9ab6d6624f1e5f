#include "mbk/model/perturbation/odd_grid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mbk/model/perturbation/schedule_plan.h"

namespace mbk::perturbation {
namespace odd_grid_test {

TEST(OddGrid, LeavesOneOutOfEveryGroup) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto lines = odd_grid(47, 4, seed);
    ASSERT_TRUE(lines.has_value());
    EXPECT_EQ(lines->size(), 18U);
    for (int first = 1; first < 47; first += 8) {
      const auto inside = std::ranges::count_if(*lines, [&](int k) { return k >= first && k < first + 8; });
      EXPECT_EQ(inside, 3) << first;
    }
    EXPECT_TRUE(std::ranges::all_of(*lines, [](int k) { return k % 2 == 1; }));
  }
  EXPECT_NE(odd_grid(47, 4, 1).value(), odd_grid(47, 4, 2).value());
}

TEST(OddGrid, WithoutGroupsIsWholeAndARemainderToo) {
  EXPECT_EQ(odd_grid(9, 0, 1).value(), (std::vector{1, 3, 5, 7, 9}));
  EXPECT_EQ(odd_grid(10, 0, 1).value(), (std::vector{1, 3, 5, 7, 9}));
  const auto lines = odd_grid(13, 4, 1).value();  // 1 3 5 7 | 9 11 13
  EXPECT_EQ(lines.size(), 6U);
  EXPECT_TRUE(std::ranges::equal(std::vector{9, 11, 13}, std::vector(lines.end() - 3, lines.end())));
}

TEST(OddGrid, RefusesWhatLeavesNoLine) {
  EXPECT_FALSE(odd_grid(0, 4, 1).has_value());
  EXPECT_FALSE(odd_grid(9, 1, 1).has_value());
  EXPECT_FALSE(odd_grid(9, -2, 1).has_value());
}

TEST(OddGrid, OfAScheduleIsTheSameForAllSeedsAndPhaseSeedsMakePairs) {
  MultisinePlan plan;
  plan.odd_grid = {29, 4};
  plan.phase_seed = 5;
  const auto at = [&](MultisinePlan::Axes axes, std::uint64_t seed, double time) {
    plan.axes = axes;
    Plan whole;
    whole.kind = plan;
    return make_schedule(whole, seed).value().at(time).value;
  };
  for (const double time : {11.3, 14.0, 27.7}) {
    const Eigen::Vector2d first = at(MultisinePlan::Axes::hadamard_first, 1, time);
    const Eigen::Vector2d second = at(MultisinePlan::Axes::hadamard_second, 2, time);
    EXPECT_NEAR(first[0], second[0], 1e-15);
    EXPECT_NEAR(first[1], -second[1], 1e-15);
    // odd lines alone: half a period later everything has the other sign
    EXPECT_NEAR((at(MultisinePlan::Axes::hadamard_first, 1, time + 5.0) + first).norm(), 0.0, 1e-12);
  }
  plan.phase_seed.reset();
  EXPECT_GT((at(MultisinePlan::Axes::independent, 1, 12.0) - at(MultisinePlan::Axes::independent, 2, 12.0)).norm(),
            1e-4);
}

}  // namespace odd_grid_test
}  // namespace mbk::perturbation
