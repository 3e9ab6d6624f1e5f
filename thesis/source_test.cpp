#include "thesis/source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "thesis/exhibits.h"

namespace mbk::thesis {
namespace source_test {

using ::testing::HasSubstr;

Source printed() {
  auto source = read_source(source_text());
  EXPECT_TRUE(source) << source.error().line();
  return *source;
}

TEST(Source, HasEveryDigitAndHalfAUnitOfTheLast) {
  const Source source = printed();
  const PrintedNumber* shape = source.printed.at("3.3").find("P1", "stiffness R");
  ASSERT_NE(shape, nullptr);
  EXPECT_EQ(shape->text, "4.0");
  EXPECT_DOUBLE_EQ(shape->value, 4.0);
  EXPECT_DOUBLE_EQ(shape->rounding, 0.05);
  EXPECT_DOUBLE_EQ(source.printed.at("3.1").find("configuration 1", "x0")->rounding, 0.5);
  EXPECT_TRUE(std::isnan(source.printed.at("4.3").find("rigid, integral", "underdamped")->value));
  EXPECT_EQ(source.printed.at("3.3").find("P7", "stiffness R"), nullptr);
  EXPECT_EQ(source.printed.at("3.3").find("P1", "weight"), nullptr);
}

TEST(Source, GivesSixArmsTwiceAndFiveRigs) {
  const Given given = printed().given;
  EXPECT_EQ(given.sinusoidal.size(), 6U);
  EXPECT_EQ(given.underdamped.size(), 2U);
  ASSERT_EQ(given.stiffnesses.size(), 5U);
  EXPECT_EQ(given.masses.size(), 5U);
  EXPECT_DOUBLE_EQ(given.stiffnesses[0].theoretical[2].value, -18.87);
  EXPECT_DOUBLE_EQ(given.stiffnesses[0].error_method_2[2].value, 4.62);
}

TEST(Source, SaysWhatIsMissing) {
  const auto cut = read_source("{");
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().kind, ErrorKind::data);
  const auto without =
      read_source(R"({"source": "a thesis", "given": {"3.3": {"columns": ["A"], "rows": {"P1": []}}}})");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().line(), HasSubstr("'P1'"));
}

ReproducedTable one_cell(ReproducedCell cell, Provenance provenance, std::string erratum = "") {
  ReproducedTable table;
  table.id = "3.6";
  table.provenance = provenance;
  table.erratum = std::move(erratum);
  table.columns = {{"λ_min, corrected", "N·s/m", 2}};
  table.rows = {{"P1, sinusoidal", {std::move(cell)}}};
  return table;
}

Agreement compared(const ReproducedTable& table) {
  Exhibit exhibit;
  exhibit.tables = {table};
  compare(printed(), exhibit);
  return exhibit.tables[0].rows[0].cells[0].agreement;
}

TEST(Compare, AgreesWhereBothRangesOverlap) {
  // 5.7 is printed
  EXPECT_EQ(compared(one_cell(cell(5.74), Provenance::recomputed)), Agreement::within_rounding);
  EXPECT_EQ(compared(one_cell(cell(5.76), Provenance::recomputed)), Agreement::differs);
  EXPECT_EQ(compared(one_cell(cell(5.8, {5.74, 5.86}), Provenance::recomputed)), Agreement::within_rounding);
  EXPECT_EQ(compared(one_cell(cell(5.9, {5.8, 6.0}), Provenance::recomputed)), Agreement::differs);
}

TEST(Compare, NamesAnErratumOnlyWhereItDiffers) {
  EXPECT_EQ(compared(one_cell(cell(5.7), Provenance::recomputed, "erratum-1")), Agreement::within_rounding);
  EXPECT_EQ(compared(one_cell(cell(4.9), Provenance::recomputed, "erratum-1")), Agreement::erratum);
}

// P1's damping ellipse is printed in table 3.3 as A = 176.8, and given too.
TEST(Compare, TellsARoundTripFromAgreement) {
  ReproducedTable table = one_cell(cell(176.84), Provenance::recomputed);
  table.id = "3.3";
  table.columns = {{"damping A", "", 1}};
  table.rows[0].name = "P1";
  EXPECT_EQ(compared(table), Agreement::round_trip);
  table.rows[0].cells[0].ours = 176.86;
  EXPECT_EQ(compared(table), Agreement::differs) << "it has to come back";
  table.provenance = Provenance::simulated;
  table.rows[0].cells[0].ours = 176.84;
  EXPECT_EQ(compared(table), Agreement::not_compared);

  // Where the given number is another one, ours does not come from the printed one.
  Source changed = printed();
  changed.given.tables.at("3.3").rows.at("P1").at(3).text = "176.9";
  Exhibit exhibit;
  table.provenance = Provenance::recomputed;
  exhibit.tables = {table};
  compare(changed, exhibit);
  EXPECT_EQ(exhibit.tables[0].rows[0].cells[0].agreement, Agreement::within_rounding);
}

TEST(Compare, DoesNotJudgeWhatIsSimulated) {
  EXPECT_EQ(compared(one_cell(cell(4.9), Provenance::simulated)), Agreement::not_compared);
  EXPECT_EQ(compared(one_cell(words("passive"), Provenance::recomputed)), Agreement::not_compared);
}

}  // namespace source_test
}  // namespace mbk::thesis
