#include "mbk/files/tables/lvm.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace mbk::recording {
namespace lvm_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string file_header(std::string_view x_columns = "One", std::string_view decimal = ".") {
  return fmt::format(
      "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{}\n"
      "Multi_Headings\tNo\nX_Columns\t{}\nTime_Pref\tRelative\nOperator\tlab\nDate\t2024/03/01\n"
      "Time\t10:15:30.5\n***End_of_Header***\t\n\t\n",
      decimal, x_columns);
}

/// Of two channels, beginning so many seconds after 10:15:00.
std::string segment_header(double start = 30.5, int samples = 3, std::string_view x0 = "0",
                           std::string_view delta = "0.001") {
  return fmt::format(
      "Channels\t2\t\t\t\nSamples\t{0}\t{0}\t\nDate\t2024/03/01\t2024/03/"
      "01\t\nTime\t10:15:{1:06.3f}\t10:15:{1:06.3f}\t\n"
      "Y_Unit_Label\tmm\tNewtons\t\nX_Dimension\tTime\tTime\t\nX0\t{2}\t{2}\t\nDelta_X\t{3}\t{3}\t\n"
      "***End_of_Header***\t\t\t\n",
      samples, start, x0, delta);
}

const std::string kLabels = "X_Value\thand_x\tforce_x\tComment\n";
const std::string kRows = "0.000\t1\t-1\n0.001\t2\t-2\n0.002\t3\t-3\n";

Result<std::vector<NamedContents>> lvm(std::string_view text) {
  return decode_lvm(std::as_bytes(std::span(text)));
}

std::vector<NamedContents> good(std::string_view text) {
  auto records = lvm(text);
  EXPECT_TRUE(records) << records.error().line();
  return records ? std::move(*records) : std::vector<NamedContents>();
}

Contents one(std::string_view text) {
  auto records = good(text);
  EXPECT_THAT(records, SizeIs(1));
  return records.empty() ? Contents() : std::move(records.front().contents);
}

std::string error_of(std::string_view text) {
  const auto records = lvm(text);
  return records ? "none" : records.error().line();
}

std::vector<std::string> names_of(const Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) names.push_back(array.name);
  return names;
}

TEST(DecodeLvm, ReadsTimeNamesUnitsAndRate) {
  const std::string text = file_header() + segment_header() + kLabels + kRows;
  ASSERT_TRUE(looks_like_lvm(text));
  const Contents contents = one(text);
  EXPECT_THAT(names_of(contents), ElementsAre("X_Value", "hand_x", "force_x"));
  EXPECT_EQ(contents.arrays[0].means, "time");
  EXPECT_EQ(contents.arrays[0].unit, "s");
  EXPECT_EQ(contents.arrays[0].values(2, 0), 0.002);
  EXPECT_EQ(contents.arrays[1].unit, "mm");
  EXPECT_EQ(contents.arrays[1].values, Vector::LinSpaced(3, 1, 3));
  EXPECT_EQ(contents.arrays[2].unit, "Newtons");
  EXPECT_EQ(contents.arrays[2].rate_hz, 1000.0);
  EXPECT_THAT(contents.notes, IsEmpty());
}

TEST(DecodeLvm, ReadsSeparatorsAsTheHeaderSaysThem) {
  std::string commas = file_header() + segment_header() + kLabels + kRows;
  std::ranges::replace(commas, '\t', ',');
  commas.replace(commas.find("Separator,Tab"), 13, "Separator,Comma");
  EXPECT_EQ(one(commas).arrays[2].values, Vector::LinSpaced(3, -1, -3));

  std::string decimal =
      file_header("One", ",") + segment_header(30.5, 3, "0,0000000000000000E+0", "1,000000E-3") + kLabels + kRows;
  for (auto at = decimal.find("0.00"); at != decimal.npos; at = decimal.find("0.00")) decimal[at + 1] = ',';
  EXPECT_EQ(one(decimal).arrays[0].values(2, 0), 0.002);
  EXPECT_EQ(one(decimal).arrays[1].rate_hz, 1000.0);

  std::string old = decimal;  // which does not say it
  old.erase(old.find("Decimal_Separator"), 20);
  EXPECT_EQ(one(old).arrays[0].values(2, 0), 0.002);

  std::string both = commas;
  both.replace(both.find("Decimal_Separator,."), 19, "Decimal_Separator,,");
  EXPECT_THAT(error_of(both), AllOf(HasSubstr("line 1"), HasSubstr("comma")));
  EXPECT_THAT(error_of(file_header("One", ",") + segment_header() + kLabels + kRows), HasSubstr("'0.000'"));
}

TEST(DecodeLvm, MakesTheTimeOfDeltaXWhereThereIsNoX) {
  const std::string rows = "\t1\t-1\n\t2\t-2\n\t3\t-3\n";
  const Contents contents = one(file_header("No") + segment_header() + kLabels + rows);
  EXPECT_THAT(names_of(contents), ElementsAre("hand_x", "force_x"));
  EXPECT_EQ(contents.arrays[0].rate_hz, 1000.0);
  EXPECT_EQ(contents.arrays[1].values, Vector::LinSpaced(3, -1, -3));
  const Contents unknown = one(file_header("No") + segment_header(30.5, 3, "0", "1.000000") + kLabels + rows);
  EXPECT_EQ(unknown.arrays[0].rate_hz, 0.0);
  EXPECT_THAT(unknown.notes, Contains(HasSubstr("Delta_X")));
}

TEST(DecodeLvm, ReadsAnXForEachChannel) {
  const auto with = [](std::string_view rows, std::string_view delta) {
    return file_header("Multi") +
           fmt::format(
               "Channels\t2\nSamples\t3\t\t3\nY_Unit_Label\tm\t\tN\nX_Dimension\tTime\t\tTime\nX0\t0\t\t0\n"
               "Delta_X\t0.001\t\t{}\n***End_of_Header***\nX_Value\tx\tX_Value\tFx\tComment\n",
               delta) +
           std::string(rows);
  };
  const Contents same = one(with("0\t1\t0\t-1\n0.001\t2\t0.001\t-2\n0.002\t3\t0.002\t-3\n", "0.001"));
  EXPECT_THAT(names_of(same), ElementsAre("X_Value", "x", "Fx"));
  EXPECT_EQ(same.arrays[2].unit, "N");
  EXPECT_THAT(same.clocks, IsEmpty());
  const Contents other = one(with("0\t1\t0\t-1\n0.001\t2\t0.002\t-2\n0.002\t3\t\t\n", "0.002"));
  EXPECT_THAT(names_of(other), ElementsAre("x", "Fx"));
  ASSERT_THAT(other.clocks, SizeIs(2));
  EXPECT_EQ(other.clocks[1].name, "Fx");
  EXPECT_EQ(other.clocks[1].time, (Vector(2) << 0, 0.002).finished());
  EXPECT_EQ(other.arrays[1].clock, 1);
  EXPECT_EQ(other.arrays[1].values, (Vector(2) << -1, -2).finished());
  EXPECT_EQ(other.arrays[0].values.rows(), 3);
}

TEST(DecodeLvm, GivesAChannelOfAnotherIntervalItsOwnClock) {
  std::string header = segment_header();
  header.replace(header.find("Delta_X\t0.001\t0.001"), 19, "Delta_X\t0.001\t0.005");
  const Contents contents = one(file_header() + header + kLabels + "0\t1\t-1\n0.001\t2\t-2\n0.002\t3\t\n");
  ASSERT_THAT(contents.clocks, SizeIs(2));
  EXPECT_EQ(contents.clocks[1].time, (Vector(2) << 0, 0.005).finished());
}

TEST(DecodeLvm, MakesSegmentsRecordsOfTheirOwn) {
  const std::string text = file_header() + segment_header(30.5) + kLabels + kRows + "\n\t\n" + segment_header(45.0) +
                           kLabels + "0.000\t7\t-7\n0.001\t8\t-8\n";
  const auto records = good(text);
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[0].name.name, "1");
  EXPECT_EQ(records[1].name.name, "2");
  EXPECT_THAT(records[1].name.description, AllOf(HasSubstr("2024/03/01 10:15:45.000"), HasSubstr("2 samples")));
  EXPECT_EQ(records[1].contents.arrays[1].values, (Vector(2) << 7, 8).finished());
  EXPECT_THAT(records[1].contents.notes,
              ElementsAre(HasSubstr("2 of 2"), AllOf(HasSubstr("3 samples"), HasSubstr(" 2"))));
}

TEST(DecodeLvm, JoinsSegmentsWithoutAPause) {
  const std::string first = file_header() + segment_header(30.5) + kLabels + kRows;
  const std::string anew = first + segment_header(30.503) + kLabels + "0.000\t4\t-4\n0.001\t5\t-5\n0.002\t6\t-6\n";
  const std::string on =
      first + segment_header(30.5, 3, "0.003") + kLabels + "0.003\t4\t-4\n0.004\t5\t-5\n0.005\t6\t-6\n";
  const std::string on_with_times =
      first + segment_header(30.503, 3, "0.003") + kLabels + "0.003\t4\t-4\n0.004\t5\t-5\n0.005\t6\t-6\n";
  for (const std::string& text : {anew, on, on_with_times}) {
    const Contents contents = one(text);
    ASSERT_THAT(contents.arrays, SizeIs(3)) << text;
    EXPECT_EQ(contents.arrays[1].values, Vector::LinSpaced(6, 1, 6));
    EXPECT_LT((contents.arrays[0].values - Vector(Vector::LinSpaced(6, 0, 0.005))).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("2 segments")));
  }
  const std::string without = file_header("No") + segment_header(30.5) + kLabels + "\t1\t-1\n\t2\t-2\n\t3\t-3\n" +
                              segment_header(30.503) + kLabels + "\t4\t-4\n\t5\t-5\n\t6\t-6\n";
  EXPECT_EQ(one(without).arrays[0].values, Vector::LinSpaced(6, 1, 6));
  std::string other = anew;
  other.replace(other.rfind("hand_x"), 6, "hand_y");
  EXPECT_THAT(good(other), SizeIs(2));
}

TEST(DecodeLvm, JoinsSegmentsOfOneSampleByTheirTimes) {
  std::string text = file_header();
  for (int k = 0; k < 4; ++k)
    text += segment_header(30.5 + 0.1 * k, 1, "0", "1.000000") + kLabels + fmt::format("0\t{}\t0\n", k);
  const Contents contents = one(text);
  EXPECT_NEAR(contents.arrays[0].values(3, 0), 0.3, 1e-6);
  EXPECT_EQ(contents.arrays[1].rate_hz, 0.0);
}

TEST(DecodeLvm, TakesXThatStartsAnewForANewSegment) {
  const auto records = good(file_header() + segment_header() + kLabels + kRows + kRows + "0.000\t9\t-9\n");
  ASSERT_THAT(records, SizeIs(3));
  EXPECT_EQ(records[1].contents.arrays[1].values, Vector::LinSpaced(3, 1, 3));
  EXPECT_EQ(records[2].contents.arrays[1].values(0, 0), 9);
  const auto running = good(file_header() + segment_header() + kLabels + kRows + "0.003\t4\t-4\n");
  EXPECT_THAT(running, SizeIs(1));
}

TEST(DecodeLvm, TakesTheSamplesOfASegmentWithoutX) {
  std::string rows;
  for (int k = 0; k < 6; ++k) rows += fmt::format("\t{}\t0\n", k);
  const auto records = good(file_header("No") + segment_header() + kLabels + rows);
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].contents.arrays[0].values, Vector::LinSpaced(3, 3, 5));
  const Contents odd = one(file_header("No") + segment_header() + kLabels + rows + "\t6\t0\n");
  EXPECT_THAT(odd.notes, ElementsAre(AllOf(HasSubstr("3 samples"), HasSubstr(" 7"))));
}

TEST(DecodeLvm, LeavesCommentsAndSpecialBlocksOut) {
  const Contents contents =
      one(file_header() + "***Start_Special***\nx\t1\n2\t3\n***End_Special***\nNotes\tvalid only for hand_x\n" +
          segment_header() + kLabels + "0\t1\t-1\tOK, go\n0.001\t2\t-2\n0.002\t3\t-3\tdone\n");
  EXPECT_EQ(contents.arrays[2].values, Vector::LinSpaced(3, -1, -3));
  EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("2 comments"), HasSubstr("LabVIEW")));
}

TEST(DecodeLvm, KeepsChannelsWithoutSamples) {
  const Contents contents = one(file_header() + segment_header() + kLabels + "0\t\t-1\n0.001\t\t-2\n0.002\t\t-3\n");
  EXPECT_TRUE(std::isnan(contents.arrays[1].values(0, 0)));
  EXPECT_EQ(contents.arrays[2].values, Vector::LinSpaced(3, -1, -3));
}

TEST(DecodeLvm, SaysWhereXIsNoTime) {
  std::string text = file_header() + segment_header() + kLabels + kRows;
  for (auto at = text.find("X_Dimension\tTime\tTime"); at != text.npos; at = text.npos)
    text.replace(at, 21, "X_Dimension\tFrequency\tFrequency");
  const Contents contents = one(text);
  EXPECT_EQ(contents.arrays[0].means, "");
  EXPECT_EQ(contents.arrays[1].rate_hz, 0.0);
  EXPECT_THAT(contents.notes, Contains(HasSubstr("'Frequency'")));
}

TEST(DecodeLvm, RefusesWhatIsDamaged) {
  const std::string whole = file_header() + segment_header() + kLabels + kRows;
  EXPECT_THAT(error_of("LabVIEW Measurement\t\nSeparator\tTab\n"),
              AllOf(HasSubstr("line 1"), HasSubstr("'LabVIEW Measurement'")));
  EXPECT_THAT(error_of(file_header()), HasSubstr("sample"));
  EXPECT_THAT(error_of(whole + "abc\t1\t2\n"), AllOf(HasSubstr("line 27"), HasSubstr("'abc'")));
  EXPECT_THAT(error_of(whole + "abc\t1\t2\n0.003\t1\t2\n"), HasSubstr("line 28"));
  EXPECT_THAT(error_of(whole + "0.003\tone\t2\n"),
              AllOf(HasSubstr("line 27"), HasSubstr("column 2"), HasSubstr("'one'")));
  std::string no_comments = whole;
  no_comments.erase(no_comments.find("\tComment"), 8);
  EXPECT_THAT(error_of(no_comments + "0.003\t1\t2\t3\n"), AllOf(HasSubstr("4 cells"), HasSubstr("3 columns")));
  const Contents cut = one(whole + "0.003\t1");
  EXPECT_EQ(cut.arrays[0].values.rows(), 3);
  EXPECT_THAT(cut.notes, ElementsAre(HasSubstr("line 27")));
}

TEST(DecodeLvm, BoundsWhatASmallFileClaims) {
  std::string text = file_header() + segment_header() + kLabels;
  for (int k = 0; k < 20'000; ++k) text += "0\t1\t2\n1\t1\t2\n";
  EXPECT_THAT(error_of(text), HasSubstr("segments"));
  std::string wide = file_header() + "X_Value";
  for (int k = 0; k < 9'000; ++k) wide += "\tc";
  wide += "\n";
  for (int k = 0; k < 20'000; ++k) wide += "1\n";
  EXPECT_THAT(error_of(wide), HasSubstr("9001 columns"));
}

TEST(DecodeLvm, CutAnywhereGivesAnErrorOrTheCompleteLines) {
  const std::string whole =
      file_header() + segment_header(30.5) + kLabels + kRows + segment_header(45.0) + kLabels + kRows;
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto records = lvm(std::string_view(whole).substr(0, n));
    if (!records) {
      EXPECT_EQ(records.error().line().find('\n'), std::string::npos);
      continue;
    }
    for (const NamedContents& record : *records) {
      for (const Array& array : record.contents.arrays) EXPECT_LE(array.values.rows(), 3);
    }
  }
}

}  // namespace lvm_test
}  // namespace mbk::recording
