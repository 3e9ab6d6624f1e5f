#include "mbk/files/recording/csv.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "mbk/files/contents/disk_pages.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/contents/test_pages.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace csv_test {

using testing::Contains;
using testing::HasSubstr;

Result<Contents> csv(std::string_view text) {
  return decode_csv(std::as_bytes(std::span(text)));
}

Error error_of(std::string_view text) {
  const auto contents = csv(text);
  EXPECT_FALSE(contents) << text;
  return contents ? Error{} : contents.error();
}

Matrix values_of(std::string_view text) {
  const auto contents = csv(text);
  EXPECT_TRUE(contents) << contents.error().line();
  if (!contents) return {};
  Matrix values(contents->arrays[0].values.rows(), std::ssize(contents->arrays));
  for (Index c = 0; c < values.cols(); ++c) values.col(c) = contents->arrays[static_cast<std::size_t>(c)].values;
  return values;
}

const Matrix kTwoByTwo = (Matrix(2, 2) << 0, 1.5, 0.25, -2).finished();

TEST(DecodeCsv, ReadsNumbersWithAndWithoutAHeader) {
  EXPECT_EQ(values_of("0,1.5\n0.25,-2\n"), kTwoByTwo);
  EXPECT_EQ(values_of("t,x\n0,1.5\n0.25,-2\n"), kTwoByTwo);
  EXPECT_EQ(csv("t, \"x\"\n0,1\n")->arrays[1].name, "x");
}

TEST(DecodeCsv, FindsTheSeparatorAndSaysSo) {
  EXPECT_EQ(values_of("0;1.5\n0.25;-2\n"), kTwoByTwo);
  EXPECT_EQ(values_of("0\t1.5\n0.25\t-2\n"), kTwoByTwo);
  EXPECT_THAT(csv("0;1\n")->notes, Contains("columns are separated by semicolons"));
}

TEST(DecodeCsv, ToleratesByteOrderMarkCarriageReturnsCommentsAndPlusSigns) {
  EXPECT_EQ(values_of("\xEF\xBB\xBF# made by\r\nt,x\r\n\r\n0,+1.5\r\n% pause\r\n 0.25 , -2.0e0\r\n"), kTwoByTwo);
}

TEST(DecodeCsv, ReadsEmptyCellsAsNaN) {
  const Matrix values = values_of("a,b,c\n1,,nan\nNaN,2,\n");
  EXPECT_TRUE(std::isnan(values(0, 1)) && std::isnan(values(0, 2)) && std::isnan(values(1, 0)) &&
              std::isnan(values(1, 2)));
  EXPECT_EQ(values(1, 1), 2);
}

TEST(DecodeCsv, ReadsOneNumberPerLine) {
  EXPECT_EQ(values_of("1\n2\n3\n"), Vector::LinSpaced(3, 1, 3));
}

TEST(DecodeCsv, ReadsEveryNumberAsTheCLibraryDoes) {
  std::vector<std::string> cells = {"0",
                                    "-0",
                                    "5.",
                                    "-.5",
                                    "0.1",
                                    "007.50",
                                    "0.3",
                                    "123456.789",
                                    "-99999.99999",
                                    "0.000000000000001",
                                    "1234567890123456",
                                    "9007199254740991",
                                    "9007199254740992",
                                    "9007199254740993",
                                    "9007199254740.993",
                                    "0.9007199254740993",
                                    "0.28412345678901234",
                                    "1.5e-3"};
  std::mt19937 random(1);  // NOLINT(cert-msc32-c, cert-msc51-cpp): the same numbers every time
  for (int k = 0; k < 2000; ++k) {
    const auto digits = static_cast<std::size_t>(1 + random() % 17);
    std::string cell;
    while (cell.size() < digits) cell += static_cast<char>('0' + random() % 10);
    cell.insert(random() % (cell.size() + 1), ".");
    cells.push_back((random() % 2 == 0 ? "-" : "") + cell);
  }
  for (const std::string& cell : cells) {
    const double want = std::strtod(cell.c_str(), nullptr), found = values_of(cell + "\n1\n")(0, 0);
    EXPECT_EQ(found, want) << cell;
    EXPECT_EQ(std::signbit(found), std::signbit(want)) << cell;
  }
  for (const char* none : {".", "-", "-.", "1.2.3", "1-2", "--1", "1 2"}) {
    EXPECT_FALSE(csv(std::string("a,b\n1,") + none + "\n2,3\n")) << none;
  }
}

TEST(DecodeCsv, ReadsNumbersTooSmallForADouble) {
  EXPECT_EQ(values_of("1e-400\n4.9e-324\n")(0, 0), 0.0);
}

TEST(DecodeCsv, RefusesNumbersTooLargeForADouble) {
  EXPECT_EQ(error_of("1\n1e400\n").where, "line 2, column 1");
}

TEST(DecodeCsv, RefusesAHeaderThatDoesNotFitTheColumns) {
  EXPECT_EQ(error_of("a,b,c,d,e\n1,2,3,4,5,6,7,8\n").line(),
            "line 1: the header names 5 columns, line 2 has 8; give every column one name");
  EXPECT_THAT(error_of("a,b,c\n1,2\n3,4\n").message, HasSubstr("names 3 columns, line 2 has 2"));
}

TEST(DecodeCsv, RefusesLinesOfUnequalLength) {
  EXPECT_EQ(error_of("1,2\n3\n4,5\n").where, "line 2");
  EXPECT_THAT(error_of("1,2\n3,4,5\n6,7\n").message, HasSubstr("3 cells where the lines before have 2"));
}

TEST(DecodeCsv, NamesLineColumnAndTextOfWhatIsNotANumber) {
  EXPECT_EQ(
      error_of("t,x\n0,1\n1,two\n2,3\n").line(),
      "line 3, column 2: 'two' is not a number; the table must hold numbers, separated by commas, semicolons or tabs");
}

TEST(DecodeCsv, KeepsControlCharactersOutOfMessages) {
  EXPECT_THAT(error_of("1\n2\n\x1b[2Jx\n").message, HasSubstr("'?[2Jx' is not a number"));
}

TEST(DecodeCsv, RefusesATableOfOneEndlessLine) {
  EXPECT_THAT(error_of(std::string(20'000, ',') + "\n").message, HasSubstr("20000 columns are more than 10000"));
}

TEST(DecodeCsv, RefusesDecimalCommas) {
  EXPECT_THAT(error_of("t;x\n0,001;1,5\n0,002;1,6\n").line(),
              HasSubstr("line 2, column 1: '0,001' has a decimal comma"));
  EXPECT_THAT(error_of("0,001;1,5\n0,002;1,6\n").line(), HasSubstr("line 1, column 1: '0,001' has a decimal comma"));
}

TEST(DecodeCsv, ToleratesASeparatorAtTheEndOfEveryLine) {
  EXPECT_EQ(values_of("t,x\n0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_EQ(values_of("t,x,\n0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_EQ(values_of("0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_THAT(csv("0,1,\n")->notes, Contains("every line ends with a separator, which was not taken as a column"));
}

TEST(DecodeCsv, RefusesASeparatorAtTheEndOfSomeLines) {
  EXPECT_EQ(error_of("0,1,\n2,3\n4,5,\n").where, "line 2");
}

TEST(DecodeCsv, LeavesAnIncompleteLastLineAsideAndSaysSo) {
  for (const char* text :
       {"t,x\n0,1.5\n0.25,-2\n0.5", "0,1.5\n0.25,-2\n0.5,", "0,1.5\n0.25,-2\n0.5,1e", "0,1.5\n0.25,-2\n0.5,-"}) {
    EXPECT_EQ(values_of(text), kTwoByTwo) << text;
    EXPECT_THAT(csv(text)->notes, Contains(HasSubstr("is incomplete"))) << text;
  }
}

TEST(DecodeCsv, SaysThatALastNumberWithoutLineEndMayBeCut) {
  EXPECT_EQ(values_of("0,1.5\n0.25,-2"), kTwoByTwo);
  EXPECT_THAT(csv("0,1.5\n0.25,-2")->notes, Contains(HasSubstr("line 2 has no line end")));
}

TEST(DecodeCsv, RefusesAFileWithoutNumbers) {
  EXPECT_EQ(error_of("t,x\n").message, "the file holds no line of numbers");
  EXPECT_EQ(error_of("# nothing\n").message, "the file holds no line of numbers");
  EXPECT_THAT(error_of("t,x\n0.5").message, HasSubstr("the only line of numbers, line 2, is incomplete"));
}

TEST(DecodeCsv, CutAnywhereGivesAnErrorOrTheCompleteLines) {
  const std::string whole = "t,x,Fx\n0.000,0.125,-1.5\n0.001,0.25,-2.5\n0.002,0.375,-3.5\n";
  const Matrix all = values_of(whole);
  int read = 0;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const std::string_view cut = std::string_view(whole).substr(0, n);
    const auto contents = csv(cut);
    // From the second whole line on there is something to read.
    if (n >= whole.find("0.002")) {
      ASSERT_TRUE(contents) << n;
    }
    if (!contents) continue;
    ++read;
    const Matrix values = values_of(cut);
    ASSERT_LE(values.rows(), all.rows()) << n;
    const bool ends_with_line = whole[n - 1] == '\n';
    EXPECT_EQ(contents->notes.empty(), ends_with_line) << n;
    // Only the last number of an unterminated line can be cut, and then a note says so.
    const Index sure = values.rows() - (ends_with_line ? 0 : 1);
    EXPECT_EQ(values.topRows(std::max<Index>(sure, 0)), all.topRows(std::max<Index>(sure, 0))) << n;
  }
  EXPECT_GT(read, 16);
}

/// A table of three columns with a header, of at least so many bytes; every third line is shorter.
std::string long_table(std::size_t bytes, std::string_view first) {
  std::string text(first);
  for (int i = 0; text.size() < bytes; ++i) {
    text += i % 3 == 0 ? fmt::format("{},1,-2\n", i) : fmt::format("{},{:.12f},{}\n", i, 0.001 * i, -7 * i);
  }
  return text;
}

TEST(DecodeCsv, OfAFileInPassingIsThatOfTheWholeText) {
  const test::Folder folder;
  constexpr std::size_t kPiece = FileInPassing::kPiece;
  const std::string header = "# a comment\nt,x,\"F\"\n";
  // The last: a first piece of long lines, which lets expect fewer of them than there are.
  std::string wide = header;
  while (wide.size() < kPiece) wide += fmt::format("{:.100f},{:.100f},3\n", 0.25, 0.5);
  for (const std::string& text : {long_table(3 * kPiece + 100, header), long_table(2 * kPiece, header) + "12,5",
                                  long_table(kPiece, header), std::string("1,2,3\n"), wide + long_table(kPiece, "")}) {
    const auto file = folder.write("table.csv", text);
    auto passing = FileInPassing::open(file).value();
    ASSERT_TRUE(passing.read_on());
    const Contents found = decode_csv(passing).value(), expected = csv(text).value();
    EXPECT_EQ(passing.sha256(), sha256(std::as_bytes(std::span(text))));
    EXPECT_EQ(found.notes, expected.notes);
    ASSERT_EQ(found.arrays.size(), expected.arrays.size());
    for (std::size_t k = 0; k < found.arrays.size(); ++k) {
      EXPECT_EQ(found.arrays[k].name, expected.arrays[k].name);
      EXPECT_EQ(found.arrays[k].values, expected.arrays[k].values);
    }
  }
}

TEST(DecodeCsv, OfALongFileInPassingHoldsNoMoreThanItsEnd) {
  const test::Folder folder;
  std::string text = "t,x\n";
  for (Index row = 0; row < kLong + kLong / 4; ++row) text += row % 2 == 0 ? "0.25,-3\n" : "7,1.5\n";
  auto passing = FileInPassing::open(folder.write("table.csv", text)).value();
  ASSERT_TRUE(passing.read_on());
  const Contents found = decode_csv(passing).value(), expected = csv(text).value();
  const Index all = found.arrays[0].values.rows() / 512;  // pages of 4 kB
  for (std::size_t k = 0; k < 2; ++k) {
    const auto pages = test::pages_in_memory(found.arrays[k].values.col(0));
    if (!pages) GTEST_SKIP() << "the kernel does not say what is in memory";
    EXPECT_LT(*pages, all / 4);
    EXPECT_EQ(found.arrays[k].values, expected.arrays[k].values);
  }
}

TEST(DecodeCsv, OfAFileInPassingNamesTheLineOfAnErrorBehindTheFirstPiece) {
  const test::Folder folder;
  const std::string text = long_table(2 * FileInPassing::kPiece, "t,x,F\n") + "1,two,3\n4,5,6\n";
  auto passing = FileInPassing::open(folder.write("table.csv", text)).value();
  ASSERT_TRUE(passing.read_on());
  const auto found = decode_csv(passing);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().line(), error_of(text).line());
  EXPECT_THAT(found.error().message, HasSubstr("'two'"));
}

TEST(DecodeCsv, OfAFileThatBecomesShorterSaysSo) {
  const test::Folder folder;
  const auto file = folder.write("table.csv", long_table(3 * FileInPassing::kPiece, "t,x,F\n"));
  auto passing = FileInPassing::open(file).value();
  ASSERT_TRUE(passing.read_on());
  std::filesystem::resize_file(file, FileInPassing::kPiece + 1000);
  const auto found = decode_csv(passing);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("became shorter"));
}

TEST(DecodeCsv, KeepsEpochTimestamps) {
  const Matrix values = values_of("1700000000.123456,1\n1700000000.124456,2\n");
  EXPECT_EQ(values(0, 0), 1700000000.123456);
  EXPECT_NEAR(values(1, 0) - values(0, 0), 0.001, 3e-7);
}

}  // namespace csv_test
}  // namespace mbk::recording
