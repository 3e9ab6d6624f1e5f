#include "mbk/files/xdf/xdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>

#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/xdf/test_xdf.h"
#include "mbk/files/xdf/xdf_chunks.h"
#include "mbk/files/xdf/xdf_clocks.h"

namespace mbk::recording {
namespace xdf_test {

using test::raw;
using test::Xdf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Result<Contents> decoded(const std::string& bytes) {
  return decode_xdf(std::as_bytes(std::span(bytes)));
}
Contents contents_of(const Xdf& file) {
  auto contents = decoded(file.bytes());
  EXPECT_TRUE(contents) << contents.error().line();
  return contents ? std::move(*contents) : Contents();
}

const Array& array(const Contents& contents, std::string_view name) {
  const auto found = std::ranges::find(contents.arrays, name, &Array::name);
  EXPECT_NE(found, contents.arrays.end()) << name;
  return found == contents.arrays.end() ? contents.arrays.front() : *found;
}

Vector values(const Contents& contents, std::string_view name) {
  return array(contents, name).values.reshaped();
}

// ---- recordings ----

TEST(XdfRecordings, MinimalHasItsPublishedNumbers) {
  MBK_DATA_OR_SKIP(data);
  const auto bytes = read_file(data / "xdf/minimal.xdf");
  ASSERT_TRUE(bytes);
  const auto contents = decode_xdf(bytes->bytes());
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->clocks.size(), 1u);
  EXPECT_EQ(contents->clocks[0].name, "SendDataC");
  ASSERT_EQ(contents->arrays.size(), 4u);
  double sum = 0.0;
  const double first[] = {192, 255, 238};
  for (std::size_t c = 0; c < 3; ++c) {
    const Vector column = contents->arrays[c].values.reshaped();
    ASSERT_EQ(column.size(), 9);
    EXPECT_EQ(column[0], first[c]);
    sum += column.sum();
  }
  EXPECT_EQ(sum, 1249.0);
  const Vector& time = contents->clocks[0].time;
  EXPECT_NEAR(time[0], 5.0, 1e-12);
  EXPECT_NEAR(time[8], 5.8, 1e-12);
  const Vector raw_time = values(*contents, "SendDataC.raw_time");
  EXPECT_EQ(raw_time[0], 5.1);
  EXPECT_TRUE(std::isnan(raw_time[8]));  // the file leaves it out
  EXPECT_EQ(contents->events.size(), 9u);
}

/// [s] The published stamps carry the rounding of normal equations in offsets divided by 10⁻⁴ s, which are 6.5·10⁹
/// here; the line that is fitted here is where the loss is stationary (below).
constexpr double kPublished = 1e-8;

/// Derivatives of Huber's loss by level and slope, in units of the threshold.
std::pair<double, double> pulls(const RobustLine& line, const Vector& time, const Vector& values) {
  double level = 0.0, tilt = 0.0;
  for (Index k = 0; k < time.size(); ++k) {
    const double t = time[k] - line.at;
    const double pull = std::clamp((values[k] - line.offset - line.slope * t) / 1e-4, -1.0, 1.0);
    level += pull;
    tilt += pull * t;
  }
  return {level, tilt};
}

TEST(XdfRecordings, ClockResetsHaveTheirPublishedNumbers) {
  MBK_DATA_OR_SKIP(data);
  const auto bytes = read_file(data / "xdf/clock_resets.xdf");
  ASSERT_TRUE(bytes);
  const auto file = parse_xdf(bytes->bytes());
  ASSERT_TRUE(file) << file.error().line();
  ASSERT_EQ(file->streams.size(), 2u);
  const XdfStream &markers = file->streams[0], &samples = file->streams[1];
  ASSERT_EQ(samples.stamps.size(), 27815);
  double sum = 0.0;
  for (const Vector& column : samples.values) sum += column.sum();
  EXPECT_NEAR(sum, 111465.4018197608, 1e-7);

  const Synchronised clock = synchronise(samples.stamps, samples.offsets, samples.total);
  ASSERT_EQ(clock.segments.size(), 2u);
  EXPECT_EQ(clock.segments[0].last, 12875);
  EXPECT_EQ(clock.segments[1].first, 12876);
  EXPECT_EQ(clock.segments[1].last, 27814);
  EXPECT_NEAR(clock.time[0], 810.0948474524776, kPublished);
  EXPECT_NEAR(clock.time[27814], 1383.0923258825396, kPublished);
  const Dejittered even = dejitter(clock.time, samples.nominal_hz, clock.breaks());
  ASSERT_EQ(even.segments.size(), 2u);
  EXPECT_EQ(even.segments[0].last, 12875);
  EXPECT_NEAR(even.time[0], 810.0297917640847, kPublished);
  EXPECT_NEAR(even.time[27814], 1383.1842659544184, kPublished);
  EXPECT_NEAR(even.effective_hz, 92.93436959140696, kPublished);

  const Synchronised marked = synchronise(markers.stamps, markers.offsets, markers.total);
  ASSERT_EQ(marked.segments.size(), 2u);
  EXPECT_EQ(marked.segments[0].last, 90);
  EXPECT_EQ(marked.segments[1].last, 174);
  EXPECT_NEAR(marked.time[0], 812.9279041877016, kPublished);
  EXPECT_NEAR(marked.time[174], 1380.8194507223984, kPublished);

  Vector times(82), offsets(82);  // before the reset
  for (Index k = 0; k < 82; ++k) {
    times[k] = samples.offsets[static_cast<std::size_t>(k)].time;
    offsets[k] = samples.offsets[static_cast<std::size_t>(k)].value;
  }
  const auto [level, tilt] = pulls(huber_line(times, offsets, 1e-4), times, offsets);
  EXPECT_NEAR(level, 0.0, 1e-4);
  EXPECT_NEAR(tilt, 0.0, 1e-2);

  const auto contents = decode_xdf(bytes->bytes());
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->clocks.size(), 1u);
  EXPECT_EQ(contents->events.size(), 175u);
  EXPECT_NEAR(contents->events.front().time, 812.9279041877016, kPublished);
  EXPECT_THAT(contents->notes, Contains(HasSubstr("reset")));
  EXPECT_THAT(contents->notes, Contains(HasSubstr("a break of")));
}

// ---- chunks ----

TEST(DecodeXdf, ReadsEveryFormat) {
  for (const std::string_view format : {"int8", "int16", "int32", "int64", "float32", "double64"}) {
    const Contents contents = contents_of(test::small_xdf(format));
    EXPECT_EQ(values(contents, "Robot.x"), Vector::LinSpaced(10, 0, 9)) << format;
    EXPECT_EQ(values(contents, "Robot.Fx"), Vector::LinSpaced(10, 0, -18)) << format;
    EXPECT_EQ(array(contents, "Robot.x").unit, "mm");
    ASSERT_EQ(contents.clocks.size(), 1u);
    EXPECT_LT((contents.clocks[0].time - Vector::LinSpaced(10, 4.0, 4.09)).cwiseAbs().maxCoeff(), 1e-9);
    ASSERT_EQ(contents.events.size(), 2u);
    EXPECT_EQ(contents.events[0].name, "onset");
    EXPECT_NEAR(contents.events[0].time, 4.02, 1e-12);
    EXPECT_EQ(contents.events[1].value, 42.0);
    EXPECT_THAT(contents.notes, Contains(HasSubstr("2 of 10 samples")));
  }
}

TEST(DecodeXdf, GivesNamelessAndRepeatedNamesOfTheirOwn) {
  Xdf file;
  file.header().stream(1, "S", "int8", 3, 0, Xdf::labels({{"F", "newtons"}, {"F", ""}}));
  file.stream(2, "S", "int8", 1, 0).stream(3, "", "int8", 1, 0, Xdf::labels({{"a,b", ""}}));
  file.samples(1, {Xdf::stamped(1) + "abc"}).samples(2, {Xdf::stamped(1) + "a"}).samples(3, {Xdf::stamped(1) + "a"});
  const Contents contents = contents_of(file);
  std::vector<std::string> names;
  for (const Array& one : contents.arrays) names.push_back(one.name);
  EXPECT_THAT(names, testing::ElementsAre("S.F", "S.F#2", "S.channel_3", "S.raw_time", "S#2.channel_1", "S#2.raw_time",
                                          "stream_3.a;b", "stream_3.raw_time"));
  EXPECT_EQ(contents.arrays[0].unit, "N");
  EXPECT_EQ(contents.clocks[2].name, "stream_3");
}

TEST(DecodeXdf, NamesManyStreamsOfOneName) {
  Xdf file;
  for (std::uint32_t id = 1; id <= 30'000; ++id) file.stream(id, "S", "int8", 1, 0);
  file.samples(30'000, {Xdf::stamped(1) + "a"});
  EXPECT_EQ(contents_of(file).clocks[0].name, "S#30000");
}

TEST(DecodeXdf, SaysByHowMuchWholeNumbersWereRounded) {
  constexpr std::int64_t kLarge = (std::int64_t{1} << 60) + 100;  // numbers there are 256 apart
  Xdf file;
  file.header().stream(1, "S", "int64", 4, 0, Xdf::labels({{"count", ""}, {"stamp", "ns"}, {"even", ""}, {"low", ""}}));
  file.samples(1, {Xdf::stamped(1) + raw(kLarge) + raw(-kLarge) + raw(kLarge - 100) + raw(std::int64_t{1} << 53)});
  const Contents contents = contents_of(file);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("'S.count'"), HasSubstr("2^53"), HasSubstr("100"))));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("'S.stamp'"), HasSubstr("100"), HasSubstr("0.1 µs"))));
  EXPECT_THAT(contents.notes, Not(Contains(HasSubstr("S.even"))));
  EXPECT_THAT(contents.notes, Not(Contains(HasSubstr("S.low"))));
}

TEST(DecodeXdf, ReadsOnFromTheNextBoundaryBehindDamage) {
  Xdf file;
  file.header().stream(1, "S", "int8", 1, 0).samples(1, {Xdf::stamped(1) + "a"});
  const std::size_t damage = file.bytes().size();
  file.append("\x04\xFF\xFF\xFF\x7F").samples(1, {Xdf::stamped(2) + "b"}).boundary();
  const std::size_t resumed = file.bytes().size();
  file.samples(1, {Xdf::stamped(3) + "c"});
  const Contents contents = contents_of(file);
  EXPECT_EQ(values(contents, "S.channel_1"), Vector(Eigen::Vector2d('a', 'c')));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("byte " + std::to_string(damage)),
                                             HasSubstr(std::to_string(resumed - damage) + " bytes"))));
}

TEST(DecodeXdf, ReadsWhatStandsBeforeTheEndOfACutFile) {
  const std::string whole = test::small_xdf().bytes();
  std::size_t read = 0;
  for (std::size_t size = 4; size < whole.size(); ++size) {
    const auto contents = decoded(whole.substr(0, size));
    if (!contents) continue;
    ++read;
    if (contents->arrays.empty()) continue;
    EXPECT_EQ(values(*contents, "Robot.x"), Vector::LinSpaced(10, 0, 9));
  }
  EXPECT_GT(read, 100u);
}

TEST(DecodeXdf, DoesNotBelieveCounts) {
  Xdf file;
  file.header().stream(1, "S", "int8", 1, 0).samples(1, {Xdf::stamped(1) + "a"}).boundary();
  file.chunk(3, raw(std::uint32_t{1}) + "\x08" + raw(~std::uint64_t{0}) + Xdf::stamped(2) + "b").boundary();
  file.stream(2, "T", "double64", 65536, 0)
      .stream(3, "U", "int8", 2'000'000'000, 0)
      .samples(3, {Xdf::stamped(3) + "c"});
  const Contents contents = contents_of(file);
  EXPECT_EQ(array(contents, "S.channel_1").values.size(), 1);
  EXPECT_EQ(contents.arrays.size(), 2u);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("2000000000 channels"), HasSubstr("'int8'"))));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("1 chunk"), HasSubstr("1 stream"))));
}

TEST(DecodeXdf, SkipsChunksOfKindsThatItDoesNotKnow) {
  Xdf file, known;
  file.header().chunk(9, "something new").stream(1, "S", "int8", 1, 0).samples(1, {Xdf::stamped(1) + "a"});
  known.header().stream(1, "S", "int8", 1, 0).samples(1, {Xdf::stamped(1) + "a"});
  EXPECT_EQ(contents_of(file).notes, contents_of(known).notes);
}

TEST(DecodeXdf, RefusesWhatHoldsNothing) {
  EXPECT_THAT(decoded("XDG:").error().message, HasSubstr("XDF"));
  EXPECT_THAT(decoded("XDF:").error().message, HasSubstr("stream"));
  EXPECT_THAT(decoded(Xdf().header().stream(1, "S", "int8", 1, 0).bytes()).error().message, HasSubstr("sample"));
}

TEST(DecodeXdf, WarnsOfAnEffectiveRateFarFromTheNominalOne) {
  Xdf file;
  file.header().stream(1, "S", "int8", 1, 100).stream(2, "T", "int8", 1, 100);
  std::vector<std::string> slow, nearly;
  for (int k = 0; k < 100; ++k) {
    slow.push_back(Xdf::stamped(k * 0.0125) + "a");
    nearly.push_back(Xdf::stamped(k * 0.0105) + "a");
  }
  const Contents contents = contents_of(file.samples(1, slow).samples(2, nearly));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("80 Hz"), HasSubstr("10 %"))));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("'T'"), HasSubstr("100 samples"), HasSubstr("100 Hz"),
                                             HasSubstr("95.2381 Hz"), Not(HasSubstr("10 %")))));
}

TEST(DecodeXdf, LeavesTheStampsOfAStreamThatDropsSamples) {
  Xdf file;
  file.header().stream(1, "S", "int8", 1, 100,
                       "<synchronization><can_drop_samples>true</can_drop_samples></synchronization>");
  const Contents contents =
      contents_of(file.samples(1, {Xdf::stamped(1) + "a", Xdf::stamped(1.3) + "b", Xdf::stamped(1.31) + "c"}));
  EXPECT_EQ(contents.clocks[0].time, Vector(Eigen::Vector3d(1, 1.3, 1.31)));
}

// ---- clocks ----

std::vector<ClockOffset> offsets_of(int count, double begin, double value, double slope, Index first_sample = 0) {
  std::vector<ClockOffset> offsets;
  for (int k = 0; k < count; ++k) {
    const double time = begin + 5.0 * k;
    // As measured: never quite on the line.
    offsets.push_back({time, value + slope * (time - begin) + (k % 2 == 0 ? 1e-5 : -1e-5), first_sample + 500 * k});
  }
  return offsets;
}

TEST(HuberLine, IsThatOfLeastSquaresWithoutOutliersAndIgnoresThem) {
  const Vector time = Vector::LinSpaced(40, 100.0, 300.0);
  Vector values = (-7.0 + 2e-6 * time.array()).matrix();
  const RobustLine exact = huber_line(time, values, 1e-4);
  EXPECT_NEAR(exact.slope, 2e-6, 1e-14);
  EXPECT_NEAR(exact.offset, -7.0 + 2e-6 * 200.0, 1e-12);
  values[7] += 0.3;
  values[30] -= 2.0;
  const RobustLine robust = huber_line(time, values, 1e-4);
  EXPECT_NEAR(robust.slope, 2e-6, 1e-7);
  EXPECT_NEAR(robust.offset, exact.offset, 2e-5);
}

TEST(HuberLine, IsWhereTheLossIsStationary) {
  Vector time(30), values(30);
  for (Index k = 0; k < 30; ++k) {
    time[k] = 0.7 * static_cast<double>(k);
    values[k] = 3e-4 * std::sin(5.0 * static_cast<double>(k)) + 1e-5 * time[k];
  }
  const RobustLine line = huber_line(time, values, 1e-4);
  const auto [level, tilt] = pulls(line, time, values);
  EXPECT_NEAR(level, 0.0, 1e-8);
  EXPECT_NEAR(tilt, 0.0, 1e-7);
}

TEST(Synchronise, FollowsADrift) {
  const Vector stamps = Vector::LinSpaced(1001, 1000.0, 1010.0);
  const auto offsets = offsets_of(3, 1000.0, -40.0, 1e-4);
  const Synchronised clock = synchronise(stamps, offsets, std::nullopt);
  ASSERT_EQ(clock.segments.size(), 1u);
  EXPECT_NEAR(clock.segments[0].correction.line.slope, 1e-4, 1e-5);
  EXPECT_NEAR(clock.time[0], 960.0, 2e-5);
  EXPECT_NEAR(clock.time[1000], 970.001, 2e-5);
}

TEST(Synchronise, SplitsWhereTheClockRunsBackward) {
  Vector stamps(8000);
  stamps << Vector::LinSpaced(4000, 1000.0, 1039.99), Vector::LinSpaced(4000, 3.0, 42.99);
  auto offsets = offsets_of(8, 1000.0, 5.0, 0.0);
  const auto more = offsets_of(8, 4.0, 1050.0, 0.0, 4100);
  offsets.insert(offsets.end(), more.begin(), more.end());
  const Synchronised clock = synchronise(stamps, offsets, std::nullopt);
  ASSERT_EQ(clock.segments.size(), 2u);
  EXPECT_EQ(clock.segments[0].last, 3999);  // though the first offset behind it stands at sample 4100
  EXPECT_NEAR(clock.time[3999], 1044.99, 2e-5);
  EXPECT_NEAR(clock.time[4000], 1053.0, 2e-5);
}

TEST(Synchronise, SplitsWhereTheClockJumpsForward) {
  Vector stamps(8000);
  stamps << Vector::LinSpaced(4000, 1000.0, 1039.99), Vector::LinSpaced(4000, 2000.0, 2039.99);
  auto offsets = offsets_of(8, 1000.0, 5.0, 0.0);
  const auto more = offsets_of(8, 2001.0, -950.0, 0.0, 4100);
  offsets.insert(offsets.end(), more.begin(), more.end());
  EXPECT_EQ(synchronise(stamps, offsets, std::nullopt).segments.size(), 2u);
  for (std::size_t k = 8; k < 16; ++k) offsets[k].value = 5.0;  // a pause, and no reset
  EXPECT_EQ(synchronise(stamps, offsets, std::nullopt).segments.size(), 1u);
}

TEST(Synchronise, LeavesOutACorruptLastOffsetWhereSamplesFollowTheFooter) {
  const Vector stamps = Vector::LinSpaced(4000, 1000.0, 1039.99);
  auto offsets = offsets_of(8, 1000.0, 5.0, 0.0);
  offsets.back().value = 400.0;
  EXPECT_FALSE(synchronise(stamps, offsets, 4000).last_was_corrupt);
  EXPECT_FALSE(synchronise(stamps, offsets, std::nullopt).last_was_corrupt);
  EXPECT_TRUE(synchronise(stamps, offsets, 3990).last_was_corrupt);
  EXPECT_NEAR(synchronise(stamps, offsets, 3990).time[0], 1005.0, 2e-5);
  offsets = offsets_of(8, 1000.0, 5.0, 0.0);
  EXPECT_FALSE(synchronise(stamps, offsets, 3990).last_was_corrupt);
  offsets.back().time += 60.0;
  EXPECT_TRUE(synchronise(stamps, offsets, 3990).last_was_corrupt);
}

TEST(Synchronise, IgnoresOffsetsThatAreNoNumbers) {
  auto offsets = offsets_of(3, 0.0, 1.0, 0.0);
  offsets[1].value = std::nan("");
  const Synchronised clock = synchronise(Vector::LinSpaced(3, 0.0, 10.0), offsets, std::nullopt);
  EXPECT_EQ(clock.not_finite, 1u);
  EXPECT_NEAR(clock.time[0], 1.0, 2e-5);
}

TEST(Dejitter, EvensOutBetweenBreaks) {
  Vector time(200);
  for (Index k = 0; k < 200; ++k)
    time[k] = 0.01 * static_cast<double>(k) + (k % 2 == 0 ? 1e-3 : -1e-3) + (k < 100 ? 0 : 9.0);
  const Dejittered even = dejitter(time, 100.0, {});
  ASSERT_EQ(even.segments.size(), 2u);
  EXPECT_EQ(even.segments[1].first, 100);
  EXPECT_NEAR(even.effective_hz, 100.0, 0.1);
  EXPECT_NEAR(even.largest_shift, 1e-3, 1e-4);
  EXPECT_LT(even.lasting_shift, 1e-4);
  const Vector intervals = even.time.segment(1, 99) - even.time.segment(0, 99);
  EXPECT_LT(intervals.maxCoeff() - intervals.minCoeff(), 1e-12);
  EXPECT_EQ(dejitter(time, 10.0, {}).segments.size(), 1u);  // 500 samples last longer than the pause
  const Index parts[] = {0, 50};
  EXPECT_EQ(dejitter(time, 10.0, parts).segments.size(), 2u);
}

}  // namespace xdf_test
}  // namespace mbk::recording
