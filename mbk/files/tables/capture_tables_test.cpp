#include "mbk/files/tables/capture_tables.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "mbk/files/tables/delsys.h"

namespace mbk::recording {
namespace capture_tables_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Decode = Result<Contents> (*)(std::span<const std::byte>);

Contents good(Decode decode, std::string_view text) {
  auto contents = decode(std::as_bytes(std::span(text)));
  EXPECT_TRUE(contents) << contents.error().line();
  return contents ? std::move(*contents) : Contents();
}

std::string error_of(Decode decode, std::string_view text) {
  const auto contents = decode(std::as_bytes(std::span(text)));
  return contents ? "none" : contents.error().line();
}

std::vector<std::string> names_of(const Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) names.push_back(array.name);
  return names;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  return text.replace(text.find(from), from.size(), to);
}

// ---- Vicon ----

const std::string kTrajectories =
    "Trajectories\n100\n,,S:HAND,,,S:ELB,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
    "5,0,1,2,3,4,5,6\n6,0,1.5,2,3,,,\n7,0,2,2,3,4,5,6\n";
const std::string kDevices =
    "Devices\n200\n,,Plate - Force,,Trigno - 1\nFrame,Sub Frame,Fx,Fy,EMG1\n,,N,N,V\n"
    "5,0,1,2,3\n5,1,2,2,3\n6,0,3,2,3\n6,1,4,2,3\n7,0,5,2,3\n7,1,6,2,3\n";

TEST(DecodeVicon, ReadsEachSectionAtItsRate) {
  const std::string text = kDevices + "\n" + kTrajectories;
  ASSERT_TRUE(looks_like_vicon(text));
  const Contents contents = good(decode_vicon, text);
  EXPECT_THAT(names_of(contents), ElementsAre("Plate - Force.Fx", "Plate - Force.Fy", "Trigno - 1.EMG1", "S:HAND.x",
                                              "S:HAND.y", "S:HAND.z", "S:ELB.x", "S:ELB.y", "S:ELB.z"));
  EXPECT_EQ(contents.arrays[0].rate_hz, 200.0);
  EXPECT_EQ(contents.arrays[0].unit, "N");
  EXPECT_EQ(contents.arrays[0].values, Vector::LinSpaced(6, 1, 6));
  EXPECT_EQ(contents.arrays[2].unit, "V");
  EXPECT_EQ(contents.arrays[3].rate_hz, 100.0);
  EXPECT_EQ(contents.arrays[3].unit, "mm");
  EXPECT_EQ(contents.arrays[3].values, Vector::LinSpaced(3, 1, 2));
  EXPECT_TRUE(std::isnan(contents.arrays[6].values(1, 0)));
  EXPECT_THAT(contents.notes, IsEmpty());
}

TEST(DecodeVicon, ReadsWhatASpreadsheetSaved) {
  std::string text = "\xEF\xBB\xBF" + kTrajectories + "\n" + kDevices;
  std::string padded;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    padded += text.substr(at, end - at) + ",,,\r\n";
    at = end + 1;
  }
  EXPECT_THAT(good(decode_vicon, padded).arrays, SizeIs(9));
  std::string semicolons = padded;
  std::ranges::replace(semicolons, ',', ';');
  std::ranges::replace(semicolons, '.', ',');
  EXPECT_EQ(good(decode_vicon, semicolons).arrays[0].values, Vector::LinSpaced(3, 1, 2));
}

TEST(DecodeVicon, NamesSectionsWithoutFrames) {
  const Contents contents =
      good(decode_vicon,
           "Events\n100\nSubject,Context,Name,Time (s),Description\nS,Left,Foot Strike,1.2,\n\n" + kTrajectories);
  EXPECT_THAT(contents.arrays, SizeIs(6));
  EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("Events")));
}

TEST(DecodeVicon, NumbersRepeatedNames) {
  EXPECT_THAT(names_of(good(decode_vicon, replaced(kTrajectories, "S:ELB", "S:HAND"))), Contains("S:HAND.x#2"));
}

TEST(DecodeVicon, RefusesWhatWouldMoveInTime) {
  EXPECT_THAT(error_of(decode_vicon, replaced(kTrajectories, "7,0", "8,0")),
              AllOf(HasSubstr("line 8"), HasSubstr("frame 8, 0"), HasSubstr("frame 6, 0")));
  EXPECT_THAT(error_of(decode_vicon, replaced(kDevices, "6,1", "6,2")), HasSubstr("frame 6, 2"));
  EXPECT_THAT(error_of(decode_vicon, replaced(kDevices, "6,1,4,2,3\n", "")),
              AllOf(HasSubstr("frame 7, 0"), HasSubstr("frame 6, 0")));
  EXPECT_THAT(
      error_of(decode_vicon,
               kDevices + "\n" + replaced(replaced(replaced(kTrajectories, "5,0", "4,0"), "6,0", "5,0"), "7,0", "6,0")),
      AllOf(HasSubstr("'Devices'"), HasSubstr("frame 5"), HasSubstr("'Trajectories'"), HasSubstr("frame 4")));
  EXPECT_THAT(error_of(decode_vicon, replaced(kTrajectories, "100\n", "fast\n")),
              AllOf(HasSubstr("line 4"), HasSubstr("rate")));
  EXPECT_THAT(error_of(decode_vicon, replaced(kTrajectories, "1.5", "x")),
              AllOf(HasSubstr("line 7"), HasSubstr("column 3"), HasSubstr("'x'")));
  EXPECT_THAT(error_of(decode_vicon, replaced(kTrajectories, "4,5,6\n", "4,5,6,7\n")), HasSubstr("9 cells"));
}

TEST(DecodeVicon, IsNotMistaken) {
  for (const char* text : {"Frame,Time,X\n1,0,2\n", "Trajectories\n100\n", "a Sub Frame\n", ""})
    EXPECT_FALSE(looks_like_vicon(text)) << text;
}

// ---- Motive ----

const std::string kMotive =
    "Format Version,1.23,Take Name,reach,Capture Frame Rate,240,Export Frame Rate,120.000000,Total Exported Frames,3,"
    "Rotation Type,XYZ,Length Units,Millimeters,Coordinate Space,Global\n\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker,Marker,Marker\n"
    ",Name,RB,RB,RB,RB,\"RB:M,1\",\"RB:M,1\",\"RB:M,1\"\n,ID,1,1,1,1,2,2,2\n"
    ",,Rotation,Position,Position,Mean Marker Error,Position,Position,Position\n"
    "Frame,Time (Seconds),X,X,Y,,X,Y,Z\n"
    "0,0.000000,90,1,2,0.1,4,5,6\n1,0.008333,90,2,2,0.1,,,\n2,0.016667,90,3,2,0.1,4,5,6\n";

TEST(DecodeMotive, ReadsPositionsRotationsAndTime) {
  ASSERT_TRUE(looks_like_motive(kMotive));
  const Contents contents = good(decode_motive, kMotive);
  EXPECT_THAT(names_of(contents), ElementsAre("Time (Seconds)", "RB.rotation.x", "RB.x", "RB.y", "RB.Mean Marker Error",
                                              "RB:M,1.x", "RB:M,1.y", "RB:M,1.z"));
  EXPECT_EQ(contents.arrays[0].unit, "s");
  EXPECT_EQ(contents.arrays[1].unit, "deg");
  EXPECT_EQ(contents.arrays[2].unit, "Millimeters");
  EXPECT_EQ(contents.arrays[2].rate_hz, 120.0);
  EXPECT_EQ(contents.arrays[2].values, Vector::LinSpaced(3, 1, 3));
  EXPECT_TRUE(std::isnan(contents.arrays[5].values(1, 0)));
  EXPECT_THAT(contents.notes, IsEmpty());
}

TEST(DecodeMotive, ReadsItsVariants) {
  std::string quaternion = replaced(kMotive, "Rotation Type,XYZ", "Rotation Type,Quaternion");
  EXPECT_EQ(good(decode_motive, quaternion).arrays[1].unit, "");
  const std::string bare =  // without words in front, and without kinds
      "Format Version,1.25,Length Units,Meters\n\n,,Marker,Marker,Marker\n,,M1,M1,M1\n,,a,a,a\nFrame,Time "
      "(Seconds),X,Y,Z\n0,0,1,2,3\n";
  const Contents contents = good(decode_motive, replaced(bare, ",,a,a,a", ",ID,a,a,a"));
  EXPECT_THAT(names_of(contents), ElementsAre("Time (Seconds)", "M1.x", "M1.y", "M1.z"));
  const Contents unsaid =
      good(decode_motive, replaced(replaced(bare, ",,a,a,a", ",ID,a,a,a"), ",Length Units,Meters", ""));
  EXPECT_THAT(unsaid.notes, ElementsAre(HasSubstr("unit")));
  EXPECT_THAT(good(decode_motive, replaced(kMotive, "Total Exported Frames,3", "Total Exported Frames,9")).notes,
              ElementsAre(AllOf(HasSubstr("9 frames"), HasSubstr(" 3"))));
}

TEST(DecodeMotive, RefusesWhatDoesNotFit) {
  EXPECT_THAT(error_of(decode_motive, "Format Version,1.23\n\n,,X\n0,0,1\n"), HasSubstr("axes"));
  EXPECT_THAT(error_of(decode_motive, "Format Version,1.23\nFrame,Time (Seconds),X\n0,0,1\n"), HasSubstr("name"));
  EXPECT_THAT(error_of(decode_motive, replaced(kMotive, "4,5,6\n", "4,5,6,7\n")), HasSubstr("10 cells"));
  EXPECT_THAT(error_of(decode_motive, replaced(kMotive, "0.008333", "x")),
              AllOf(HasSubstr("line 9"), HasSubstr("column 2"), HasSubstr("'x'")));
}

// ---- Qualisys ----

const std::string kQualisys =
    "NO_OF_FRAMES\t3\nNO_OF_CAMERAS\t8\nNO_OF_MARKERS\t2\nFREQUENCY\t100\nNO_OF_ANALOG\t0\nDESCRIPTION\t--\n"
    "TIME_STAMP\t2024-04-15, 10:39:38.777\t406646.6\nDATA_INCLUDED\t3D\nMARKER_NAMES\thand\telbow\n";

TEST(DecodeQualisys, ReadsMarkersWithAndWithoutFrameAndTime) {
  const std::string bare = kQualisys +
                           "TRAJECTORY_TYPES\tMeasured\tMeasured\n1\t2\t3\t4\t5\t6\n2\t2\t3\t0.000\t0.000\t0."
                           "000\n3\t2\t3\tNULL\tNULL\tNULL\n";
  ASSERT_TRUE(looks_like_qualisys(bare));
  const Contents contents = good(decode_qualisys, bare);
  EXPECT_THAT(names_of(contents), ElementsAre("hand.x", "hand.y", "hand.z", "elbow.x", "elbow.y", "elbow.z"));
  EXPECT_EQ(contents.arrays[0].values, Vector::LinSpaced(3, 1, 3));
  EXPECT_EQ(contents.arrays[0].unit, "mm");
  EXPECT_EQ(contents.arrays[0].rate_hz, 100.0);
  EXPECT_TRUE(std::isnan(contents.arrays[3].values(1, 0)) && std::isnan(contents.arrays[5].values(2, 0)));
  EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("QTM"), HasSubstr("0, 0, 0")));
  for (const char* head : {"Frame\tTime\thand X\thand Y\thand Z\telbow X\telbow Y\telbow Z\n", ""}) {
    const Contents timed = good(
        decode_qualisys,
        kQualisys + head + "1\t0.00000\t1\t2\t3\t4\t5\t6\n2\t0.01000\t2\t2\t3\t4\t5\t6\n3\t0.02\t3\t2\t3\t4\t5\t6\n");
    EXPECT_EQ(timed.arrays[0].name, "Time");
    EXPECT_EQ(timed.arrays[0].values(2, 0), 0.02);
    EXPECT_EQ(timed.arrays[1].values, Vector::LinSpaced(3, 1, 3));
  }
}

TEST(DecodeQualisys, RefusesWhatItCannotRead) {
  const std::string bodies = "NO_OF_FRAMES\t1\nFREQUENCY\t100\nDATA_INCLUDED\t6D\nBODY_NAMES\tarm\n1\t2\t3\n";
  ASSERT_TRUE(looks_like_qualisys(bodies));
  EXPECT_THAT(error_of(decode_qualisys, bodies), AllOf(HasSubstr("6D"), HasSubstr("C3D")));
  EXPECT_THAT(error_of(decode_qualisys, kQualisys + "1\t2\t3\t4\t5\t6\t7\t8\t9\n"), HasSubstr("3 numbers"));
  EXPECT_THAT(error_of(decode_qualisys, kQualisys), HasSubstr("frame"));
  EXPECT_THAT(error_of(decode_qualisys, kQualisys + "1\t2\tx\t4\t5\t6\n"),
              AllOf(HasSubstr("line 10"), HasSubstr("column 3"), HasSubstr("'x'")));
  EXPECT_FALSE(looks_like_qualisys("NO_OF_FRAMES\t3\nDATA_TYPES\tv\n"));
}

// ---- Delsys ----

TEST(DecodeDelsys, GivesSignalsTheirOwnClocks) {
  const std::string text =
      "\"X [s]\",\"Sensor 1: EMG 1 [V]\",\"X [s]\",\"Sensor 1: ACC.X 1 [g]\",X[s],\"Sensor 2: EMG 2 [V]\"\n"
      "0,1,0,9,0,2\n0.001,2,0.01,8,0.001,3\n0.002,3,,,0.002,4\n";
  ASSERT_TRUE(looks_like_delsys(text));
  const Contents contents = good(decode_delsys, text);
  EXPECT_THAT(names_of(contents), ElementsAre("Sensor 1: EMG 1", "Sensor 1: ACC.X 1", "Sensor 2: EMG 2"));
  ASSERT_THAT(contents.clocks, SizeIs(2));
  EXPECT_EQ(contents.clocks[0].name, "Sensor 1: EMG 1");
  EXPECT_EQ(contents.clocks[1].time, (Vector(2) << 0, 0.01).finished());
  EXPECT_EQ(contents.arrays[1].values, (Vector(2) << 9, 8).finished());
  EXPECT_EQ(contents.arrays[1].unit, "g");
  EXPECT_EQ(contents.arrays[1].clock, 1);
  EXPECT_EQ(contents.arrays[2].clock, 0);
}

TEST(DecodeDelsys, TakesOneTimeWhereAllAreAlike) {
  const std::string text =
      "Application: Trigno Discover\nDate/Time: 2024\nVL (81),,RF (82),\nsensor mode: 50,,sensor mode: 40,\n"
      "EMG 1 Time Series (s),EMG 1 (mV),EMG 1 Time Series (s),EMG 1 (mV)\n,1000 Hz,,1000 "
      "Hz\n0,1,0,2\n0.001,2,0.001,3\n";
  ASSERT_TRUE(looks_like_delsys(text));
  const Contents contents = good(decode_delsys, text);
  EXPECT_THAT(names_of(contents), ElementsAre("time", "VL (81): EMG 1", "RF (82): EMG 1"));
  EXPECT_THAT(contents.clocks, IsEmpty());
  EXPECT_EQ(contents.arrays[2].unit, "mV");
  EXPECT_THAT(contents.notes, ElementsAre(HasSubstr("5 lines")));
  EXPECT_FALSE(looks_like_delsys("time (s),EMG (mV)\n0,1\n"));
  EXPECT_FALSE(looks_like_delsys("X [s],X [s]\n0,1\n"));
}

TEST(DecodeDelsys, TakesUnitsFromTheLinesAbove) {
  const Contents contents =
      good(decode_delsys,
           "Label: Cell Sampling frequency: 1000.000000 Number of points: 2 start: 0.000000 Unit: mV Domain Unit: s\n"
           "X[s],Cell\n0,1\n0.001,2\n");
  EXPECT_THAT(names_of(contents), ElementsAre("time", "Cell"));
  EXPECT_EQ(contents.arrays[1].unit, "mV");
}

TEST(CaptureTables, CutAnywhereGiveAnErrorOrTheCompleteLines) {
  for (const auto& [decode, whole] : {std::pair<Decode, std::string>{decode_vicon, kTrajectories + "\n" + kDevices},
                                      {decode_motive, kMotive},
                                      {decode_qualisys, kQualisys + "1\t2\t3\t4\t5\t6\n2\t2\t3\t4\t5\t6\n"},
                                      {decode_delsys, "X[s],a,X[s],b\n0,1,0,2\n1,2,1,3\n"}}) {
    for (std::size_t n = 1; n < whole.size(); ++n) {
      const std::string text = whole.substr(0, n);
      const auto contents = decode(std::as_bytes(std::span(text)));
      if (!contents) {
        EXPECT_EQ(contents.error().line().find('\n'), std::string::npos);
        continue;
      }
      for (const Array& array : contents->arrays) EXPECT_LE(array.values.rows(), 6);
    }
  }
}

}  // namespace capture_tables_test
}  // namespace mbk::recording
