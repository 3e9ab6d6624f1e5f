#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "thesis/reproduce.h"
#include "thesis/source.h"

namespace mbk::thesis {
namespace {

Source source() {
  const auto read = read_source(source_text());
  EXPECT_TRUE(read) << read.error().line();
  return *read;
}

Exhibit statements_of(const Source& source) {
  ReproduceOptions options;
  options.only = {"statements"};
  const auto made = reproduce(source, options);
  EXPECT_TRUE(made) << made.error().line();
  return made->exhibits.at(0);
}

const Exhibit& statements() {
  static const Exhibit exhibit = statements_of(source());
  return exhibit;
}

const ReproducedCell& value(const std::string& statement) {
  for (const ReproducedTable& table : statements().tables) {
    for (const ReproducedRow& row : table.rows) {
      if (row.name == statement) return row.cells.at(0);
    }
  }
  ADD_FAILURE() << "no statement '" << statement << "'";
  static const ReproducedCell kNone;
  return kNone;
}

TEST(Statements, FollowFromWhatIsGiven) {
  EXPECT_NEAR(value("the 5 mm step peaks at [mm]").ours.value(), 8.65, 0.005);
  EXPECT_NEAR(value("force of the 2 N step at its peak [N]").ours.value(), 3.46, 0.005);
  EXPECT_EQ(value("damping between stiffness and inertia in angle").words, "5 of 6");
  EXPECT_EQ(value("physical sensor closer to theory than virtual").words, "19 of 20");
  EXPECT_EQ(value("VAF by method 1 above 83 %").words, "50 of 50");
  EXPECT_EQ(value("VAF larger in the stiffer direction").words, "20 of 20");
  EXPECT_EQ(value("x₀ of tables 3.1 and 5.1 within the joints' limits").words, "11 of 11");
  EXPECT_EQ(value("(5.3) gives θ̈ back").words, "yes");
}

TEST(Statements, NoneDiffersUnexplained) {
  int agree = 0, errata = 0;
  for (const ReproducedTable& table : statements().tables) {
    for (const ReproducedRow& row : table.rows) {
      EXPECT_NE(row.cells.at(0).agreement, Agreement::differs) << row.name;
      agree += row.cells.at(0).agreement == Agreement::within_rounding ? 1 : 0;
      errata += row.cells.at(0).agreement == Agreement::erratum ? 1 : 0;
    }
  }
  EXPECT_GE(agree, 12);
  EXPECT_EQ(errata, 2) << "the range of the excess";
}

// What is printed in source.json and made by no row would be compared with nothing.
TEST(Statements, EveryPrintedOneHasItsRow) {
  for (const auto& [id, printed] : source().printed) {
    if (!id.starts_with("statements")) continue;
    const auto table = std::ranges::find(statements().tables, id, &ReproducedTable::id);
    ASSERT_NE(table, statements().tables.end()) << id;
    for (const auto& [name, cells] : printed.rows) {
      EXPECT_NE(std::ranges::find(table->rows, name, &ReproducedRow::name), table->rows.end()) << name;
    }
  }
}

// A changed number of the source changes what follows from it.
TEST(Statements, FindAnExceptionThatIsPutIn) {
  Source changed = source();
  changed.given.tables.at("5.5").rows.at("K3").front().value = 82.0;
  const Exhibit exhibit = statements_of(changed);
  const auto table = std::ranges::find(exhibit.tables, "statements 5", &ReproducedTable::id);
  const auto row = std::ranges::find(table->rows, "VAF by method 1 above 83 %", &ReproducedRow::name);
  EXPECT_EQ(row->cells.at(0).words, "49 of 50");
  EXPECT_EQ(row->cells.at(1).words, "table 5.5; not K3 M1 x");
}

}  // namespace
}  // namespace mbk::thesis
