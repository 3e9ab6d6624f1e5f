#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/files/c3d/test_c3d.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"

namespace mbk::recording {
namespace {

using testing::HasSubstr;

class ReadParts : public testing::Test {
 protected:
  std::filesystem::path log(const std::string& name, double start, Index samples = 10) {
    Matrix values = test::logs(samples);
    values.row(0).array() += start;
    return folder_.write(name, test::mat4("logs", values));
  }
  Error bad(std::vector<std::filesystem::path> parts, const ReadOptions& options = {}) {
    const auto recording = read_parts(std::move(parts), options);
    EXPECT_FALSE(recording);
    return recording ? Error{} : recording.error();
  }
  test::Folder folder_;
};

TEST_F(ReadParts, JoinsInTheOrderOfTheNumbers) {
  const auto recording =
      read_parts({log("log_10.mat", 0.02), log("log_9.mat", 0.01), log("log_8.mat", 0.0), log("log_11.mat", 0.03)}, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 40);
  const Inspection facts = inspect(*recording);
  EXPECT_EQ(facts.backward_times, 0);
  EXPECT_TRUE(facts.gaps.empty());
  EXPECT_EQ(recording->find("hand_x")->values.size(), 40);
  ASSERT_EQ(recording->sources.size(), 4u);
  EXPECT_THAT(recording->sources[0].path, HasSubstr("log_8.mat"));
  EXPECT_THAT(recording->sources[3].path, HasSubstr("log_11.mat"));
}

TEST_F(ReadParts, KeepsAPauseBetweenPartsAsAGap) {
  const auto recording = read_parts({log("log_1.mat", 0), log("log_2.mat", 1)}, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(inspect(*recording).gaps.at(0).sample, 9);
}

TEST_F(ReadParts, GoOnOnAClockOfNanosecondsSince1970) {
  ReadOptions options;
  options.channels = parse_channel_map("time=t:ns,x=x").value();
  const auto recording = read_parts({folder_.write("a1.csv", "t,x\n1709288130000000001,1\n1709288130001000001,2\n"),
                                     folder_.write("a2.csv", "t,x\n1709288130002000001,3\n1709288130003000001,4\n")},
                                    options);
  ASSERT_TRUE(recording) << recording.error().line();
  constexpr double kSeconds = 3e-7;  // what a double can tell apart of seconds since 1970
  EXPECT_EQ(recording->time[1], 0.001);
  EXPECT_NEAR(recording->time[2], 0.002, kSeconds);
  EXPECT_NEAR(recording->time[3], 0.003, kSeconds);
}

TEST_F(ReadParts, CountsTimeOnWhereTheRateGivesIt) {
  ReadOptions options;
  options.rate = Hertz(100);
  const auto recording =
      read_parts({folder_.write("a1.csv", "x\n1\n2\n"), folder_.write("a2.csv", "x\n3\n4\n")}, options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time, (Vector(4) << 0, 0.01, 0.02, 0.03).finished());
}

TEST_F(ReadParts, CountsTimeOnWhereTheFilesSayTheRate) {
  ReadOptions options;
  options.channels = parse_channel_map("Fx=Force X").value();
  test::C3d file = test::small_c3d();
  const auto first = folder_.write("a1.c3d", file.bytes());
  const auto recording = read_parts({first, folder_.write("a2.c3d", file.bytes())}, options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 24);
  for (Index k = 0; k < 24; ++k) EXPECT_NEAR(recording->time[k], static_cast<double>(k) / 200.0, 1e-12);
  ASSERT_EQ(recording->events.size(), 4u);
  EXPECT_NEAR(recording->events[2].time, 0.02 + 12 / 200.0, 1e-8);  // a 32-bit real
  file.rate = 50.0;
  EXPECT_THAT(bad({first, folder_.write("a2.c3d", file.bytes())}, options).message,
              AllOf(HasSubstr("100 Hz"), HasSubstr("200 Hz")));
}

TEST_F(ReadParts, JoinsMetadataAndEventsAndSaysWhereTheyDiffer) {
  for (int part = 1; part <= 2; ++part) {
    Recording recording;
    recording.time = Vector::LinSpaced(10, part, part + 0.9);
    recording.channels = {{"hand_x", "m", "base", Vector::Zero(10)}};
    recording.metadata = {{"participant", "7"}, {"part", std::to_string(part)}};
    recording.events = {{part + 0.5, "onset", 1.0 * part}};
    ASSERT_TRUE(write(recording, folder_ / fmt::format("log_{}.mat", part), Format::mat5, false));
  }
  const auto recording = read_parts({folder_ / "log_1.mat", folder_ / "log_2.mat"}, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->metadata, (std::map<std::string, std::string>{{"participant", "7"}, {"part", "1"}}));
  EXPECT_THAT(recording->notes, testing::Contains(AllOf(HasSubstr("'part'"), HasSubstr("'1'"), HasSubstr("'2'"))));
  ASSERT_EQ(recording->events.size(), 2u);
  EXPECT_EQ(recording->events[1].time, 2.5);
}

TEST_F(ReadParts, NamesAMissingPart) {
  EXPECT_THAT(bad({log("log_1.mat", 0), log("log_3.mat", 1)}).message, HasSubstr("part 2"));
}

TEST_F(ReadParts, RefusesTimeThatRestarts) {
  const Error error = bad({log("log_1.mat", 0), log("log_2.mat", 0)});
  EXPECT_THAT(error.line(), AllOf(HasSubstr("log_2.mat"), HasSubstr("0 s"), HasSubstr("0.009 s")));
}

TEST_F(ReadParts, RefusesTimeThatRunsBack) {
  EXPECT_THAT(bad({log("log_1.mat", 5), log("log_2.mat", 4)}).message, AllOf(HasSubstr("4 s"), HasSubstr("5.009 s")));
}

TEST_F(ReadParts, RefusesNamesThatDoNotBelongTogether) {
  EXPECT_THAT(bad({log("log_1.mat", 0), log("run_2.mat", 1)}).message,
              AllOf(HasSubstr("log_1.mat"), HasSubstr("run_2.mat")));
  EXPECT_EQ(bad({log("log_1.mat", 0), log("final.mat", 1)}).kind, ErrorKind::usage);
  EXPECT_THAT(bad({log("log_1.mat", 0), log("log_01.mat", 1)}).message, HasSubstr("part 1"));
  EXPECT_EQ(bad({}).kind, ErrorKind::usage);
}

TEST_F(ReadParts, RefusesPartsWithOtherChannels) {
  const Error error = bad({folder_.write("a1.csv", "t,x\n0,1\n"), folder_.write("a2.csv", "t,y\n1,1\n")});
  EXPECT_THAT(error.message, AllOf(HasSubstr("hand_y [m]"), HasSubstr("hand_x [m]")));
}

}  // namespace
}  // namespace mbk::recording
