#include "mbk/validate/rule_breakers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <deque>
#include <set>
#include <vector>

#include "bridge/c/mbk_bridge.h"

namespace mbk::validation {
namespace {

using drivers::BridgeReport;
using drivers::BridgeRule;
using drivers::RuleVerdict;

constexpr std::int64_t kTick = 1'000'000;  // [ns]

/// A robot whose program is the C header, with a wire of 0.1 ms each way, in a time of its own.
class VirtualRobot : public drivers::BridgeWire {
 public:
  explicit VirtualRobot(SpoiltProgram program = {}, std::uint16_t version = 1) : program_(std::move(program)) {
    mbk_bridge_begin(&bridge_, version);
  }

  [[nodiscard]] std::int64_t now() noexcept override { return now_; }

  void wait_until(std::int64_t time) noexcept override {
    if (stall_at_ != 0 && time > stall_at_) time += std::exchange(stall_, 0);
    for (; next_ <= time; next_ += kTick) tick();
    now_ = std::max(now_, time);
  }

  void send(From from, std::span<const std::byte> bytes) noexcept override {
    came_.push_back({now_ + kWire, {{bytes.begin(), bytes.end()}, {1, from == From::mbk ? kMbk : kStranger}}});
  }

  int receive(std::span<std::byte> into) noexcept override {
    if (leaving_.empty() || leaving_.front().first > now_) return -1;
    const std::vector<std::byte> bytes = leaving_.front().second;
    leaving_.pop_front();
    std::memcpy(into.data(), bytes.data(), std::min(into.size(), bytes.size()));
    return static_cast<int>(bytes.size());
  }

  void press_stop() { stop_ = true; }
  /// Whoever checks is held up for so long once after `at` [ns].
  void stall(std::int64_t at, std::int64_t length) {
    stall_at_ = at;
    stall_ = length;
  }
  [[nodiscard]] bool motors_on() const { return drive_.enabled != 0; }
  [[nodiscard]] double moved() const { return moved_; }

 private:
  static constexpr std::int64_t kWire = 100'000;  // [ns]
  static constexpr std::uint16_t kMbk = 1, kStranger = 2;

  void tick() {
    const auto microseconds = static_cast<std::uint64_t>(next_ / 1000);
    for (; !came_.empty() && came_.front().first <= next_; came_.pop_front()) {
      SpoiltProgram::Heard& heard = came_.front().second;
      if (program_.hear) program_.hear(heard);
      if (heard.dropped) continue;
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(heard.bytes.data());
      if (mbk_bridge_take(&bridge_, bytes, heard.bytes.size(), heard.from.port, microseconds) == MBK_GREETED) {
        to_mbk_ = heard.from.port == kMbk;
      }
    }
    drive_ = mbk_bridge_drive(&bridge_, microseconds, stop_ ? 1 : 0);
    moved_ += std::abs(drive_.command[0]) + std::abs(drive_.command[1]);
    mbk_sample sample{};
    sample.time_s = 1e-9 * static_cast<double>(next_);
    sample.stop_pressed = stop_ ? 1 : 0;
    sample.motors_on = drive_.enabled;
    sample.obeyed = drive_.sequence;
    std::array<std::uint8_t, MBK_STATE_BYTES_2> bytes{};
    const std::size_t size = mbk_bridge_state(&bridge_, &sample, bytes.data());
    drivers::StateDatagram state;
    if (size == 0 || decode(std::as_bytes(std::span(bytes).first(size)), state) != drivers::Refusal::none) return;
    if (auto said = said_by(program_, state); !said.empty() && to_mbk_) leaving_.emplace_back(next_ + kWire, said);
  }

  SpoiltProgram program_;
  mbk_bridge bridge_{};
  mbk_drive drive_{};
  double moved_ = 0.0;
  bool stop_ = false, to_mbk_ = true;
  std::int64_t now_ = 0, next_ = kTick, stall_at_ = 0, stall_ = 0;
  std::deque<std::pair<std::int64_t, SpoiltProgram::Heard>> came_;
  std::deque<std::pair<std::int64_t, std::vector<std::byte>>> leaving_;
};

BridgeReport checked(VirtualRobot& robot, bool motors = true) {
  drivers::BridgeCheckOptions options;
  options.motors = motors;
  return check_bridge(robot, options).value();
}

std::set<std::string_view> with(const BridgeReport& report, RuleVerdict verdict) {
  std::set<std::string_view> rules;
  for (const drivers::RuleFinding& one : report.findings) {
    if (one.verdict == verdict) rules.insert(word_of(one.rule));
  }
  return rules;
}

std::string text(const BridgeReport& report) {
  std::string all;
  for (const drivers::RuleFinding& one : report.findings) {
    all += fmt::format("{}: {}: {}\n", word_of(one.rule), word_of(one.verdict), one.seen);
  }
  return all;
}

TEST(BridgeCheck, TheBridgeInCConforms) {
  for (const std::uint16_t version : {1, 2}) {
    VirtualRobot robot({}, version);
    const BridgeReport report = checked(robot);
    EXPECT_TRUE(report.conforms()) << text(report);
    EXPECT_FALSE(report.failed());
    EXPECT_FALSE(robot.motors_on());
    EXPECT_EQ(robot.moved(), 0.0);  // what is commanded is 0
    EXPECT_NEAR(report.rate.value(), 1000.0, 1e-6);
    EXPECT_LE(report.longest_answer.value(), 0.002);
    ASSERT_EQ(report.watchdogs.size(), 2U);
    EXPECT_NEAR(report.watchdogs[1][1], 0.12, 0.004);
  }
}

TEST(BridgeCheck, WithoutMotorsNothingIsSwitchedOnAndNothingConforms) {
  VirtualRobot robot({}, 1);
  const BridgeReport report = checked(robot, false);
  EXPECT_FALSE(report.conforms());
  EXPECT_FALSE(report.failed()) << text(report);
  EXPECT_EQ(with(report, RuleVerdict::not_tested),
            (std::set<std::string_view>{"motors-on", "greeting-while-on", "motors-off", "watchdog", "latched",
                                        "greets-again", "last-words"}));
}

TEST(BridgeCheck, EveryRuleHasARobotThatBreaksIt) {
  std::set<std::string_view> rules, names;
  for (const RuleBreaker& one : rule_breakers()) {
    rules.insert(word_of(one.rule));
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_EQ(find_rule_breaker(one.name), &one);
  }
  EXPECT_EQ(rules.size(), word_table(BridgeRule{}).size());
  EXPECT_EQ(find_rule_breaker("none"), nullptr);
}

/// It never conforms, and it is told that rule; some break others besides: what answers nothing obeys no last words.
TEST(BridgeCheck, ARobotThatBreaksARuleFailsIt) {
  std::size_t alone = 0;
  for (const RuleBreaker& breaker : rule_breakers()) {
    VirtualRobot robot(breaker.make());
    const BridgeReport report = checked(robot);
    EXPECT_FALSE(report.conforms()) << breaker.name;
    const auto failed = with(report, RuleVerdict::failed);
    EXPECT_TRUE(failed.contains(word_of(breaker.rule))) << breaker.name << "\n" << text(report);
    alone += failed.size() == 1 ? 1U : 0U;
    EXPECT_FALSE(robot.motors_on()) << breaker.name;
    EXPECT_EQ(robot.moved(), 0.0) << breaker.name;
  }
  EXPECT_GE(alone + 4, rule_breakers().size());
}

TEST(BridgeCheck, APressedStopButtonIsSaid) {
  VirtualRobot robot;
  robot.press_stop();
  const BridgeReport report = checked(robot);
  EXPECT_EQ(with(report, RuleVerdict::failed), (std::set<std::string_view>{"motors-on"}));
  EXPECT_NE(text(report).find("stop button"), std::string::npos);
}

/// Nobody is blamed for what this machine did late, and nobody conforms by it.
TEST(BridgeCheck, WhatAStallHidesIsNotTested) {
  constexpr std::int64_t kMillisecond = 1'000'000;
  int hidden = 0;
  for (std::int64_t at = 20; at < 2600; at += 20) {
    VirtualRobot robot;
    robot.stall(at * kMillisecond, 200 * kMillisecond);
    const BridgeReport report = checked(robot);
    EXPECT_FALSE(report.failed()) << "at " << at << " ms\n" << text(report);
    hidden += report.conforms() ? 0 : 1;
  }
  EXPECT_GT(hidden, 0);
}

TEST(BridgeCheck, RefusesWhatIsNotAboveZero) {
  VirtualRobot robot;
  drivers::BridgeCheckOptions options;
  options.watch = 0.0;
  EXPECT_FALSE(check_bridge(robot, options));
}

}  // namespace
}  // namespace mbk::validation
