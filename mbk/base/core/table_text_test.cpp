#include "mbk/base/core/table_text.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

TEST(CsvField, IsQuotedWhereItHasToBe) {
  EXPECT_EQ(csv_field("a file.mat"), "a file.mat");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("a \"b\""), "\"a \"\"b\"\"\"");
  EXPECT_EQ(csv_field("a\rb"), "\"a\rb\"");
  EXPECT_EQ(csv_field("a;b"), "\"a;b\"") << "some spreadsheets separate by semicolons";
}

TEST(CsvField, IsNeverAFormula) {
  EXPECT_EQ(csv_field("=1+1"), "'=1+1");
  EXPECT_EQ(csv_field("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_field("+cmd|' /C calc'!A0"), "'+cmd|' /C calc'!A0");
  EXPECT_EQ(csv_field("-2+3"), "'-2+3");
  EXPECT_EQ(csv_field("\t=1"), "\"'\t=1\"");
  EXPECT_EQ(csv_field("=HYPERLINK(\"http://a\",1)"), "\"'=HYPERLINK(\"\"http://a\"\",1)\"");
  EXPECT_EQ(csv_field("+"), "'+");
}

TEST(CsvField, LeavesNumbersAsTheyAre) {
  for (const char* number : {"-3.25", "+3.25", "-1e-9", "-inf", "1-2", ""}) EXPECT_EQ(csv_field(number), number);
}

TEST(LatexText, EscapesCommandsAndSetsUnits) {
  EXPECT_EQ(latex_text("stiff_100%"), "stiff\\_100\\%");
  EXPECT_EQ(latex_text("\\{~}"), "\\textbackslash{}\\{\\~{}\\}");
  EXPECT_EQ(latex_text("N·s/m, kg·m², °"), "N$\\cdot$s/m, kg$\\cdot$m$^2$, $^\\circ$");
}

}  // namespace
}  // namespace mbk
