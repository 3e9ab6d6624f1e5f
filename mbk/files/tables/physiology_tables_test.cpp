#include "mbk/files/tables/physiology_tables.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mbk::recording {
namespace physiology_tables_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

template <class Decoded>
auto good(Decoded (*decode)(std::span<const std::byte>), std::string_view text) {
  auto found = decode(std::as_bytes(std::span(text)));
  EXPECT_TRUE(found) << found.error().line();
  return found ? std::move(*found) : typename Decoded::value_type();
}

template <class Decoded>
std::string error_of(Decoded (*decode)(std::span<const std::byte>), std::string_view text) {
  const auto found = decode(std::as_bytes(std::span(text)));
  return found ? "none" : found.error().line();
}

/// "Force N 1 2 3": name, unit and numbers of an array.
std::string shown(const Array& array) {
  std::string text = array.name + " " + array.unit;
  for (Index k = 0; k < array.values.size(); ++k) text += fmt::format(" {:g}", array.values(k, 0));
  return text;
}

std::vector<std::string> shown(const Contents& contents) {
  std::vector<std::string> all;
  for (const Array& array : contents.arrays) all.push_back(shown(array));
  return all;
}

// ---- AcqKnowledge ----

constexpr std::string_view kAcq = "arm.acq\n2 msec/sample\n2 channels\nPosition\nmm\nForce\nN\n";

TEST(DecodeAcqKnowledge, TakesRateNamesAndUnitsOfItsHeader) {
  for (const char* table :
       {"CH1,CH2,\n3,3,\n1.5,2,\n3,4,\n5,6,\n", "CH1\tCH2\t\r\n3\t3\t\r\n1,5\t2\t\r\n3\t4\t\r\n5\t6\t\r\n",
        "1.5,2\n3,4\n5,6\n", "min\tCH1\tCH2\t\n\t3\t3\t\n0\t1.5\t2\t\n0.00003\t3\t4\t\n0.00007\t5\t6\t\n"}) {
    const std::string text = std::string(kAcq) + table;
    ASSERT_TRUE(looks_like_acqknowledge(text));
    const Contents contents = good(decode_acqknowledge, text);
    EXPECT_THAT(shown(contents), ElementsAre("Position mm 1.5 3 5", "Force N 2 4 6")) << table;
    EXPECT_DOUBLE_EQ(contents.rate_hz, 500.0);
    EXPECT_EQ(contents.rate_from, "line 2, '2 msec/sample'");
  }
}

TEST(DecodeAcqKnowledge, KeepsATimeThatDisagreesWithItsRate) {
  const Contents contents = good(decode_acqknowledge, std::string(kAcq) + "sec,CH1,CH2\n,2,2\n0,1,2\n0.5,3,4\n");
  EXPECT_THAT(shown(contents), ElementsAre("Position mm 1 3", "Force N 2 4", "time s 0 0.5"));
}

TEST(DecodeAcqKnowledge, LeavesSlowerChannelsAside) {
  const Contents contents =
      good(decode_acqknowledge, std::string(kAcq) + "sec\tCH1\tCH2\n\t1\t2\n0\t1\t2\n0.002\t\t4\n");
  ASSERT_THAT(contents.arrays, SizeIs(2));
  ASSERT_TRUE(contents.arrays[0].obstacle);
  EXPECT_THAT(contents.arrays[0].obstacle->line(), HasSubstr("1 sample"));
  EXPECT_EQ(shown(contents.arrays[1]), "Force N 2 4");
}

TEST(DecodeAcqKnowledge, RefusesWhatIsIncomplete) {
  EXPECT_THAT(error_of(decode_acqknowledge, "a.acq\n1 msec/sample\n9 channels\nA\nN\n1\n2\n"), HasSubstr("header"));
  EXPECT_THAT(error_of(decode_acqknowledge, kAcq), HasSubstr("sample"));
  EXPECT_THAT(error_of(decode_acqknowledge, std::string(kAcq) + "CH1,CH2\n3,3\n1,x\n"), HasSubstr("line 10"));
  EXPECT_THAT(error_of(decode_acqknowledge, std::string(kAcq) + "what,CH1,CH2\n1,1,1\n1,2,3\n"), HasSubstr("'what'"));
  EXPECT_FALSE(looks_like_acqknowledge("a\n1 msec\n2 channels\n"));
  EXPECT_FALSE(looks_like_acqknowledge("a\n-1 msec/sample\n2 channels\n"));
}

// ---- LabChart ----

const std::string kBlock =
    "Interval=\t0.002 s\nExcelDateTime=\t4.5e4\t01/03/2024 10:00:00\nTimeFormat=\tStartOfBlock\nDateFormat=\t\n"
    "ChannelTitle=\tPosition\tForce\nRange=\t10.0 mm\t20 V\nUnitName=\t*\tN\n";

TEST(DecodeLabChart, TakesRateTitlesAndUnitsOfItsHeader) {
  const std::string text = kBlock + "0\t1.5\t2\n0.002\t3\t4\t#* go, now\n";
  ASSERT_TRUE(looks_like_labchart(text));
  const auto records = good(decode_labchart, text);
  ASSERT_THAT(records, SizeIs(1));
  const Contents& contents = records[0].contents;
  EXPECT_THAT(shown(contents), ElementsAre("time s 0 0.002", "Position mm 1.5 3", "Force N 2 4"));
  EXPECT_DOUBLE_EQ(contents.rate_hz, 500.0);
  ASSERT_THAT(contents.events, SizeIs(1));
  EXPECT_DOUBLE_EQ(contents.events[0].time, 0.002);
  EXPECT_EQ(contents.metadata.at("recorded"), "01/03/2024 10:00:00");
}

TEST(DecodeLabChart, NeedsNoColumnOfTime) {
  for (const char* text : {"Interval=\t2 ms\nChannelTitle=\tPosition\tForce\nUnitName=\tmm\tN\n1\t2\n3\t4\n",
                           "Interval=,0.002 s\nChannelTitle=,Position,Force\nUnitName=,mm,N\n1,2\n3,4\n",
                           "Interval=\t0,002 s\nChannelTitle=\tPosition\tForce\nUnitName=\tmm\tN\n"
                           "10:00:00,000\t1\t2\n10:00:00,002\t3\t4\n"}) {
    const auto records = good(decode_labchart, text);
    ASSERT_THAT(records, SizeIs(1)) << text;
    EXPECT_THAT(shown(records[0].contents), ElementsAre("Position mm 1 3", "Force N 2 4")) << text;
    EXPECT_DOUBLE_EQ(records[0].contents.rate_hz, 500.0);
  }
}

TEST(DecodeLabChart, GivesEachBlockAsARecording) {
  const auto records = good(decode_labchart, kBlock + "0\t1\t2\n" + kBlock + "0\t3\t4\n0.002\t5\t6\n");
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_THAT(shown(records[1].contents), ElementsAre("time s 0 0.002", "Position mm 3 5", "Force N 4 6"));
  EXPECT_THAT(records[1].contents.notes, Contains(HasSubstr("2 of 2")));
}

TEST(DecodeLabChart, RefusesWhatIsContradictory) {
  EXPECT_THAT(error_of(decode_labchart, "Interval=\tunknown\nChannelTitle=\tA\n1\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of(decode_labchart, "Interval=\t1 ms\t2 ms\nChannelTitle=\tA\tB\n1\t2\n"), HasSubstr("line 1"));
  EXPECT_THAT(error_of(decode_labchart, kBlock + "1\n"), HasSubstr("line 8"));
  EXPECT_THAT(error_of(decode_labchart, kBlock + "0\t1\t2\n1\t2\n"), HasSubstr("line 9"));
  EXPECT_THAT(error_of(decode_labchart, kBlock), HasSubstr("sample"));
}

// ---- Spike2 ----

std::string spike2_channel(const char* number, const char* name, const char* unit, const char* rows) {
  return std::string("\"CHANNEL\"\t\"") + number + "\"\n\"Waveform\"\n\"No comment\"\n\"" + name + "\"\n\"" + unit +
         "\"\t500\n" + rows + "\n";
}

const std::string kSpike2 =
    "\"INFORMATION\"\n\"arm.smr\"\n\n\"SUMMARY\"\n\"1\"\t\"Waveform\"\t\"Position\"\t\"mm\"\t500\n\n";

TEST(DecodeSpike2, TakesTimesOfEachChannel) {
  const std::string text = kSpike2 + spike2_channel("1", "Position", "mm", "\"START\"\t1.00\t0.002 s\n1\n3\n") +
                           spike2_channel("2", "Force", " N", "\"START\"\t1.00\t0.002\n2\n4\n") +
                           "\"CHANNEL\"\t\"3\"\n\"Evt+\"\n\"\"\n\"Trigger\"\n\"\"\n0.5\n0.7\n";
  ASSERT_TRUE(looks_like_spike2(text));
  const Contents contents = good(decode_spike2, text);
  EXPECT_THAT(shown(contents), ElementsAre("time s 1 1.002", "Position mm 1 3", "Force N 2 4", "Trigger "));
  EXPECT_TRUE(contents.arrays[3].obstacle);
}

TEST(DecodeSpike2, GivesChannelsOfOtherRatesTheirOwnClocks) {
  const Contents contents =
      good(decode_spike2, kSpike2 + spike2_channel("1", "Position", "mm", "\"START\"\t0\t0.01\n1\n3\n") +
                              spike2_channel("2", "Force", "N", "\"START\"\t0\t0.002\n2\n4\n\"START\"\t1\t0.002\n6\n"));
  EXPECT_THAT(shown(contents), ElementsAre("Position mm 1 3", "Force N 2 4 6"));
  ASSERT_THAT(contents.clocks, SizeIs(2));
  EXPECT_EQ(contents.clocks[1].name, "Force");
  EXPECT_THAT(contents.clocks[1].time, ElementsAre(0.0, 0.002, 1.0));
}

TEST(DecodeSpike2, RefusesWhatIsNoWaveform) {
  EXPECT_THAT(error_of(decode_spike2, kSpike2 + spike2_channel("1", "A", "N", "\"START\"\t0\n1\n")),
              HasSubstr("line 12"));
  EXPECT_THAT(error_of(decode_spike2, kSpike2 + spike2_channel("1", "A", "N", "\"START\"\t0\t0.1\n1\t2\n")),
              HasSubstr("line 13"));
  EXPECT_THAT(error_of(decode_spike2, kSpike2 + spike2_channel("1", "A", "N", "1\n")), HasSubstr("CHANNEL"));
}

}  // namespace physiology_tables_test
}  // namespace mbk::recording
