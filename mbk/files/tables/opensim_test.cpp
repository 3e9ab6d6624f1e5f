#include "mbk/files/tables/opensim.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace mbk::recording {
namespace opensim_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kMotion =
    "Coordinates\nversion=1\nnRows=3\nnColumns=3\ninDegrees=yes\nUnits are S.I. units\n\nendheader\ntime\tq1\tF\n"
    "0\t90\t1\n0.01\tNAN\t2\n0.02\t\t3\n";
const std::string kMarkers =
    "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t3\t2\tmm\n"
    "Frame#\tTime\tHand\t\t\tHand\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n1\t0\t1\t2\t3\t4\t5\t6\n2\t0.01\t1\t2\t3\t-"
    "nan\t\t\n"
    "3\t0.02\t1\t2\t3\n";

std::vector<std::string> names_of(const Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) names.push_back(array.name);
  return names;
}

template <class Decode>
std::string error_of(Decode decode, const std::string& text) {
  const auto contents = decode(std::as_bytes(std::span(text)));
  return contents ? "none" : contents.error().line();
}

TEST(DecodeOpensim, ReadsTablesOfToday) {
  ASSERT_TRUE(looks_like_opensim(kMotion));
  const auto contents = decode_opensim(std::as_bytes(std::span(kMotion)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_THAT(names_of(*contents), ElementsAre("time", "q1", "F"));
  EXPECT_THAT(contents->units, ElementsAre("deg"));
  EXPECT_EQ(contents->arrays[2].values, Vector::LinSpaced(3, 1, 3));
  EXPECT_EQ(contents->arrays[1].values(0, 0), 90);
  EXPECT_TRUE(std::isnan(contents->arrays[1].values(1, 0)) && std::isnan(contents->arrays[1].values(2, 0)));
  EXPECT_TRUE(contents->notes.empty());
}

TEST(DecodeOpensim, ReadsOldTables) {
  const std::string old = "name old\ndatacolumns 2\ndatarows 9\nendheader\n\n  time   x \n 0.0  10.0\n 1 1.#QNAN\n";
  ASSERT_TRUE(looks_like_opensim(old));
  const auto contents = decode_opensim(std::as_bytes(std::span(old)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_THAT(names_of(*contents), ElementsAre("time", "x"));
  EXPECT_TRUE(contents->units.empty());
  EXPECT_TRUE(std::isnan(contents->arrays[1].values(1, 0)));
  EXPECT_THAT(contents->notes, Contains(AllOf(HasSubstr("9 rows"), HasSubstr(" 2"))));
}

TEST(DecodeOpensim, RefusesWhatIsNoTable) {
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\n"), HasSubstr("label"));
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\n0\t1\n"), HasSubstr("label"));
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\ntime\tx\n"), HasSubstr("number"));
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\ntime\tx\n0\t1\t2\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("3 numbers")));
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\ntime\tx\n0\tone\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("column 2"), HasSubstr("'one'")));
}

TEST(DecodeOpensim, NamesColumnsOfVectors) {
  const std::string text =
      "DataRate=100\nDataType=Quaternion\nversion=3\nendheader\ntime\tpelvis_imu\tF\n0\t0.5,0.5,0.5,-0.5\t1\n0.01\t1,0,"
      "0,0\t2\n";
  const auto contents = decode_opensim(std::as_bytes(std::span(text)));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_TRUE(contents->arrays[1].obstacle);
  EXPECT_THAT(contents->arrays[1].obstacle->line(),
              AllOf(HasSubstr("line 6"), HasSubstr("column 2"), HasSubstr("'0.5,0.5,0.5,-0.5'")));
  EXPECT_EQ(contents->arrays[2].values, Vector::LinSpaced(2, 1, 2));
  EXPECT_THAT(contents->notes, Contains(HasSubstr("pelvis_imu")));
  EXPECT_THAT(error_of(decode_opensim, "a\nendheader\ntime\tx\n0\t0,5\n"), HasSubstr("'0,5'"));
}

TEST(DecodeOpensim, SaysWhereDegreesAreLeftOpen) {
  const std::string text = "a\nendheader\ntime\tq1\n0\t90\n";
  EXPECT_THAT(decode_opensim(std::as_bytes(std::span(text)))->notes,
              ElementsAre(AllOf(HasSubstr("inDegrees"), HasSubstr("--channels"))));
}

TEST(DecodeOpensim, LeavesAnIncompleteLastLineAside) {
  const std::string cut = "a\nendheader\ntime\tx\n0\t1\n0.1";
  const auto contents = decode_opensim(std::as_bytes(std::span(cut)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].values.rows(), 1);
  EXPECT_THAT(contents->notes, Contains(HasSubstr("line 5")));
}

TEST(DecodeTrc, ReadsMarkersWithUnitAndRate) {
  ASSERT_TRUE(looks_like_trc(kMarkers));
  const auto contents = decode_trc(std::as_bytes(std::span(kMarkers)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_THAT(names_of(*contents),
              ElementsAre("Frame#", "Time", "Hand.x", "Hand.y", "Hand.z", "Hand#2.x", "Hand#2.y", "Hand#2.z"));
  EXPECT_EQ(contents->arrays[2].unit, "mm");
  EXPECT_EQ(contents->arrays[2].rate_hz, 100.0);
  EXPECT_EQ(contents->arrays[1].unit, "s");
  EXPECT_EQ(contents->arrays[7].values(0, 0), 6);
  EXPECT_TRUE(std::isnan(contents->arrays[5].values(1, 0)) && std::isnan(contents->arrays[7].values(2, 0)));
}

TEST(DecodeTrc, RefusesWhatDoesNotFit) {
  const auto with = [](std::string_view from, std::string_view to) {
    std::string text = kMarkers;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(error_of(decode_trc, with("Frame#", "Row")), AllOf(HasSubstr("Frame#"), HasSubstr("Time")));
  EXPECT_THAT(error_of(decode_trc, with("\t5\t6\n", "\t5\t6\t7\n")), HasSubstr("9 cells"));
  EXPECT_THAT(error_of(decode_trc, with("1\t0\t1", "1\tx\t1")),
              AllOf(HasSubstr("line 7"), HasSubstr("column 2"), HasSubstr("'x'")));
  EXPECT_THAT(error_of(decode_trc, with("X1\tY1", "Y1\tX1")),
              AllOf(HasSubstr("line 5"), HasSubstr("'Y1'"), HasSubstr("'Hand'")));
  EXPECT_THAT(error_of(decode_trc, with("\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n", "")), HasSubstr("axes"));
  EXPECT_THAT(error_of(decode_trc, "PathFileType\t4\n"), HasSubstr("header"));
}

TEST(DecodeTrc, KeepsMemoryBelowWhatItsLinesCanHold) {
  std::string text = "PathFileType\t4\nDataRate\tUnits\n100\tmm\nFrame#\tTime", axes = "\t\t", lines;
  for (int m = 1; m <= 3000; ++m) {
    text += fmt::format("\tM{}", m);
    axes += fmt::format("X{0}\tY{0}\tZ{0}\t", m);
  }
  for (int row = 0; row < 100'000; ++row) lines += "1\n";
  EXPECT_THAT(error_of(decode_trc, text + "\n" + axes + "\n" + lines), HasSubstr("9002 columns"));
}

std::string replaced_all(std::string text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

TEST(DecodeTrc, ReadsVariantsAsOpensimDoes) {
  const auto with = [](std::string_view from, std::string_view to) {
    std::string text = kMarkers;
    return text.replace(text.find(from), from.size(), to);
  };
  std::string commas = kMarkers, semicolons = kMarkers;
  std::ranges::replace(commas, '\t', ',');
  std::ranges::replace(semicolons, '\t', ';');
  struct Variant {
    std::string text, note;
  };
  for (const Variant& one : {Variant{with("\t2\tmm", "\t3\tmm"), "3 markers"},
                             {with("X2\tY2\tZ2", "X7\tY7\tZ7"), "X7"},
                             {with("\tCameraRate", ""), ""},  // a key fewer than values: those before it are right
                             {with("NumMarkers\tUnits", "NumMarkers\t\tUnits"), ""},  // a tab more
                             {with("mm\n", "mm\t\t\n"), ""},
                             {with("Hand\t\t\tHand\t\t\n", "Hand\tHand\n"), ""},
                             {with("Frame#\tTime\tHand\t\t\tHand\t\t\n", "Frame# Time  Hand   Hand\n"), ""},
                             {commas, ""},
                             {semicolons, ""},
                             {replaced_all(commas, "\n\n", "\n,,,,,,,\n"), ""}}) {
    const auto contents = decode_trc(std::as_bytes(std::span(one.text)));
    ASSERT_TRUE(contents) << contents.error().line() << one.text;
    EXPECT_EQ(contents->arrays[2].values, Vector::Constant(3, 1)) << one.text;
    EXPECT_EQ(contents->arrays[7].values(0, 0), 6) << one.text;
    EXPECT_EQ(contents->arrays[2].rate_hz, 100.0) << one.text;
    if (!one.note.empty()) {
      EXPECT_THAT(contents->notes, ElementsAre(HasSubstr(one.note)));
    }
  }
  const std::string without_unit = with("mm\n", "\n");
  EXPECT_THAT(decode_trc(std::as_bytes(std::span(without_unit)))->notes.front(), HasSubstr("unit"));
}

}  // namespace opensim_test
}  // namespace mbk::recording
