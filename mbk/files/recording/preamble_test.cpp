#include "mbk/files/recording/preamble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace preamble_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Preamble of(const std::vector<std::string_view>& lines) {
  std::vector<CsvLine> numbered;
  for (const std::string_view line : lines) numbered.push_back({numbered.size() + 1, line, true});
  return read_preamble(numbered);
}

std::vector<std::string> units_of(std::string_view line) {
  std::vector<std::string> names;
  for (const Unit* unit : of({line}).units) names.emplace_back(unit->name);
  return names;
}

TEST(Preamble, TakesARateHoweverItIsWritten) {
  for (const char* line : {"SampleRate=500",
                           "Sampling frequency: 500 Hz",
                           "Fs,500",
                           "Fs,500,,,,",
                           "# fs = 500",
                           "% Sample Rate (Hz): 500",
                           "// Update Rate: 500.0Hz",
                           "sampling_rate\t0.5 kHz",
                           "Sampling Rate [kHz];0.5",
                           "rate: 500 Hz",
                           "Rate:,500 Hz",
                           "sampled at 500 Hz",
                           "fs 500",
                           "Sample Rate,0.5,kHz",
                           "Sample Interval,2.0E-03,s",
                           "Sampling rate;500;Hz;;",
                           "\"SampleRate\",\"500\"",
                           "Take,3,Export Frame Rate,500.000,Units,none",
                           "dt = 0.002",
                           "dt = 2 ms",
                           "Sample interval (ms): 2",
                           "2 msec/sample",
                           "# 500 samples/second",
                           "Sampling time,0.002 s"}) {
    const Preamble found = of({"title", line});
    ASSERT_TRUE(found.rate_hz) << line;
    EXPECT_DOUBLE_EQ(*found.rate_hz, 500.0) << line;
    EXPECT_THAT(found.rate_from, HasSubstr("line 2")) << line;
    EXPECT_THAT(found.notes, Contains(AllOf(HasSubstr("line 2"), HasSubstr("500 Hz")))) << line;
  }
}

TEST(Preamble, NamesARateThatMayBeSomethingElse) {
  for (const char* line :
       {"Cutoff frequency: 50 Hz", "Frequency,2", "Sampling rate: 1,000 Hz", "Sample interval: 10", "rate: 10 mm",
        "Capture Frame Rate,120", "rate: fast", "SampleRate=-5", "Sampling rates: 100, 200", "Fs,1000,500",
        "Fs: 100, 200", "Fs=1000; rate=50", "Sample Rate,1,rpm", "SampleRate=1e400", "rate: 5 (nominal)"}) {
    const Preamble found = of({line});
    EXPECT_FALSE(found.rate_hz) << line;
    EXPECT_THAT(found.notes, ElementsAre(AllOf(HasSubstr("line 1"), HasSubstr("'" + std::string(line) + "'"))));
  }
}

TEST(Preamble, TakesNoRateWhereTwoLinesDiffer) {
  const Preamble found = of({"Fs=1000", "SampleRate=500"});
  EXPECT_FALSE(found.rate_hz);
  EXPECT_THAT(found.notes, ElementsAre(AllOf(HasSubstr("line 1"), HasSubstr("'Fs=1000'")),
                                       AllOf(HasSubstr("line 2"), HasSubstr("'SampleRate=500'"))));
  EXPECT_EQ(of({"Fs=1000", "SampleRate=1 kHz"}).rate_hz, 1000.0);
}

TEST(Preamble, TakesUnitsOfEachDimension) {
  EXPECT_THAT(units_of("Units: mm"), ElementsAre("mm"));
  EXPECT_THAT(units_of("Length Units,Millimeters,Rotation Type,XYZ"), ElementsAre("mm"));
  EXPECT_THAT(units_of("units = mm, N, ms"), ElementsAre("mm", "N", "ms"));
  EXPECT_THAT(units_of("Units;mm;N"), ElementsAre("mm", "N"));
  EXPECT_THAT(units_of("Position unit: cm; Force unit: lbf"), ElementsAre("cm", "lbf"));
  EXPECT_THAT(units_of("Angles are in degrees."), ElementsAre("deg"));
  EXPECT_THAT(units_of("# time in ms, all positions in mm"), ElementsAre("ms", "mm"));
  EXPECT_THAT(units_of("inDegrees=yes,,"), ElementsAre("deg"));
  EXPECT_THAT(units_of("inDegrees;yes;"), ElementsAre("deg"));
  EXPECT_THAT(units_of("inDegrees=no"), IsEmpty());
  EXPECT_THAT(of({"Units: mm"}).notes,
              ElementsAre(AllOf(HasSubstr("line 1"), HasSubstr("'Units: mm'"), HasSubstr("length"))));
}

TEST(Preamble, NamesAUnitThatMayBeOfSomethingElse) {
  for (const char* line : {"Distance to the target in cm", "Units: counts per mm", "Force scale: 2 N", "threshold 5 mm",
                           "Angles: mm", "Position: in inches", "gain=4.45", "Conversion (deg)"}) {
    const Preamble found = of({line});
    EXPECT_THAT(found.units, IsEmpty()) << line;
    EXPECT_THAT(found.notes, ElementsAre(HasSubstr("'" + std::string(line) + "'"))) << line;
  }
  EXPECT_THAT(of({"inDegrees=yes", "Units: rad"}).units, IsEmpty());
  EXPECT_THAT(of({"inDegrees=yes", "Units: rad"}).notes, testing::SizeIs(2));
}

TEST(Preamble, NamesDates) {
  for (const char* line :
       {"Recorded on 2024-03-01 10:15", "Date;01.03.2024", "3/1/24", "Created: March 1", "Start time: 9"}) {
    EXPECT_THAT(of({line}).notes, ElementsAre(HasSubstr("'" + std::string(line) + "'"))) << line;
  }
}

TEST(Preamble, IsSilentOfOtherText) {
  for (const char* line : {"Recorder 7", "made by hand, on a Monday", "Version,1.2.3", "subject: 12",
                           "second trial of 3", "www.example.org/a/b", "", ",,,", "Operator: Ms N. Mm"}) {
    EXPECT_THAT(of({line}).notes, IsEmpty()) << line;
  }
}

TEST(Preamble, IsBoundedForEndlessLines) {
  const std::string long_line = std::string(5'000'000, '=') + "Fs=1000";
  EXPECT_FALSE(of({long_line}).rate_hz);
  EXPECT_THAT(of(std::vector<std::string_view>(5000, "gain=2")).notes, testing::SizeIs(1 + 12));
}

// ---- what becomes of it ----

const std::string kRows = "0.000,20,1,1\n0.001,21,2,2\n0.002,22,1,3\n0.003,20,2,4\n";

Result<Recording> read_table(const std::string& text, const char* map = nullptr, int axes = 0) {
  const test::Folder folder;
  ReadOptions options;
  if (map != nullptr) options.channels = parse_channel_map(map).value();
  options.axes = axes;
  return read(folder.write("table.csv", text), options);
}

TEST(PreambleOfATable, GivesTheRateWhereThereIsNoTime) {
  const auto recording = read_table("Fs,500\nhand_x,hand_y,force_x\n1,2,3\n2,3,4\n3,4,5\n");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time, Vector(Vector::LinSpaced(3, 0.0, 0.004)));
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("line 1"), HasSubstr("'Fs,500'"), HasSubstr("500 Hz"))));
}

TEST(PreambleOfATable, IsNoHeaderWhereThereIsNone) {
  for (const char* text : {"Fs,500\n1,2\n2,3\n3,4\n", "Fs,500,,\n1,2,3,4\n2,3,4,5\n3,4,5,6\n",
                           "Fs=500\n1,2\n2,3\n3,4\n", "Sampling frequency: 500 Hz\n1 2 3 4\n2 3 4 5\n3 4 5 6\n"}) {
    const auto recording = read_table(text, "x=1,F=2", 1);
    ASSERT_TRUE(recording) << text << recording.error().line();
    EXPECT_EQ(recording->time, Vector(Vector::LinSpaced(3, 0.0, 0.004))) << text;
  }
}

TEST(PreambleOfATable, RefusesARateThatItsTimeContradicts) {
  const auto recording = read_table("SampleRate=500\ntime,hand_x,hand_y,force_x\n" + kRows);
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().line(), AllOf(HasSubstr("500 Hz"), HasSubstr("line 1"), HasSubstr("'SampleRate=500'"),
                                              HasSubstr("'time'"), HasSubstr("1000 Hz")));
  EXPECT_THAT(recording.error().remedy, HasSubstr("--channels time=time:s"));
  // A rate may be a nominal one.
  const auto nominal = read_table("SampleRate=1050\ntime,hand_x,hand_y,force_x\n" + kRows);
  ASSERT_TRUE(nominal) << nominal.error().line();
  EXPECT_THAT(nominal->notes, Contains(AllOf(HasSubstr("1050 Hz"), HasSubstr("line 1"), HasSubstr("'SampleRate=1050'"),
                                             HasSubstr("'time'"), HasSubstr("1000 Hz"))));
  EXPECT_TRUE(read_table("SampleRate=1000\ntime,hand_x,hand_y,force_x\n" + kRows));
}

TEST(PreambleOfATable, GivesUnitsToTheColumnsThatCanHaveThem) {
  const auto recording = read_table("Units: mm\ntime,hand_x,hand_y_m,force_x\n" + kRows);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values[0], 0.020);
  EXPECT_EQ(recording->find("hand_y")->values[0], 1.0);
  EXPECT_EQ(recording->find("force_x")->values[0], 1.0);
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("hand_x"), HasSubstr("mm"))));
  const auto mapped = read_table("# force in lbf, time in ms\nt,a,b,c\n" + kRows, "time=1,x=2,Fx=4");
  ASSERT_TRUE(mapped) << mapped.error().line();
  EXPECT_EQ(mapped->find("force_x")->values[0], 4.4482216152605);
  EXPECT_DOUBLE_EQ(mapped->time[1], 1e-6);
}

TEST(PreambleOfATable, ReadsAMotionThatASpreadsheetSaved) {
  for (const char separator : {',', ';', '\t'}) {
    std::string text =
        "Coordinates,,\nversion=1,,\nnRows=3,,\nnColumns=3,,\ninDegrees=yes,,\nendheader,,\ntime,q1,tau1\n0,-90,1\n"
        "0.01,-45,2\n0.02,-60,3\n";
    std::ranges::replace(text, ',', separator);
    const auto recording = read_table(text);
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_DOUBLE_EQ(recording->find("joint_1")->values[0], -1.5707963267948966);
    EXPECT_EQ(recording->find("torque_1")->values[0], 1.0);
    EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("joint_1"), HasSubstr("deg"))));
  }
}

TEST(PreambleOfATable, AsksWhetherTheOneAxisIsMeant) {
  const auto recording = read_table("Angles in degrees\ntime,position,reaction,n\n" + kRows);
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().line(), AllOf(HasSubstr("deg"), HasSubstr("'position'")));
  EXPECT_TRUE(read_table("Angles in degrees\ntime,position,reaction,n\n" + kRows, "x=position:deg,F=reaction", 1));
}

TEST(PreambleOfATable, NamesWhatStandsAmongItsRows) {
  const auto recording =
      read_table("time,hand_x,hand_y,force_x\n" + kRows + "# units: mm\n# touched\n0.004,20,1,1\n# Fs=500\n");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values[0], 20);
  EXPECT_THAT(recording->notes, ElementsAre(AllOf(HasSubstr("line 6"), HasSubstr("'# units: mm'")),
                                            AllOf(HasSubstr("line 9"), HasSubstr("'# Fs=500'"))));
}

TEST(PreambleOfATable, LeavesTheCommentsOfOurOwnFilesAlone) {
  const auto recording =
      read_table("# mbk.recording/1\n# sampling_rate: 500\n# units: mm\ntime_s,hand_x_m,hand_y_m,force_x_N\n" + kRows);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_THAT(recording->notes, IsEmpty());
  EXPECT_EQ(recording->metadata.at("units"), "mm");
}

}  // namespace preamble_test
}  // namespace mbk::recording
