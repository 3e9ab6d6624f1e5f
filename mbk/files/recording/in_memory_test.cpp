#include "mbk/files/recording/in_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace mbk::recording {
namespace {

using ::testing::HasSubstr;

constexpr Index kSamples = 50;

Vector ramp(double step) {
  return step * Vector::LinSpaced(kSamples, 0.0, static_cast<double>(kSamples - 1));
}

TEST(InMemory, HoldsNumbersWhereTheyStandForAsLongAsSomebodyNeedsThem) {
  const Vector x = ramp(0.1);
  auto owner = std::make_shared<int>(1);
  const std::weak_ptr<int> alive = owner;
  {
    const auto made = InMemory::of({{"x", "mm", Samples(x.data(), kSamples, std::move(owner))},  //
                                    {"F", "", ramp(2.0)}},
                                   100.0, {{"participant", "7"}}, {{0.1, "mark", 1.0}});
    ASSERT_TRUE(made);
    EXPECT_EQ(made->find("x")->values.data(), x.data());
    EXPECT_EQ(made->find("position"), made->find("x"));
    EXPECT_EQ(made->find("hand_y"), nullptr);
    const auto recording = made->read({});
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->find("position")->values, Vector(x / 1000.0));
    EXPECT_EQ(recording->time, Vector(ramp(1.0) / 100.0));
    EXPECT_EQ(recording->metadata.at("participant"), "7");
    EXPECT_EQ(recording->events.size(), 1u);
    EXPECT_FALSE(alive.expired());
  }
  EXPECT_TRUE(alive.expired());
}

TEST(InMemory, IsReadWhereItStands) {
  const Vector x = ramp(0.1);
  const Matrix logs = Matrix::Random(19, kSamples);
  const auto owner = std::make_shared<int>(1);
  std::optional<Contents> contents;
  {
    const auto made = InMemory::of({{"x", "mm", Samples(x.data(), kSamples, owner)},
                                    {"logs", "", Samples(logs.data(), logs.size(), owner), logs.rows()}});
    ASSERT_TRUE(made) << made.error().line();
    contents = made->contents();
  }
  EXPECT_EQ(contents->arrays[0].values.data(), x.data());
  EXPECT_EQ(contents->arrays[1].values.data(), logs.data());
  EXPECT_EQ(contents->arrays[1].values.cols(), kSamples);
  EXPECT_EQ(owner.use_count(), 3);
  contents.reset();
  EXPECT_EQ(owner.use_count(), 1);
}

TEST(InMemory, IsReadByAMapAsAFileIs) {
  const auto made =
      InMemory::of({{"clock", "", ramp(0.01)}, {"angle of knee", "deg", ramp(1.0)}, {"load", "", ramp(2.0)}});
  ASSERT_TRUE(made);
  ReadOptions options;
  options.channels = parse_channel_map("time=clock,x=angle of knee,F=-load").value();
  options.axes = 1;
  const auto recording = made->read(options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_NEAR(recording->find("position")->values[1], M_PI / 180.0, 1e-15);
  EXPECT_EQ(recording->find("reaction")->values[2], -4.0);
  EXPECT_THAT(made->read({}).error().message, AllOf(HasSubstr("angle of knee"), HasSubstr("load")));
  options.trial = "3";
  EXPECT_EQ(made->read(options).error().kind, ErrorKind::usage);
}

TEST(InMemory, TakesALogsMatrix) {
  Matrix logs = Matrix::Zero(19, kSamples);
  logs.row(0) = ramp(0.01);
  logs.row(1) = ramp(0.001);
  const auto made = InMemory::of({{"logs", "", Vector(logs.reshaped()), 19}});
  ASSERT_TRUE(made);
  const auto recording = made->read({});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values, ramp(0.001));
}

TEST(InMemory, KeepsWhatWasReadAsItWas) {
  Recording recording;
  recording.time = ramp(0.01);
  recording.channels.push_back({"position", "m", "", ramp(1.0)});
  recording.sources = {{"log.mat", "MAT v7", "ab"}};
  recording.notes = {"a note"};
  const double* const there = recording.channels[0].values.data();
  const InMemory made = InMemory::of(std::move(recording));
  EXPECT_EQ(made.find("x")->values.data(), there);
  const auto again = made.read({});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->sources[0].path, "log.mat");
  EXPECT_EQ(again->notes.size(), 1u);
  ReadOptions one_axis;
  one_axis.axes = 1;
  EXPECT_EQ(made.read(one_axis)->sources[0].sha256, "ab");
}

TEST(InMemory, SaysWhatIsWrong) {
  EXPECT_EQ(InMemory::of(std::vector<InMemory::Signal>()).error().kind, ErrorKind::usage);
  EXPECT_THAT(InMemory::of({{"", "", ramp(1.0)}}).error().message, HasSubstr("name"));
  EXPECT_THAT(InMemory::of({{"x", "", ramp(1.0)}, {"x", "", ramp(1.0)}}).error().message, HasSubstr("'x'"));
  EXPECT_THAT(InMemory::of({{"x", "", ramp(1.0)}, {"F", "", Vector(Vector::Zero(3))}}).error().message,
              AllOf(HasSubstr("50 samples"), HasSubstr("'F'")));
  EXPECT_THAT(InMemory::of({{"x", "", Vector()}}).error().message, HasSubstr("empty"));
  EXPECT_EQ(InMemory::of({{"x", "", ramp(1.0)}}, std::nan("")).error().kind, ErrorKind::usage);
}

TEST(Samples, AreSharedByCopies) {
  const Samples first = ramp(1.0);
  Samples second = first;
  EXPECT_EQ(first.data(), second.data());
  const Samples third = std::move(second);
  EXPECT_EQ(first.data(), third.data());
  EXPECT_EQ(second.size(), 0);  // NOLINT(bugprone-use-after-move): nothing is left there
  EXPECT_EQ(third.sum(), ramp(1.0).sum());
}

}  // namespace
}  // namespace mbk::recording
