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

/// Why a column cannot be used.
Error obstacle_of(std::string_view text, std::size_t column) {
  const auto contents = csv(text);
  EXPECT_TRUE(contents) << contents.error().line();
  if (!contents || column >= contents->arrays.size() || !contents->arrays[column].obstacle) {
    ADD_FAILURE() << "no obstacle in " << text;
    return {};
  }
  EXPECT_EQ(contents->arrays[column].values.size(), 0);
  return *contents->arrays[column].obstacle;
}

std::vector<std::string> names_of(std::string_view text) {
  std::vector<std::string> names;
  const auto contents = csv(text);
  EXPECT_TRUE(contents) << contents.error().line();
  for (const Array& array : contents ? contents->arrays : std::vector<Array>()) names.push_back(array.name);
  return names;
}

TEST(DecodeCsv, KeepsWhatDoublesLeaveOfWholeNumbers) {
  const auto contents =
      csv("t,n,x\n1709288130000000001,-9007199254740993,0.1\n"
          "1709288130001000001,\"9007199254740993.0\",2\n18446744073709551615,5,3\n");
  ASSERT_TRUE(contents) << contents.error().line();
  const auto rest = [&](std::size_t column, std::size_t row) { return contents->arrays[column].rests[row]; };
  const auto exact = [&](std::size_t row, std::uint64_t whole) {
    EXPECT_EQ(contents->arrays[0].values(static_cast<Index>(row), 0), static_cast<double>(whole));
    EXPECT_EQ(rest(0, row), rest_of(whole));
  };
  exact(0, 1709288130000000001);
  exact(1, 1709288130001000001);
  exact(2, 18446744073709551615U);
  EXPECT_EQ(rest(1, 0), -1);
  EXPECT_EQ(rest(1, 1), 1);
  EXPECT_EQ(rest(1, 2), 0);
  EXPECT_TRUE(contents->arrays[2].rests.empty());
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
  EXPECT_THAT(csv("0;1\n")->notes, Contains(HasSubstr("semicolon")));
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

TEST(DecodeCsv, ReadsNotANumberInEverySpelling) {
  for (const char* cell :
       {"-nan(ind)", "-nan", "1.#IND", "-1.#IND", "1.#QNAN", "1.#QNAN0", "-1.#IND00", "1.#SNAN", "NAN"}) {
    EXPECT_TRUE(std::isnan(values_of(std::string("a,b\n1,") + cell + "\n2,3\n")(0, 1))) << cell;
  }
  EXPECT_EQ(values_of("a,b\n1,1.#INF\n2,-1.#INF00\n"), (Matrix(2, 2) << 1, HUGE_VAL, 2, -HUGE_VAL).finished());
  for (const char* none : {"1.#", "1.#I", "2.#IND", "1.#INDX", "1.5#IND", "#IND"}) {
    EXPECT_EQ(obstacle_of(std::string("a,b\n1,") + none + "\n2,3\n", 1).where, "line 2, column 2") << none;
  }
}

TEST(DecodeCsv, ReadsLineEndsOfEveryKind) {
  for (const std::string_view end : {"\n", "\r\n", "\r\r\n", "\r"}) {
    std::string text = "t,x\n0,1.5\n0.25,-2\n";
    for (auto at = text.find('\n'); at != text.npos; at = text.find('\n', at + end.size())) text.replace(at, 1, end);
    EXPECT_EQ(values_of(text), kTwoByTwo) << end.size();
    EXPECT_EQ(names_of(text), (std::vector<std::string>{"t", "x"}));
    EXPECT_THAT(csv(text)->notes, testing::IsEmpty());
  }
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
                                    "9007199254740993.000",
                                    "900719925474099.25",
                                    "4503599627370497.5",
                                    "450359962737049.75",
                                    "9999999999999999999",
                                    "10000000000000000001",
                                    ".9999999999999999999",
                                    "0.0000000000000000001",
                                    "1.5e-3"};
  std::mt19937 random(1);  // NOLINT(cert-msc32-c, cert-msc51-cpp): the same numbers every time
  for (int k = 0; k < 3000; ++k) {
    const auto digits = static_cast<std::size_t>(1 + random() % 20);
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
    EXPECT_EQ(obstacle_of(std::string("a,b\n1,") + none + "\n2,3\n", 1).where, "line 2, column 2") << none;
  }
}

TEST(DecodeCsv, ReadsNumbersTooSmallForADouble) {
  EXPECT_EQ(values_of("1e-400\n4.9e-324\n")(0, 0), 0.0);
}

TEST(DecodeCsv, RefusesNumbersTooLargeForADouble) {
  EXPECT_EQ(error_of("1\n1e400\n").where, "line 2, column 1");
}

TEST(DecodeCsv, RefusesAHeaderThatDoesNotFitTheColumns) {
  EXPECT_THAT(error_of("a,b,c,d,e\n1,2,3,4,5,6,7,8\n").line(),
              AllOf(HasSubstr("line 1"), HasSubstr("5 columns"), HasSubstr("line 2")));
  EXPECT_THAT(error_of("a,b,c\n1,2\n3,4\n").message, AllOf(HasSubstr("3 columns"), HasSubstr("line 2")));
}

TEST(DecodeCsv, RefusesLinesOfUnequalLength) {
  EXPECT_EQ(error_of("1,2\n3\n4,5\n").where, "line 2");
  EXPECT_THAT(error_of("1,2\n3,4,5\n6,7\n").message, HasSubstr("3 cells"));
}

TEST(DecodeCsv, NamesLineColumnAndTextOfWhatIsNotANumber) {
  EXPECT_THAT(obstacle_of("t,x\n0,1\n1,two\n2,3\n", 1).line(),
              AllOf(HasSubstr("line 3"), HasSubstr("column 2"), HasSubstr("'two'")));
}

TEST(DecodeCsv, KeepsControlCharactersOutOfMessages) {
  EXPECT_THAT(error_of("1\n2\n\x1b[2Jx\n").message, HasSubstr("'?[2Jx'"));
}

TEST(DecodeCsv, RefusesATableOfOneEndlessLine) {
  EXPECT_THAT(error_of("0" + std::string(20'000, ',') + "\n").message, HasSubstr("10000 columns"));
}

TEST(DecodeCsv, ReadsDecimalCommasAndSaysSo) {
  for (const char* text : {"t;x\n0;1,5\n0,25;-2\n", "0\t1,5\n0,25\t-2,0\n", "0 1,5\n0,25 -2\n", "0|+1,5\n2,5e-1|-2\n",
                           "t,x\n0,\"1,5\"\n\"0,25\",-2\n"}) {
    EXPECT_EQ(values_of(text), kTwoByTwo) << text;
    EXPECT_THAT(csv(text)->notes, Contains(HasSubstr("decimal comma"))) << text;
  }
}

TEST(DecodeCsv, RefusesCommasThatMayStandForTwoThings) {
  EXPECT_THAT(error_of("t;x\n1;1,500\n2;2,125\n").message, AllOf(HasSubstr("'1,500'"), HasSubstr("thousands")));
  EXPECT_THAT(values_of("t;x\n1;1,500\n2;0,125\n"), (Matrix(2, 2) << 1, 1.5, 2, 0.125).finished());
  EXPECT_THAT(error_of("t;x\n0.5;1,5\n1.5;2,5\n").line(),
              AllOf(HasSubstr("line 2"), HasSubstr("column 2"), HasSubstr("'1,5'"), HasSubstr("decimal point")));
  EXPECT_THAT(error_of("t;x\n0.5;1\n1.5;2\n2.5;2,5\n").where, "line 4, column 2");
  EXPECT_THAT(error_of("t,x\n0,001,1,5\n0,002,1,6\n").line(), HasSubstr("semicolons"));
  EXPECT_THAT(error_of("0,001,1,5\n0,002,1,6\n").line(), AllOf(HasSubstr("comma"), HasSubstr("semicolons")));
  EXPECT_THAT(error_of("t,x\n0,1\n0,5,1\n1,1,5\n").line(), HasSubstr("semicolons"));
  EXPECT_THAT(error_of("t;x\n0;\"1,234\"\n1;\"5,678\"\n").message, AllOf(HasSubstr("'1,234'"), HasSubstr("thousands")));
}

TEST(DecodeCsv, LeavesPointsAmongDecimalCommasAside) {
  EXPECT_THAT(obstacle_of("t;x\n0,5;1\n1,5;1.234\n", 1).line(), HasSubstr("decimal comma"));
  EXPECT_THAT(obstacle_of("t;x\n0,5;1.234,5\n1,5;2\n", 1).message, HasSubstr("'1.234,5'"));
}

TEST(DecodeCsv, FindsBlanksAndVerticalBars) {
  EXPECT_EQ(values_of("  0.00e+00   1.5000e+00\n  2.50e-01  -2.0000e+00\n"), kTwoByTwo);
  EXPECT_EQ(values_of("0 1.5\n0.25 -2\n"), kTwoByTwo);
  EXPECT_EQ(values_of("t x\n0 1.5 \n0.25\t-2\n"), kTwoByTwo);
  EXPECT_EQ(values_of("t|x\n0|1.5\n0.25|-2\n"), kTwoByTwo);
  EXPECT_EQ(values_of("0, 1.5\n0.25, -2\n"), kTwoByTwo);
  EXPECT_THAT(csv("0 1.5\n0.25 -2\n")->notes, Contains(HasSubstr("blank")));
  EXPECT_EQ(values_of("sep=;\n0;1.5\n0.25;-2\n"), kTwoByTwo);
}

TEST(DecodeCsv, TakesNamesFromACommentAsNumpyWritesIt) {
  EXPECT_EQ(names_of("# time hand_x\n0 1.5\n0.25 -2\n"), (std::vector<std::string>{"time", "hand_x"}));
  EXPECT_EQ(names_of("# time,other\n0,1.5\n"), (std::vector<std::string>{"time", "other"}));
  EXPECT_EQ(names_of("# in x\n0 1.5\n"), (std::vector<std::string>{"", ""}));
}

TEST(DecodeCsv, LeavesColumnsOfWordsAsideUnlessTheyAreAskedFor) {
  const std::string text = "t,state,x,ok\n0,rest,1.5,true\n0.25,go,-2,NA\n";
  const auto contents = csv(text);
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[2].values, kTwoByTwo.col(1));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("2 'state'"), HasSubstr("4 'ok'"))));
  EXPECT_EQ(obstacle_of(text, 1).where, "line 2, column 2");
  EXPECT_EQ(obstacle_of("0,1.5,go\n0.25,-2,stop\n", 2).where, "line 1, column 3");
  EXPECT_THAT(obstacle_of("t,x\n0,1\n0.1,NA\n", 1).remedy, AllOf(HasSubstr("cell"), HasSubstr("nan")));
}

TEST(DecodeCsv, TakesALineOfUnits) {
  const auto contents = csv("time,x,F,n\ns,[mm],N,-\n0,1,2,3\n");
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].name, "time");
  EXPECT_EQ(contents->arrays[1].unit, "mm");
  EXPECT_EQ(contents->arrays[2].unit, "N");
  EXPECT_EQ(contents->arrays[3].unit, "");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("line 2"), HasSubstr("unit"))));
  EXPECT_THAT(error_of("time,x_mm\ns,m\n0,1\n").message, AllOf(HasSubstr("'x_mm'"), HasSubstr("unit")));
}

TEST(DecodeCsv, PassesOverLinesOfTextAboveTheTable) {
  const std::string text = "Recorder 7\nRate;1000\n\nDate;2024-03-01\ntime;x\ns;m\n0;1.5\n0.25;-2\n";
  EXPECT_EQ(values_of(text), kTwoByTwo);
  EXPECT_EQ(names_of(text), (std::vector<std::string>{"time", "x"}));
  EXPECT_THAT(csv(text)->notes, Contains(HasSubstr("3 lines")));
  std::string many;
  for (int k = 0; k < 300; ++k) many += fmt::format("remark {}: nothing, or much\n", k);
  EXPECT_EQ(values_of(many + "t,x\n0,1.5\n0.25,-2\n"), kTwoByTwo);
}

TEST(DecodeCsv, RefusesNumbersAboveAHeader) {
  EXPECT_THAT(error_of("a,b\n1,2\n3,4\nc,d\n5,6\n7,8\n").line(),
              AllOf(HasSubstr("line 2"), HasSubstr("header"), HasSubstr("line 4")));
  EXPECT_THAT(error_of("a,b,c\n1,2,go\n3,4,go\nc,d,e\n5,6,go\n7,8,go\n").message, HasSubstr("line 4"));
}

/// So many rows of cells that count up.
std::string counting(int rows, int columns, char separator = ',') {
  std::string text;
  for (int k = 0; k < rows; ++k) {
    for (int c = 0; c < columns; ++c) text += fmt::format("{}{}", k + c, c + 1 < columns ? separator : '\n');
  }
  return text;
}

TEST(DecodeCsv, RefusesAHeaderThatStandsAgain) {
  EXPECT_THAT(error_of("t,x\n" + counting(50, 2) + "t,x\n0,3\n").line(),
              AllOf(HasSubstr("line 52"), HasSubstr("line 1"), HasSubstr("recording")));
  EXPECT_THAT(error_of("\"t\" x\n" + counting(50, 2, ' ') + "t x\n0 3\n").message, HasSubstr("line 1"));
}

TEST(DecodeCsv, SaysWhereAnotherTableMayBegin) {
  EXPECT_THAT(error_of("t,x,y\n" + counting(50, 3) + "frequency,gain\n1,2\n").line(),
              AllOf(HasSubstr("line 52"), HasSubstr("2 cells"), HasSubstr("3 cells"), HasSubstr("table")));
}

TEST(DecodeCsv, TakesTheSeparatorThatFitsTheHeader) {
  const std::string text = "time,x\n2024-03-01 10:00:00,1\n2024-03-01 10:00:01,2\n2024-03-01 10:00:02,3\n";
  EXPECT_EQ(names_of(text), (std::vector<std::string>{"time", "x"}));
  EXPECT_EQ(values_of(text)(2, 1), 3);
  EXPECT_EQ(values_of(text)(2, 0), 36002);
}

TEST(DecodeCsv, JoinsNamesInTwoLines) {
  const auto rows = std::string("0,1,2,3,4\n1,2,3,4,5\n");
  const std::vector<std::string> names = {"time", "hand_x", "hand_y", "force_x", "force_y"};
  for (const char* head : {"time,hand,hand,force,force\n,x,y,x,y\n", "time,hand,,force,\n,x,y,x,y\n",
                           ",hand,,force,\ntime,x,y,x,y\n", "Recorder 7\n,hand,,force,\ntime,x,y,x,y\ns,mm,mm,N,N\n"}) {
    EXPECT_EQ(names_of(head + rows), names) << head;
    EXPECT_THAT(csv(head + rows)->notes, Contains(HasSubstr("names"))) << head;
  }
  EXPECT_EQ(csv("h,hand,,force,\ntime,x,y,x,y\ns,mm,mm,N,N\n" + rows)->arrays[1].unit, "mm");
  EXPECT_EQ(names_of("a,b,c,d,e\ntime,p,q,r,s\n" + rows)[1], "p");  // the lower line distinguishes them
  EXPECT_EQ(names_of("a,b,b,d,d\ntime,p,p,r,s\n" + rows)[1], "p");  // and here both lines do not
}

TEST(DecodeCsv, LeavesCommentsBehindNumbersOut) {
  const auto contents = csv("t,x\n0,1.5\n0.25,-2 # touched, twice\n");
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(values_of("t,x\n0,1.5\n0.25,-2 # touched, twice\n"), kTwoByTwo);
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("comment"), HasSubstr("line 3"))));
  EXPECT_THAT(obstacle_of("t,x\n0,go #1\n1,go #2\n", 1).message, HasSubstr("'go #1'"));
}

TEST(DecodeCsv, SaysWhatToDoAboutACellThatIsNoNumber) {
  EXPECT_THAT(obstacle_of("t,x\n0,1\n1,#DIV/0!\n2,1\n", 1).remedy, HasSubstr("cell"));
  EXPECT_THAT(obstacle_of("t,x\n0,1\n1,1.5 mm\n2,1\n", 1).remedy, HasSubstr("unit"));
  EXPECT_THAT(obstacle_of("t;x\n0;1\n1;[1, 2]\n2;1\n", 1).remedy, HasSubstr("column"));
}

TEST(DecodeCsv, ReadsQuotedNamesWithSeparators) {
  EXPECT_EQ(names_of("\"time, s\",\"say \"\"x\"\"\"\n0,1\n"), (std::vector<std::string>{"time, s", "say \"x\""}));
  EXPECT_THAT(obstacle_of("t,note,x\n0,\"a, b\",1\n1,\"c\",2\n", 1).message, HasSubstr("'a, b'"));
  EXPECT_EQ(values_of("\"t\",\"x\"\n\"0\",\"1.5\"\n\"0.25\",\"-2\"\n"), kTwoByTwo);
}

TEST(DecodeCsv, ReadsTimesOfDayAcrossMidnight) {
  const auto contents = csv("time,x\n23:59:59.500,1\n23:59:59.750,2\n0:00:00.250,3\n");
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].values, Vector((Vector(3) << 86399.5, 86399.75, 86400.25).finished()));
  EXPECT_EQ(contents->arrays[0].unit, "s");
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("'time'"), HasSubstr("seconds"), HasSubstr("midnight"))));
}

TEST(DecodeCsv, ReadsDatesAsIso8601WritesThem) {
  const auto contents = csv("time,x\n2024-02-29T23:59:59.5+01:00,1\n2024-03-01 00:00:00Z,2\n");
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].values, Vector((Vector(2) << 82799.5, 86400).finished()));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("seconds"), HasSubstr("2024-02-29 00:00"))));
  EXPECT_EQ(values_of("time,x\n2024/02/29 10:00:00,1\n2024/03/01 10:00:00,2\n")(1, 0), 86400 + 36000);
  EXPECT_EQ(values_of("time;x\n29.02.2024 10:00:00;1\n01.03.2024 10:00:00,5;2\n")(1, 0), 86400 + 36000.5);
  EXPECT_THAT(obstacle_of("time,x\n01/02/2024 10:15:30,1\n01/02/2024 10:15:31,2\n", 0).remedy,
              HasSubstr("2024-03-01T"));
  EXPECT_THAT(obstacle_of("time,x\n2024-02-30,1\n2024-02-31,2\n", 0).message, HasSubstr("'2024-02-30'"));
}

TEST(DecodeCsv, ReadsHoursThatAreCountedTwiceTo12) {
  EXPECT_EQ(values_of("time,x\n11:59:59.5 AM,1\n12:00:00.25 PM,2\n")(1, 0), 43200.25);
  EXPECT_EQ(values_of("time,x\n11:59:59 pm,1\n12:00:00 am,2\n1:00:00 am,2\n")(2, 0), 90000);
  const auto contents = csv("time,x\n2/29/2024 11:59:59 PM,1\n3/1/2024 12:00:00.5 AM,2\n");
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].values, Vector((Vector(2) << 86399, 86400.5).finished()));
  EXPECT_EQ(values_of("time;x\n9.2.2024 10:00:00,25;1\n10.2.2024 10:00:00,5;2\n")(1, 0), 86400 + 36000.5);
  for (const char* time : {"13:00:00 PM", "0:00:00 AM", "10:00:00 XM", "AM", "2024-03-01 AM", "13/1/2024 1:00:00 AM"}) {
    EXPECT_THAT(obstacle_of(std::string("time,x\n") + time + ",1\n" + time + ",2\n", 0).message,
                HasSubstr("'" + std::string(time) + "'"))
        << time;
  }
}

TEST(DecodeCsv, RefusesTimesAmongOtherNumbers) {
  EXPECT_THAT(obstacle_of("time,x\n10:15:30,1\n37,2\n10:15:31,3\n", 0).message,
              AllOf(HasSubstr("'time'"), HasSubstr("numbers")));
  EXPECT_THAT(obstacle_of("time,x\n10:15:30,1\n2024-03-01T10:15:31,3\n", 0).message,
              AllOf(HasSubstr("'time'"), HasSubstr("date")));
}

TEST(DecodeCsv, ReadsUtf16) {
  const std::u16string wide = u"\uFEFFtime;x [\u00B5m]\r\n0;1,5\r\n0,25;-2\r\n";
  std::string little, big;
  for (const char16_t c : wide) {
    const char low = static_cast<char>(c & 0xFF), high = static_cast<char>(c >> 8);
    little += low, little += high;
    big += high, big += low;
  }
  for (const std::string& text : {little, big}) {
    EXPECT_EQ(values_of(text), kTwoByTwo);
    EXPECT_EQ(names_of(text)[1], "x [µm]");
    EXPECT_THAT(csv(text)->notes, Contains(HasSubstr("UTF-16")));
  }
}

TEST(DecodeCsv, ToleratesASeparatorAtTheEndOfEveryLine) {
  EXPECT_EQ(values_of("t,x\n0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_EQ(values_of("t,x,\n0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_EQ(values_of("0,1.5,\n0.25,-2,\n"), kTwoByTwo);
  EXPECT_THAT(csv("0,1,\n")->notes, Contains(HasSubstr("separator")));
}

TEST(DecodeCsv, RefusesASeparatorAtTheEndOfSomeLines) {
  EXPECT_EQ(error_of("0,1,\n2,3\n4,5,\n").where, "line 2");
}

TEST(DecodeCsv, LeavesAnIncompleteLastLineAsideAndSaysSo) {
  for (const char* text :
       {"t,x\n0,1.5\n0.25,-2\n0.5", "0,1.5\n0.25,-2\n0.5,", "0,1.5\n0.25,-2\n0.5,1e", "0,1.5\n0.25,-2\n0.5,-"}) {
    EXPECT_EQ(values_of(text), kTwoByTwo) << text;
    EXPECT_THAT(csv(text)->notes, Contains(HasSubstr(text[0] == 't' ? "line 4" : "line 3"))) << text;
  }
}

TEST(DecodeCsv, SaysThatALastNumberWithoutLineEndMayBeCut) {
  EXPECT_EQ(values_of("0,1.5\n0.25,-2"), kTwoByTwo);
  EXPECT_THAT(csv("0,1.5\n0.25,-2")->notes, Contains(HasSubstr("line 2")));
}

TEST(DecodeCsv, RefusesAFileWithoutNumbers) {
  EXPECT_THAT(error_of("t,x\n").message, HasSubstr("numbers"));
  EXPECT_THAT(error_of("# nothing\n").message, HasSubstr("numbers"));
  EXPECT_THAT(error_of("t,x\n0.5").message, HasSubstr("line 2"));
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
    auto file = OpenFile::open(folder.write("table.csv", text)).value();
    auto passing = file.in_passing().value();
    ASSERT_TRUE(passing.read_on());
    const Contents found = decode_csv(passing).value(), expected = csv(text).value();
    EXPECT_EQ(file.sha256(), sha256(std::as_bytes(std::span(text))));
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
  auto file = OpenFile::open(folder.write("table.csv", text)).value();
  auto passing = file.in_passing().value();
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
  const std::string text = long_table(2 * FileInPassing::kPiece, "t,x,F\n") + "1,2\n4,5,6\n";
  auto file = OpenFile::open(folder.write("table.csv", text)).value();
  auto passing = file.in_passing().value();
  ASSERT_TRUE(passing.read_on());
  const auto found = decode_csv(passing);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().line(), error_of(text).line());
  EXPECT_THAT(found.error().message, HasSubstr("2 cells"));
}

TEST(DecodeCsv, OfAFileThatBecomesShorterSaysSo) {
  const test::Folder folder;
  const auto file = folder.write("table.csv", long_table(3 * FileInPassing::kPiece, "t,x,F\n"));
  auto open = OpenFile::open(file).value();
  auto passing = open.in_passing().value();
  ASSERT_TRUE(passing.read_on());
  std::filesystem::resize_file(file, FileInPassing::kPiece + 1000);
  const auto found = decode_csv(passing);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("shorter"));
}

TEST(DecodeCsv, KeepsEpochTimestamps) {
  const Matrix values = values_of("1700000000.123456,1\n1700000000.124456,2\n");
  EXPECT_EQ(values(0, 0), 1700000000.123456);
  EXPECT_NEAR(values(1, 0) - values(0, 0), 0.001, 3e-7);
}

}  // namespace csv_test
}  // namespace mbk::recording
