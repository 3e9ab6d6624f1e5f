#include <gtest/gtest.h>

#include <string>

#include "thesis/reproduce.h"
#include "thesis/source.h"

namespace mbk::thesis {
namespace {

// The one that needs the fewest trials; the others rest on the same workbench.
TEST(Questions, AnActiveAnswerIsDecidedByTheEnergy) {
  const auto source = read_source(source_text());
  ASSERT_TRUE(source) << source.error().line();
  ReproduceOptions options;
  options.only = {"question-2"};
  const auto made = reproduce(*source, options);
  ASSERT_TRUE(made) << made.error().line();
  const Exhibit& exhibit = made->exhibits.at(0);
  EXPECT_EQ(exhibit.kind, Exhibit::Kind::question);
  const ReproducedTable& table = exhibit.tables.at(0);
  EXPECT_EQ(table.provenance, Provenance::simulated);
  ASSERT_EQ(table.rows.size(), 6u);
  for (const ReproducedRow& row : table.rows) {
    EXPECT_LT(row.cells.at(2).ours.value(), 0.0) << row.name << ": the whole interval of the energy is below zero";
    EXPECT_GT(row.cells.at(3).ours.value(), 0.0);
    EXPECT_EQ(row.cells.at(5).words, "none") << "no model explains the force, so none predicts";
    EXPECT_EQ(row.cells.at(6).words, "active");
  }
}

}  // namespace
}  // namespace mbk::thesis
