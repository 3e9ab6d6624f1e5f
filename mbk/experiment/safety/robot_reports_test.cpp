#include "mbk/experiment/safety/robot_reports.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace mbk::safety {
namespace robot_reports_test {

constexpr double kTick = 1e-3;
constexpr int kBegin = 500;
constexpr device::Abilities kAbilities{.acknowledges = true};

/// A robot that does as it is told: it obeys with one tick of delay, and its clock began long before and runs 100 ppm
/// faster.
device::State honest(int tick) {
  device::State report;
  report.time = 1234.5 + 1.0001 * kTick * tick;
  report.answered = static_cast<std::uint64_t>(std::max(0, tick - 1));
  report.motors = tick > 1 ? Motors::on : Motors::off;
  return report;
}

struct Seen {
  Violation violation;
  int ticks = -1;  ///< from the first spoilt report; −1: never
};

Seen watch(const std::function<void(device::State&, int k)>& spoil, int most = 3000, const Limits& limits = {}) {
  ReportCheck check(limits, kTick);
  for (int i = 0; i < kBegin + most; ++i) {
    device::State report = honest(i);
    if (i >= kBegin) spoil(report, i - kBegin);
    if (const Violation found = check.check(report, kAbilities, kTick * i, static_cast<std::uint64_t>(i))) {
      return {found, i - kBegin};
    }
  }
  return {};
}

TEST(ReportCheck, BelievesAnHonestRobotForAnHour) {
  EXPECT_EQ(watch([](device::State&, int) {}, 3'600'000).ticks, -1);
}

TEST(ReportCheck, BelievesAClockThatJittersByAMillisecond) {
  const auto seen = watch([](device::State& report, int k) { report.time += 0.9e-3 * std::sin(1.3 * k * k); });
  EXPECT_NE(seen.violation.reason, Reason::state_old);
}

struct Lie {
  const char* name;
  Reason reason;
  int longest;  // ticks
  std::function<void(device::State&, int)> spoil;
};

class EveryLie : public testing::TestWithParam<Lie> {};

TEST_P(EveryLie, IsFoundInTimeAndNamed) {
  const Seen seen = watch(GetParam().spoil);
  EXPECT_EQ(word_of(seen.violation.reason), word_of(GetParam().reason));
  EXPECT_GE(seen.ticks, 0);
  EXPECT_LE(seen.ticks, GetParam().longest);
}

std::uint64_t answer_at(int k) {
  return honest(kBegin + k).answered;
}

INSTANTIATE_TEST_SUITE_P(
    ReportCheck, EveryLie,
    testing::Values(
        Lie{"fault", Reason::robot_fault, 0, [](device::State& r, int) { r.fault = 3; }},
        Lie{"watchdog", Reason::robot_watchdog, 0, [](device::State& r, int) { r.watchdog_expired = true; }},
        Lie{"force sensor", Reason::sensor_missing, 0, [](device::State& r, int) { r.has_force = false; }},
        Lie{"accelerometer", Reason::sensor_missing, 0, [](device::State& r, int) { r.has_acceleration = false; }},
        Lie{"drives no longer measure", Reason::sensor_missing, 1,
            [](device::State& r, int k) { r.drives_measure = k == 0; }},
        Lie{"measured torque not finite", Reason::sensor_missing, 0,
            [](device::State& r, int) {
              r.drives_measure = true;
              r.drive_torque[1] = std::numeric_limits<double>::quiet_NaN();
            }},
        Lie{"clock not finite", Reason::robot_clock, 0,
            [](device::State& r, int) { r.time = std::numeric_limits<double>::quiet_NaN(); }},
        Lie{"clock stands still", Reason::robot_clock, 1, [](device::State& r, int) { r.time = honest(kBegin).time; }},
        Lie{"clock runs backward", Reason::robot_clock, 1,
            [](device::State& r, int k) { r.time = honest(kBegin - k).time; }},
        Lie{"clock jumps ahead", Reason::robot_clock, 0, [](device::State& r, int) { r.time += 0.5; }},
        Lie{"clock twice as fast", Reason::robot_clock, 60, [](device::State& r, int k) { r.time += kTick * k; }},
        Lie{"clock half as fast", Reason::state_old, 60, [](device::State& r, int k) { r.time -= 0.5 * kTick * k; }},
        Lie{"states 50 ms old", Reason::robot_clock, 50, [](device::State& r, int) { r.time -= 0.05; }},
        Lie{"states older and older", Reason::state_old, 220,
            [](device::State& r, int k) { r.time -= 0.1 * kTick * k; }},
        Lie{"answer frozen", Reason::answer_late, 21, [](device::State& r, int) { r.answered = answer_at(0); }},
        Lie{"answer later and later", Reason::answer_late, 45,
            [](device::State& r, int k) { r.answered = answer_at(k / 2); }},
        Lie{"answer to what was not sent", Reason::answer_wrong, 0,
            [](device::State& r, int k) { r.answered = answer_at(k) + 2; }},
        Lie{"answer taken back", Reason::answer_wrong, 0, [](device::State& r, int) { r.answered = answer_at(-3); }},
        Lie{"motors off", Reason::motors_off, 101, [](device::State& r, int) { r.motors = Motors::off; }}),
    [](const auto& lie) {
      std::string name = lie.param.name;
      std::ranges::replace(name, ' ', '_');
      return name;
    });

/// The robot was held up before the trial began: its last state waited, and the next one is much younger.
TEST(ReportCheck, AFirstStateThatWaitedIsNoClockThatJumps) {
  ReportCheck check(Limits{}, kTick);
  for (int i = 0; i < 2000; ++i) {
    device::State report = honest(i);
    if (i == 0) report.time -= 0.1;
    ASSERT_FALSE(check.check(report, kAbilities, kTick * i, static_cast<std::uint64_t>(i))) << i;
  }
}

TEST(ReportCheck, AMomentWithoutMotorsIsNoContradiction) {
  EXPECT_EQ(watch([](device::State& r, int k) { r.motors = k % 100 < 80 ? Motors::off : Motors::on; }).ticks, -1);
}

TEST(ReportCheck, ARobotThatWaitsForItsCommandsHasAClockOfItsOwn) {
  ReportCheck check(Limits{}, kTick);
  device::Abilities waits = kAbilities;
  waits.keeps_time = false;
  for (int i = 0; i < 5000; ++i) {
    device::State report = honest(i);
    report.time = 0.1 * kTick * (i + 1);  // ten times slower than this one
    ASSERT_FALSE(check.check(report, waits, kTick * i, static_cast<std::uint64_t>(i)));
  }
}

}  // namespace robot_reports_test
}  // namespace mbk::safety
