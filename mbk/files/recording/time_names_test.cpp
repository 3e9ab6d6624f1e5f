#include "mbk/files/recording/time_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mbk/files/recording/assemble.h"

namespace mbk::recording {
namespace time_names_test {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr Index kRows = 400;

Array column(std::string name, double first, double step, std::string unit = "") {
  return {std::move(name), SharedMatrix::of_column(Vector(Vector::LinSpaced(kRows, first, first + step * (kRows - 1)))),
          std::move(unit)};
}

Contents table(std::vector<Array> times, bool is_table = true) {
  Contents contents;
  contents.format = "CSV";
  contents.table = is_table;
  contents.arrays = std::move(times);
  const Vector phase = Vector::LinSpaced(kRows, 0.0, 20.0);
  contents.arrays.push_back({"position", SharedMatrix::of_column(Vector(phase.array().sin()))});
  contents.arrays.push_back({"reaction", SharedMatrix::of_column(Vector(phase.array().cos()))});
  return contents;
}

Result<Recording> assembled(std::vector<Array> times, bool is_table = true) {
  return assemble(table(std::move(times), is_table), {});
}

TEST(TimeNames, AreRecognisedWithTheUnitThatTheySay) {
  for (const auto& [name, step] : std::vector<std::pair<std::string, double>>{{"timestamp", 0.002},
                                                                              {"TimeStamp", 0.002},
                                                                              {"timestamp_ms", 2.0},
                                                                              {"Time Stamp [us]", 2e3},
                                                                              {"tout", 0.002},
                                                                              {"elapsed", 0.002},
                                                                              {"Elapsed Time", 0.002},
                                                                              {"Elapsed Time (ms)", 2.0},
                                                                              {"Zeit", 0.002},
                                                                              {"Zeit [ms]", 2.0},
                                                                              {"__time", 0.002},
                                                                              {"Date/Time", 0.002},
                                                                              {"rosbagTimestamp(ns)", 2e6}}) {
    for (const bool is_table : {true, false}) {
      if (!is_table && name == "Date/Time") continue;
      const auto recording = assembled({column(name, 0.0, step)}, is_table);
      ASSERT_TRUE(recording) << name << recording.error().line();
      EXPECT_NEAR(recording->time[kRows - 1], 0.002 * (kRows - 1), 1e-9) << name;
      EXPECT_THAT(recording->notes, Contains(HasSubstr("'" + name + "'"))) << name;
    }
  }
}

TEST(TimeNames, AreInTheUnitThatTheirSizeSaysSince1970) {
  for (const auto& [unit, scale] :
       std::vector<std::pair<std::string, double>>{{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}) {
    const auto recording = assembled({column("timestamp", 1.7e9 * scale, 0.01 * scale)});
    ASSERT_TRUE(recording) << unit << recording.error().line();
    EXPECT_NEAR(recording->time[kRows - 1] - recording->time[0], 0.01 * (kRows - 1), 1e-5) << unit;
    EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'timestamp'"), HasSubstr("1970"))));
  }
  EXPECT_EQ(unit_since_1970(12.0), nullptr);
  EXPECT_EQ(unit_since_1970(5e10), nullptr);
}

TEST(TimeNames, LeaveAFileAloneThatHasATime) {
  const auto recording = assembled({column("timestamp", 1.7e18, 2e6), column("time", 0.0, 0.002)});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time_origin.source, "time");
  EXPECT_THAT(recording->notes, Not(Contains(HasSubstr("time=timestamp"))));
}

TEST(TimeNames, OfSecondClocksAreComparedWithTheFirst) {
  const auto rate = assembled({column("time", 0.0, 0.002), column("timestamp", 0.0, 0.004)});
  ASSERT_TRUE(rate) << rate.error().line();
  EXPECT_THAT(rate->notes, Contains(AllOf(HasSubstr("'timestamp'"), HasSubstr("250 Hz"), HasSubstr("'time'"),
                                          HasSubstr("500 Hz"), HasSubstr("time=timestamp"))));
  for (const bool is_table : {true, false}) {
    const auto drift = assembled({column("time", 0.0, 0.002), column("t_sensor", 7.0, 0.00201)}, is_table);
    ASSERT_TRUE(drift) << drift.error().line();
    EXPECT_THAT(drift->notes, Contains(AllOf(HasSubstr("'t_sensor'"), HasSubstr("'time'"), HasSubstr("3.99 ms"))));
  }
  // A clock of 16 ms that says the same, a duration and a constant are no other clocks.
  Array coarse = column("SystemTime", 0.0, 0.002), duration = column("reaction_time", 0.0, 1.0),
        still = column("t0", 3.0, 0.0);
  Vector ticks = Vector::LinSpaced(kRows, 0.0, 0.002 * (kRows - 1));
  coarse.values = SharedMatrix::of_column(Vector((ticks.array() / 0.016).floor() * 0.016));
  duration.values = SharedMatrix::of_column(Vector((ticks.array() * 9).sin()));
  const auto same = assembled({column("time", 0.0, 0.002), coarse, duration, still});
  ASSERT_TRUE(same) << same.error().line();
  EXPECT_THAT(same->notes, Not(Contains(HasSubstr("\"time="))));
}

TEST(TimeNames, ThatContradictEachOtherAreRefused) {
  const auto two = assembled({column("timestamp", 0.0, 0.002), column("rosbagTimestamp", 1.7e18, 2.2e6)});
  ASSERT_FALSE(two);
  EXPECT_THAT(two.error().line(), AllOf(HasSubstr("'timestamp'"), HasSubstr("'rosbagTimestamp'")));
  const auto named = assemble(table({column("timestamp", 0.0, 0.002), column("rosbagTimestamp", 1.7e18, 2.2e6)}),
                              {.channels = {{"time", "timestamp", "", false}}});
  EXPECT_TRUE(named) << named.error().line();
  EXPECT_TRUE(assembled({column("timestamp", 0.0, 0.002), column("rosbagTimestamp", 1.7e18, 2e6)}));
}

TEST(TimeNames, AreAdvisedWhereTheyOnlySpeakOfTime) {
  const auto recording = assembled({column("t_robot", 0.0, 0.002), column("t_sensor", 0.0, 0.002)});
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().line(), AllOf(HasSubstr("t_robot"), HasSubstr("t_sensor")));
  EXPECT_THAT(recording.error().remedy, HasSubstr("\"time=t_robot\""));
}

TEST(UnitsOfNames, AreNamedWhereTheyAreNotKnown) {
  Contents contents = table({column("time", 0.0, 0.002)});
  contents.arrays.back().name = "reaction (dyn)";
  const auto recording = assemble(contents, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'reaction (dyn)'"), HasSubstr("'dyn'"))));
  const auto mapped =
      assemble(std::move(contents), {.channels = {{"reaction", "reaction (dyn)", "", false}}, .axes = 1});
  ASSERT_TRUE(mapped) << mapped.error().line();
  EXPECT_THAT(mapped->notes, Contains(HasSubstr("'reaction (dyn)'")));
}

}  // namespace time_names_test
}  // namespace mbk::recording
