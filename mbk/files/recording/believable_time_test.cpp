#include "mbk/files/recording/believable_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace mbk::recording {
namespace believable_time_test {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Recording with_time(const Vector& time, const std::string& unit = "") {
  Recording recording;
  recording.time = time;
  recording.time_origin = {"time", "clock", unit, ""};
  return recording;
}

Vector even(Index samples, double from, double step) {
  return (from + step * Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)).array()).matrix();
}

TEST(UnwrapTime, JoinsACounterThatBeginsAnew) {
  struct Case {
    double ticks, per_second, from;
    const char* unit;
  };
  for (const Case& one :
       {Case{std::ldexp(1.0, 32), 1e6, 4294960000.0, "us"}, Case{std::ldexp(1.0, 32), 1e3, 4294960000.0, "ms"},
        Case{std::ldexp(1.0, 16), 1e3, 60000.0, "ms"}, Case{std::ldexp(1.0, 24), 1e6, 16e6, "us"},
        Case{std::ldexp(1.0, 31), 1e6, 2147480000.0, "us"}}) {
    const double step = 1e-3 * one.per_second;
    const Vector ticks = even(20000, one.from, step);
    const Vector wrapped = ticks.unaryExpr([&](double t) { return std::fmod(t, one.ticks); });
    Recording recording = with_time(wrapped / one.per_second, one.unit);
    unwrap_time(recording);
    EXPECT_LT((recording.time - ticks / one.per_second).cwiseAbs().maxCoeff(), 1e-6) << one.ticks << one.unit;
    EXPECT_THAT(recording.notes, SizeIs(1));
  }
}

TEST(UnwrapTime, JoinsASignedCounter) {
  const Vector ticks = even(20000, std::ldexp(1.0, 31) - 5e6, 1000.0);
  Recording recording =
      with_time(ticks.unaryExpr([](double t) { return t >= std::ldexp(1.0, 31) ? t - std::ldexp(1.0, 32) : t; }) / 1e6);
  unwrap_time(recording);
  EXPECT_LT((recording.time - ticks / 1e6).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(UnwrapTime, JoinsAMinuteAnHourThatIsSetBackAndMidnight) {
  for (const double back : {60.0, 3600.0, 86400.0}) {
    const Vector time = even(20000, 86390.0, 1e-3);
    Vector recorded = time;
    recorded.tail(10000).array() -= back;
    Recording recording = with_time(recorded);
    unwrap_time(recording);
    EXPECT_LT((recording.time - time).cwiseAbs().maxCoeff(), 1e-6) << back;
  }
}

TEST(UnwrapTime, LeavesATrialThatBeginsAgain) {
  Vector time(131072);
  time << even(65536, 0.0, 1e-3), even(65536, 0.0, 1e-3);  // as long as a 16-bit counter of milliseconds
  Recording recording = with_time(time);
  unwrap_time(recording);
  EXPECT_EQ(recording.time, time);
  EXPECT_THAT(recording.notes, IsEmpty());
}

TEST(UnwrapTime, LeavesWhatIsNoPeriodOfAClock) {
  Vector time = even(20000, 100.0, 1e-3);
  time.tail(10000).array() -= 7.3;
  Recording recording = with_time(time);
  unwrap_time(recording);
  EXPECT_EQ(recording.time, time);
}

TEST(CheckUnitOfTime, RefusesWhatCannotBeSecondsAndNamesWhatItCanBe) {
  struct Case {
    double step;
    const char* unit;
  };
  for (const Case& one :
       {Case{1.0, "time=clock:ms"}, Case{2.0, "time=clock:ms"}, Case{5.0, "time=clock:ms"}, Case{10.0, "time=clock:ms"},
        Case{1000.0, "time=clock:us"}, Case{500.0, "time=clock:us"}, Case{1e6, "time=clock:ns"},
        Case{1.0 / 60e3, "time=clock:min"}, Case{1.0 / 6e3, "time=clock:min"}, Case{1e4, "time=clock*1e-7"},
        Case{1.0 / 86400e3, "time=clock:day"}}) {
    const auto checked = check_unit_of_time(with_time(even(40000, 123456.0, one.step)), false);
    ASSERT_FALSE(checked) << one.step;
    EXPECT_EQ(checked.error().kind, ErrorKind::data);
    EXPECT_THAT(checked.error().remedy, HasSubstr(one.unit));
  }
  // Half a millisecond, in whole milliseconds: each stamp twice. A fifth of one: no recording lasts so long.
  EXPECT_FALSE(check_unit_of_time(with_time(even(40000, 0.0, 0.5).array().floor().matrix()), false));
  EXPECT_FALSE(check_unit_of_time(with_time(even(300000, 0.0, 0.2)), false));
}

TEST(CheckUnitOfTime, OffersTheRateWhereSamplesAreCounted) {
  EXPECT_THAT(check_unit_of_time(with_time(even(40000, 7.0, 1.0)), false).error().remedy, HasSubstr("--rate"));
  EXPECT_THAT(check_unit_of_time(with_time(even(40000, 7.0, 2.0)), false).error().remedy, Not(HasSubstr("--rate")));
}

TEST(TakeRate, DividesACountOfSamplesAndKeepsTheLostOnes) {
  Vector count = even(2000, 500.0, 1.0);
  count.tail(1000).array() += 50.0;
  Recording recording = with_time(count);
  ASSERT_TRUE(take_rate(recording, 500.0));
  EXPECT_LT((recording.time - (count.array() - 500.0).matrix() / 500.0).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_THAT(recording.notes, SizeIs(1));
}

TEST(TakeRate, SpreadsStampsThatAreToldCoarsely) {
  const Vector time = even(20000, 3.0, 1e-3);
  for (const double step : {0.01, 0.1}) {
    Recording recording = with_time(time.unaryExpr([&](double t) { return step * std::round(t / step); }));
    ASSERT_TRUE(take_rate(recording, 1000.0)) << step;
    EXPECT_LT((recording.time - (time.array() - 3.0).matrix()).cwiseAbs().maxCoeff(), 1e-9);
    Recording other = with_time(time.unaryExpr([&](double t) { return step * std::round(t / step); }));
    EXPECT_FALSE(take_rate(other, 900.0));
  }
}

TEST(TakeRate, LeavesATimeThatIsOne) {
  Recording recording = with_time(even(2000, 0.0, 1e-3));
  EXPECT_FALSE(take_rate(recording, 1000.0));
  EXPECT_FALSE(take_rate(recording, 500.0));
}

TEST(CheckUnitOfTime, BelievesWhoSaysIt) {
  EXPECT_TRUE(check_unit_of_time(with_time(even(60, 0.0, 1.0), "s"), true));
}

TEST(CheckUnitOfTime, BelievesTrueClocks) {
  for (const double rate : {4.0, 5.0, 45.0, 60.0, 100.0, 128.0, 1000.0, 5000.0, 20000.0}) {
    for (const double from : {0.0, 1.7e9}) {
      const Vector time = even(10000, from, 1.0 / rate);
      EXPECT_TRUE(check_unit_of_time(with_time(time), false)) << rate;
      Recording same = with_time(time);
      unwrap_time(same);
      EXPECT_EQ(same.time, time) << rate;
    }
  }
}

}  // namespace believable_time_test
}  // namespace mbk::recording
