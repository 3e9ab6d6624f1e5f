#include "mbk/base/core/table_text.h"

#include <gtest/gtest.h>

namespace mbk {
namespace {

TEST(CsvField, IsQuotedWhereItHasToBe) {
  EXPECT_EQ(csv_field("a file.mat"), "a file.mat");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("a \"b\""), "\"a \"\"b\"\"\"");
  EXPECT_EQ(csv_field("a\rb"), "\"a\rb\"");
}

TEST(LatexText, EscapesCommandsAndSetsUnits) {
  EXPECT_EQ(latex_text("stiff_100%"), "stiff\\_100\\%");
  EXPECT_EQ(latex_text("\\{~}"), "\\textbackslash{}\\{\\~{}\\}");
  EXPECT_EQ(latex_text("N·s/m, kg·m², °"), "N$\\cdot$s/m, kg$\\cdot$m$^2$, $^\\circ$");
}

}  // namespace
}  // namespace mbk
