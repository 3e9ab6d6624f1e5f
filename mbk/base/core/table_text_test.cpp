#include "mbk/base/core/table_text.h"

#include <gtest/gtest.h>

#include <algorithm>

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

PaperTable small_table() {
  using enum PaperCell::Kind;
  return {.caption = "A_1, 95 %",
          .note = "n: people",
          .alignment = "lrr",
          .header = {{{{""}, {"K_{xx}", symbol}, {"n"}}}, {{{""}, {"[N/m]"}}}},
          .rows = {{{{"far|50%"}, {"-1.2 ± 0.3", number}, {"4"}}}, {{{"near"}, {"not usable"}}, true}}};
}

TEST(PaperTable, InLatexIsEscapedAndNotWiderThanTheText) {
  const std::string text = latex_table(small_table());
  for (const char* part :
       {"\\caption{A\\_1, 95\\,\\%}", " & $K_{xx}$ & n \\\\\n", "far|50\\% & $-1.2 \\pm 0.3$ & 4 \\\\\n",
        "\\midrule\nnear & \\multicolumn{2}{l}{not usable} \\\\\n\\bottomrule",
        "\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%\n\\begin{tabular}{@{}lrr@{}}"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_EQ(std::ranges::count(text, '{'), std::ranges::count(text, '}'));
}

TEST(PaperTable, InMarkdownHasAsManyCellsInEachRow) {
  EXPECT_EQ(markdown_table(small_table()),
            "A\\_1, 95 %\n\n|  | $K_{xx}$ [N/m] | n |\n| :-- | --: | --: |\n| far\\|50% | −1.2 ± 0.3 | 4 |\n"
            "| near | not usable |  |\n\n*Note.* n: people\n");
}

}  // namespace
}  // namespace mbk
