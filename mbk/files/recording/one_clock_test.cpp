#include "mbk/files/recording/one_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "mbk/files/recording/assemble.h"

namespace mbk::recording {
namespace one_clock_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Clock steady(const std::string& name, double begin, double rate_hz, Index count) {
  return {name, begin + Vector::LinSpaced(count, 0.0, static_cast<double>(count - 1)).array() / rate_hz};
}

std::string refused(const Clock& chosen, std::span<const ClockedSignal> signals) {
  const auto common = put_on_clock(chosen, signals);
  EXPECT_FALSE(common);
  return common ? "" : common.error().line();
}

TEST(RateOf, IsOneOverTheMedianInterval) {
  EXPECT_DOUBLE_EQ(rate_of(steady("a", 1.7e9, 256.0, 50)), 256.0);
  EXPECT_DOUBLE_EQ(rate_of({"a", (Vector(5) << 0, 1, 2, 3, 100).finished()}), 1.0);  // a gap says nothing of the rate
  EXPECT_EQ(rate_of({"a", Vector::Zero(1)}), 0.0);
  EXPECT_EQ(rate_of({"a", Vector()}), 0.0);
  EXPECT_EQ(rate_of({"a", Vector::Zero(9)}), 0.0);
}

TEST(PutOnClock, KeepsTheChosenStreamToTheBit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(0.0, 0.4e-3);
  Clock chosen = steady("robot", 12.0, 1000.0, 500);
  for (double& stamp : chosen.time) stamp += jitter(random);
  const Clock other = steady("eeg", 12.1, 250.0, 50);
  const Vector original = Vector::Random(500);
  Vector own = original, foreign = Vector::Random(50);
  const std::vector<ClockedSignal> signals{{"force_x", &chosen, &own}, {"input", &other, &foreign}};
  const auto common = put_on_clock(chosen, signals);
  ASSERT_TRUE(common) << common.error().line();
  const Index count = common->time.size();
  Index first = 0;
  while (chosen.time[first] < other.time[0]) ++first;
  EXPECT_EQ(common->time, chosen.time.segment(first, count));
  EXPECT_EQ(own, original.segment(first, count));
  EXPECT_EQ(foreign.size(), count);
  EXPECT_LE(common->time[count - 1], other.time[49]);
  EXPECT_GT(chosen.time[first + count], other.time[49]);  // no more was cut than had to be
}

TEST(PutOnClock, InterpolatesALineExactly) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (const double begin : {0.0, -5.0, 1.7e9}) {
    const Clock chosen = steady("a", begin, 100.0, 400);
    Clock other = steady("b", begin - 0.011, 37.0, 160);
    for (double& stamp : other.time) stamp += jitter(random) / 37.0;
    Vector values = 3.0 * (other.time.array() - begin) - 2.0;
    const auto common = put_on_clock(chosen, std::vector<ClockedSignal>{{"x", &other, &values}});
    ASSERT_TRUE(common) << common.error().line();
    const Vector expected = 3.0 * (common->time.array() - begin) - 2.0;
    EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), begin > 1.0 ? 2e-6 : 1e-13);  // stamps of 1.7e9 s have 0.2 us
    EXPECT_GT(common->time.size(), 390);
  }
}

TEST(PutOnClock, TakesASampleWhoseStampIsTheSameAsItIs) {
  const Clock chosen = steady("a", 0.0, 10.0, 11), other = steady("b", 0.0, 5.0, 6);
  Vector values = Vector::Random(6);
  const Vector original = values;
  ASSERT_TRUE(put_on_clock(chosen, std::vector<ClockedSignal>{{"x", &other, &values}}));
  for (Index k = 0; k < 6; ++k) EXPECT_EQ(values[2 * k], original[k]);
  EXPECT_DOUBLE_EQ(values[1], (original[0] + original[1]) / 2);
}

TEST(PutOnClock, MakesNothingUpOverAGap) {
  const Clock chosen = steady("a", 0.0, 10.0, 101);
  Clock other = steady("b", 0.0, 1.0, 11);
  other.time = (Vector(9) << 0, 1, 2, 4, 5, 8, 9, 10, 11).finished();  // one sample is missing, then two are
  Vector values = Vector::Ones(9);
  const auto common = put_on_clock(chosen, std::vector<ClockedSignal>{{"x", &other, &values}});
  ASSERT_TRUE(common) << common.error().line();
  for (Index k = 0; k < common->time.size(); ++k) {
    const double t = common->time[k];
    const bool unknown = t > 5.0 && t < 8.0;
    EXPECT_EQ(std::isnan(values[k]), unknown) << t;
    if (!unknown) {
      EXPECT_EQ(values[k], 1.0) << t;
    }
  }
  EXPECT_THAT(common->notes, ElementsAre(AllOf(HasSubstr("'b'"), HasSubstr("1 Hz"), HasSubstr("'a'"),
                                               HasSubstr("10 Hz"), HasSubstr("29 samples"), HasSubstr("NaN"))));
}

TEST(PutOnClock, SpreadsWhatIsNoNumberToBothSidesOnly) {
  const Clock chosen = steady("a", 0.0, 2.0, 9), other = steady("b", 0.0, 1.0, 5);
  Vector values = (Vector(5) << 0, 1, kNaN, 3, 4).finished();
  ASSERT_TRUE(put_on_clock(chosen, std::vector<ClockedSignal>{{"x", &other, &values}}));
  for (Index k = 0; k < 9; ++k) EXPECT_EQ(std::isnan(values[k]), k >= 3 && k <= 5) << k;
}

TEST(PutOnClock, LeavesOutWhatNotEveryStreamCovers) {
  const Clock chosen = steady("a", 0.0, 10.0, 100), early = steady("b", -1.0, 10.0, 61),
              late = steady("c", 2.05, 10.0, 90);
  Vector b = Vector::Zero(61), c = Vector::Zero(90);
  const auto common = put_on_clock(chosen, std::vector<ClockedSignal>{{"x", &early, &b}, {"y", &late, &c}});
  ASSERT_TRUE(common) << common.error().line();
  EXPECT_DOUBLE_EQ(common->time[0], 2.1);
  EXPECT_DOUBLE_EQ(common->time[common->time.size() - 1], 5.0);
  EXPECT_EQ(common->time.size(), 30);
  EXPECT_THAT(common->notes.back(), AllOf(HasSubstr("70 samples"), HasSubstr("'a'")));
}

TEST(PutOnClock, SaysWhatFoldsDown) {
  const Clock slow = steady("camera", 0.0, 100.0, 50), fast = steady("force", 0.0, 1000.0, 500);
  Vector values = Vector::Zero(500);
  const auto common = put_on_clock(slow, std::vector<ClockedSignal>{{"force_x", &fast, &values}});
  ASSERT_TRUE(common);
  EXPECT_EQ(values.size(), 50);
  EXPECT_THAT(common->notes, ElementsAre(HasSubstr("50 Hz")));
}

TEST(PutOnClock, TouchesNothingWhereThereIsOneStream) {
  const Clock odd{"a", (Vector(4) << 0, 2, 1, kNaN).finished()};  // `mbk info` says what is wrong with it
  Vector values = Vector::LinSpaced(4, 0, 3);
  const auto common = put_on_clock(odd, std::vector<ClockedSignal>{{"x", &odd, &values}});
  ASSERT_TRUE(common) << common.error().line();
  EXPECT_EQ(common->time.head(3), odd.time.head(3));
  EXPECT_EQ(values, Vector(Vector::LinSpaced(4, 0, 3)));
  EXPECT_THAT(common->notes, IsEmpty());
}

TEST(PutOnClock, RefusesStampsThatDoNotRise) {
  const Clock good = steady("good", 0.0, 1.0, 4);
  Vector values = Vector::Zero(4);
  for (const auto& [stamps, says] : {std::pair{(Vector(4) << 0, 2, 1, 3).finished(), "sample 3"},
                                     {(Vector(4) << 0, 1, 1, 3).finished(), "sample 3"},
                                     {(Vector(4) << 0, 1, kNaN, 3).finished(), "NaN"},
                                     {(Vector(4) << 0, 1, 2, HUGE_VAL).finished(), "number"}}) {
    const Clock bad{"bad", stamps};
    EXPECT_THAT(refused(good, std::vector<ClockedSignal>{{"x", &bad, &values}}),
                AllOf(HasSubstr("'bad'"), HasSubstr(says)));
    EXPECT_THAT(refused(bad, std::vector<ClockedSignal>{{"x", &good, &values}}),
                AllOf(HasSubstr("'bad'"), HasSubstr(says)));
  }
}

TEST(PutOnClock, RefusesStreamsThatDoNotMeet) {
  const Clock a = steady("a", 0.0, 1.0, 4), b = steady("b", 10.0, 1.0, 4), none{"none", Vector()};
  const Clock between{"between", (Vector(2) << 1.2, 1.7).finished()};  // overlaps, but there is no stamp of `a` in it
  Vector four = Vector::Zero(4), two = Vector::Zero(2), zero;
  EXPECT_THAT(refused(a, std::vector<ClockedSignal>{{"x", &b, &four}}), HasSubstr("mbk info"));
  EXPECT_THAT(refused(a, std::vector<ClockedSignal>{{"x", &between, &two}}), HasSubstr("mbk info"));
  EXPECT_THAT(refused(a, std::vector<ClockedSignal>{{"x", &none, &zero}}), HasSubstr("'none'"));
  EXPECT_THAT(refused(none, std::vector<ClockedSignal>{{"x", &a, &four}}), HasSubstr("'none'"));
}

TEST(PutOnClock, RefusesASignalOfAnotherLengthThanItsClock) {
  const Clock a = steady("a", 0.0, 1.0, 4), b = steady("b", 0.0, 2.0, 8);
  Vector wrong = Vector::Zero(7), right = Vector::Zero(8);
  for (const Clock* const chosen : {&a, &b}) {
    EXPECT_THAT(refused(*chosen, std::vector<ClockedSignal>{{"y", &b, &right}, {"x", &b, &wrong}}),
                AllOf(HasSubstr("7 samples"), HasSubstr("'b'")));
  }
}

TEST(PutOnClock, TakesAStreamOfOneSampleWhereTheStampsMeet) {
  const Clock a = steady("a", 0.0, 1.0, 4), one{"one", Vector::Constant(1, 2.0)};
  Vector value = Vector::Constant(1, 7.0);
  const auto common = put_on_clock(a, std::vector<ClockedSignal>{{"x", &one, &value}});
  ASSERT_TRUE(common) << common.error().line();
  EXPECT_EQ(common->time, Vector::Constant(1, 2.0));
  EXPECT_EQ(value, Vector::Constant(1, 7.0));
}

// ---- through the assembly of a recording ----

/// A robot at 1000 Hz and a tracker at 100 Hz that starts later.
Contents two_streams() {
  Contents contents;
  contents.format = "XDF";
  contents.clocks = {steady("robot", 5.0, 1000.0, 2000), steady("tracker", 5.2504, 100.0, 150)};
  Array force{"robot/Fx", Matrix(contents.clocks[0].time), "N"},
      hand{"tracker/x", Matrix(contents.clocks[1].time), "m"};
  force.clock = 0;
  hand.clock = 1;
  contents.arrays.push_back(std::move(force));
  contents.arrays.push_back(std::move(hand));
  return contents;
}

TEST(AssembleStreams, AsksWhoseStampsTheRecordingHas) {
  const auto recording = assemble(two_streams(), {});
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().line(),
              AllOf(HasSubstr("'robot'"), HasSubstr("1000 Hz"), HasSubstr("'tracker'"), HasSubstr("100 Hz")));
  EXPECT_THAT(recording.error().remedy, HasSubstr("--clock 'robot'"));
  ReadOptions options;
  options.clock = "gaze";
  EXPECT_THAT(assemble(two_streams(), options).error().line(), HasSubstr("'gaze'"));
}

TEST(AssembleStreams, PutsEveryChannelOnTheChosenClock) {
  for (const auto& [clock, rate_hz] : {std::pair{"robot", 1000.0}, {"tracker", 100.0}}) {
    ReadOptions options;
    options.clock = clock;
    const auto recording = assemble(two_streams(), options);
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_NEAR((recording->time[1] - recording->time[0]) * rate_hz, 1.0, 1e-9);
    for (const char* name : {"force_x", "hand_x"}) {  // both are their own time
      EXPECT_LT((recording->find(name)->values - recording->time).cwiseAbs().maxCoeff(), 1e-12) << name;
    }
    EXPECT_EQ(recording->time_origin.source, clock);
  }
}

TEST(AssembleStreams, NeedsNoClockForChannelsOfOneStream) {
  ReadOptions options;
  options.channels = parse_channel_map("Fx=robot/Fx").value();
  Contents contents = two_streams();
  contents.clocks[0].time[7] = contents.clocks[0].time[5];  // what `mbk info` reports
  const auto recording = assemble(std::move(contents), options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 2000);
  EXPECT_THAT(recording->notes, testing::Not(testing::Contains(HasSubstr("interpolated"))));
}

TEST(AssembleStreams, DoesNotReadBeyondAnArrayThatHasNoClock) {
  for (const Index size : {3, 5000}) {
    for (const Index columns : {1, 2}) {
      Contents contents = two_streams();
      contents.arrays.push_back({"loose", Matrix(Matrix::Zero(size, columns)), "N"});
      ReadOptions options;
      options.channels = parse_channel_map(columns == 1 ? "Fx=robot/Fx,Fy=loose" : "Fx=robot/Fx,Fy=loose[2]").value();
      const auto recording = assemble(std::move(contents), options);
      ASSERT_FALSE(recording);
      EXPECT_THAT(recording.error().line(), HasSubstr("force_y"));
    }
  }
}

TEST(AssembleStreams, TakesNoChannelForTheTimeOfAStream) {
  Contents contents = two_streams();
  Array time{"robot/time", Matrix(Matrix::Zero(2000, 1)), "s"};
  time.clock = 0;
  contents.arrays.push_back(time);
  ReadOptions options;
  options.clock = "robot";
  const auto recording = assemble(contents, options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_NEAR(recording->time[0], 5.251, 1e-9);
  options.channels = parse_channel_map("time=robot/time,Fx=robot/Fx,x=tracker/x").value();
  EXPECT_THAT(assemble(contents, options).error().line(), AllOf(HasSubstr("--channels"), HasSubstr("--clock")));
  options.channels = parse_channel_map("time=robot/time,Fx=robot/Fx").value();  // as asked, of one stream
  const auto named = assemble(contents, options);
  ASSERT_TRUE(named) << named.error().line();
  EXPECT_EQ(named->time, Vector::Zero(2000));
}

}  // namespace one_clock_test
}  // namespace mbk::recording
