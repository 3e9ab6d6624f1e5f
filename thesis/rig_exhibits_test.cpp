#include <gtest/gtest.h>

#include <cmath>

#include "thesis/test_exhibits.h"

namespace mbk::thesis {
namespace {

TEST(RigExhibits, ReconstructedSpringsHaveTheStiffnessThatTheyWereDesignedFor) {
  const Reproduction all = made({"table-3.1", "table-5.1"});
  const Exhibit &of_3 = exhibit_of(all, "table-3.1"), &of_5 = exhibit_of(all, "table-5.1");
  for (const char* id : {"5.1 stiffness", "5.1 mass"}) expect_all_found(of_5, id);
  expect_all_found(of_3, "3.1");
  constexpr double kStiffness = 1.0, kGrid = 0.1;  // [N/m], [mm]
  const ReproducedTable &springs = table_of(of_5, "5.1 stiffness"), &grid = table_of(of_5, "5.1 by grid");
  for (const PrintedRig& rig : the_source().given.stiffnesses) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(value_of(springs, rig.name, kElements[k]), rig.theoretical[k].value, kStiffness) << rig.name;
      EXPECT_NEAR(value_of(grid, rig.name, kElements[k]), rig.theoretical[k].value, kStiffness) << rig.name;
    }
    // A grid of 0.15 mm finds the equilibrium to half a step in each direction.
    EXPECT_NEAR(value_of(grid, rig.name, "x0"), value_of(springs, rig.name, "x0"), kGrid);
  }
  for (const PrintedRig& rig : the_source().given.masses) {
    EXPECT_EQ(value_of(table_of(of_5, "5.1 mass"), rig.name, "m"), rig.theoretical[0].value);
  }
  for (const ReproducedRow& row : table_of(of_3, "3.1").rows) {
    for (const ReproducedCell& cell : row.cells) EXPECT_LT(std::abs(*cell.difference()), kStiffness) << row.name;
  }
}

TEST(RigExhibits, FindRigsUnderPulsesAndThatTheirDamperIsTakenForMass) {
  const Reproduction all = made({"figure-3.8"});
  const Exhibit& exhibit = all.exhibits.front();
  expect_charts(exhibit, 2);
  const ReproducedTable& errors = table_of(exhibit, "3.8 errors");
  ASSERT_EQ(errors.rows.size(), 6u);
  for (const ReproducedRow& row : errors.rows) {
    for (const char* element : kElements) EXPECT_LT(std::abs(value_of(errors, row.name, element)), 8.0) << row.name;
    EXPECT_LT(std::abs(value_of(errors, row.name, "x0")), 0.1) << row.name;  // [mm]
    EXPECT_GT(value_of(errors, row.name, "m"), 0.0) << row.name;
    EXPECT_LT(value_of(errors, row.name, "m"), 0.02) << row.name;
  }
  const ReproducedTable& causes = table_of(exhibit, "3.8 causes");
  EXPECT_GT(value_of(causes, "linear fields, damper of 1 N·s/m", "m"),
            3.0 * std::abs(value_of(causes, "linear fields, no damper", "m")));
}

TEST(RigExhibits, AreTheSameWithoutThePrintedNumbers) {
  const Reproduction with = made({"table-5.1"}), without = made({"table-5.1"}, 0, false);
  const ReproducedTable &one = with.exhibits.front().tables.front(), &two = without.exhibits.front().tables.front();
  for (std::size_t i = 0; i < one.rows.size(); ++i) {
    for (std::size_t k = 0; k < one.columns.size(); ++k) {
      EXPECT_EQ(one.rows[i].cells[k].ours, two.rows[i].cells[k].ours);
      EXPECT_TRUE(two.rows[i].cells[k].printed.empty());
    }
  }
}

}  // namespace
}  // namespace mbk::thesis
