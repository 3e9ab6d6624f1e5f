#include "mbk/experiment/session/robot_check.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "mbk/experiment/session/live_check.h"

namespace mbk::session {
namespace {

using Verdict = Finding::Verdict;
using testing::HasSubstr;

constexpr const char* kExperiment =
    "[control]\nkind = \"position\"\n[perturbation]\nkind = \"none\"\n[device]\nkind = \"udp\"\n";

constexpr const char* kRobot =
    "[robot]\nd1_mm = 254\nd2_mm = 266.7\nhome_mm = [300, -50]\ntheta1_deg = [-55, 90]\ntheta2_deg = [0, 145]\n"
    "alpha_kg_m2 = [0.06929, 0.04217, 0.04416]\nviscous_Nms_per_rad = [0.0651, 0.07389]\ncoulomb_Nm = [0.114, 0.114]\n";

RobotSetup setup(const std::string& text) {
  auto read = read_robot_setup(text, "mine.toml");
  EXPECT_TRUE(read) << read.error().line();
  return read ? *read : RobotSetup{};
}

/// The first that holds these words.
Finding finding_with(const std::vector<Finding>& findings, const std::string& words) {
  for (const Finding& one : findings) {
    if (one.text.find(words) != std::string::npos) return one;
  }
  ADD_FAILURE() << "nothing says " << words;
  return {Verdict::fine, ""};
}

/// The verdict on what holds these words.
Verdict verdict(const std::vector<Finding>& findings, const std::string& words) {
  return finding_with(findings, words).verdict;
}

Verdict verdict(const std::string& text, const std::string& words) {
  return verdict(check_setup(setup(text)), words);
}

TEST(RobotCheck, TheThesissRobotIsFine) {
  EXPECT_EQ(worst(check_setup(setup(std::string(kRobot) + kExperiment))), Verdict::fine);
  EXPECT_EQ(worst(check_setup(setup("[robot]\nkind = \"planar\"\n"))), Verdict::fine);
}

TEST(RobotCheck, ARobotThatIsNotDescribedIsRefusedAndWhatIsAssumedIsListed) {
  const auto nothing = read_robot_setup(kExperiment, "mine.toml");
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().line(), HasSubstr("[robot]"));
  const std::string some = std::string("[robot]\nd1_mm = 300\nd2_mm = 280\n") + kExperiment;
  EXPECT_EQ(verdict(some, "home_mm, theta1_deg"), Verdict::doubtful);
  EXPECT_EQ(verdict(std::string(kRobot) + kExperiment + "[safety]\nlink_silence_ms = 400\n", "link_silence_ms = 400"),
            Verdict::doubtful);
  EXPECT_EQ(verdict(std::string(kRobot) + kExperiment + "[safety]\nlateness_ms = 0\n", "lateness_ms"),
            Verdict::doubtful);
}

TEST(RobotCheck, UnitsThatCannotBeMeantAreDoubted) {
  const std::string e = std::string(kRobot) + kExperiment, wires = e + "[device.wiring]\n";
  EXPECT_EQ(verdict("[robot]\nkind = \"planar\"\nd1_mm = 0.254\nd2_mm = 0.267\n", "0.254"), Verdict::doubtful);
  EXPECT_EQ(verdict("[robot]\nkind = \"planar\"\nalpha_kg_m2 = [69, 42, 44]\n", "alpha_kg_m2"), Verdict::doubtful);
  const auto impossible =
      read_robot_setup(std::string(kExperiment) + "[robot]\nalpha_kg_m2 = [0.07, 0.4, 0.04]\n", "mine.toml");
  ASSERT_FALSE(impossible);
  EXPECT_THAT(impossible.error().line(), HasSubstr("alpha_kg_m2"));
  EXPECT_EQ(verdict(wires + "torque_per_command_Nm = [100000, 1]\n", "torque_per_command_Nm"), Verdict::doubtful);
  EXPECT_EQ(verdict(wires + "force_gain_N_per_unit = [[1, 0], [0, 20]]\n", "force_gain_N_per_unit"), Verdict::doubtful);
  EXPECT_EQ(verdict(wires + "force_step = 0.1\n", "converter"), Verdict::doubtful);
  EXPECT_EQ(verdict(e + "watchdog_ms = 1\n", "watchdog"), Verdict::wrong);
  EXPECT_EQ(verdict(e + "watchdog_ms = 2000\n", "watchdog"), Verdict::doubtful);
  EXPECT_EQ(verdict(e + "has_force = false\n", "--force-source virtual"), Verdict::doubtful);
}

TEST(RobotCheck, ACountAtTheHandIsTheLargestSingularValue) {
  // With θ₁ = θ₂ the links stand at a right angle, and J's columns of lengths d₁ and d₂ too: σ₁ = d₂.
  const robot::Geometry g;
  const Eigen::Vector2d home = robot::hand_position(g, {0.5, 0.5});
  const RobotSetup s =
      setup(fmt::format("{}[device.wiring]\ncounts_per_turn = [100000, 100000]\n[robot]\nhome_mm = "
                        "[{:.9f}, {:.9f}]\n",
                        kExperiment, 1e3 * home[0], 1e3 * home[1]));
  const double count = 2.0 * 3.141592653589793 / 100000.0 * g.d2;
  std::string all;
  for (const Finding& one : check_setup(s)) all += one.text + "\n";
  EXPECT_THAT(all, HasSubstr(fmt::format(" {:.3g} µm", 1e6 * count)));
}

TEST(RobotCheck, HomeHasToBeReachedWithRoomToSpare) {
  const std::string home = std::string(kExperiment) + "[robot]\nhome_mm = ";
  EXPECT_EQ(verdict(home + "[900, 0]\n", "home"), Verdict::wrong);
  EXPECT_EQ(verdict(home + "[300, -50]\n[safety]\nworkspace_low_mm = [310, -100]\n", "home_mm"), Verdict::wrong);
  EXPECT_EQ(verdict(home + "[300, -50]\n[safety]\njoint_margin_deg = 40\n", "home_mm"), Verdict::wrong);
}

TEST(RobotCheck, OneFileIsReadAsWhatItIs) {
  EXPECT_FALSE(setup("[robot]\nkind = \"planar\"\n").has_device);
  const RobotSetup described = setup("[robot]\nkind = \"planar\"\nd1_mm = 300\n[device]\nkind = \"udp\"\nport = 7\n");
  EXPECT_TRUE(described.has_device);
  EXPECT_EQ(described.trial.robot.geometry.d1, 0.3);
  EXPECT_EQ(std::get<drivers::UdpOptions>(described.trial.device.kind).port, 7);
  const auto line = [](const std::string& text) {
    const auto read = read_robot_setup(text, "mine.toml");
    EXPECT_FALSE(read) << text;
    return read ? "" : read.error().line();
  };
  EXPECT_THAT(line("[robot]\nkind = \"planar\"\nd3_mm = 4\n"), HasSubstr("d3_mm"));
  EXPECT_THAT(line("[robot]\nkind = \"planar\"\n[device]\nkind = \"udp\"\nprot = 4\n"), HasSubstr("line 5"));
  EXPECT_THAT(line("[robot]\nkind = \"one_axis\"\nslides = true\n"), HasSubstr("mbk robot describe"));
}

TEST(Readings, AreMeanDeviationAndLongestStillness) {
  const std::vector<double> values = {1e6 + 1, 1e6 + 4, 1e6 + 4, 1e6 + 4, 1e6 - 1};
  Readings r;
  for (const double value : values) r.add(value);
  r.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(r.count, 5U);
  EXPECT_EQ(r.not_finite, 1U);
  EXPECT_NEAR(r.mean, 1e6 + 2.4, 1e-9);            // rounding of numbers near 10⁶
  EXPECT_NEAR(r.deviation, std::sqrt(5.3), 1e-6);  // Σ(x − 2.4)² = 21.2, over 4
  EXPECT_NEAR(r.step, std::sqrt((9.0 + 25.0) / 4.0), 1e-9);
  EXPECT_EQ(r.low, 1e6 - 1);
  EXPECT_EQ(r.high, 1e6 + 4);
  EXPECT_EQ(r.longest_still, 2U);
}

/// A robot that stands at home with some noise, and whatever a test does to it.
class Standing : public device::Device {
 public:
  explicit Standing(std::function<void(device::State&, std::uint64_t)> fault) : fault_(std::move(fault)) {
    facts_.keeps_time = false;  // a state for each read, however late this machine is
  }
  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  bool read(device::State& state) noexcept override {
    ++ticks_;
    const double noise = std::sin(12.9898 * static_cast<double>(ticks_));
    state.sequence = ticks_;
    state.time = 1e-3 * static_cast<double>(ticks_);
    state.joint = {0.8 + 1e-6 * noise, 0.5 - 1e-6 * noise};
    state.force = {0.1 * noise, -0.1 * noise};
    state.acceleration = {0.05 * noise, 0.05 * noise};
    fault_(state, ticks_);
    return true;
  }
  bool write(const device::Command& command) noexcept override {
    moved_ = moved_ || command.enabled || !command.torque.isZero();
    return true;
  }
  void stop() noexcept override { stopped_ = true; }
  [[nodiscard]] bool moved() const { return moved_; }
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  std::function<void(device::State&, std::uint64_t)> fault_;
  device::Facts facts_;
  std::uint64_t ticks_ = 0;
  bool moved_ = false, stopped_ = false;
};

std::vector<Finding> watched(std::function<void(device::State&, std::uint64_t)> fault) {
  Standing robot(std::move(fault));
  const auto record = watch_robot(robot, Hertz(1000.0), 0.4);
  EXPECT_TRUE(record);
  EXPECT_FALSE(robot.moved());
  EXPECT_TRUE(robot.stopped());
  std::vector<Finding> found = check_live(setup(std::string(kRobot) + kExperiment), robot.facts(), *record);
  std::erase_if(found, [](const Finding& one) { return one.text.find("machine") != std::string::npos; });
  return found;
}

TEST(LiveCheck, ARobotThatStandsStillIsFine) {
  EXPECT_EQ(worst(watched([](device::State& /*state*/, std::uint64_t /*tick*/) {})), Verdict::fine);
}

TEST(LiveCheck, FindsWhatIsWrong) {
  using device::State;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.force = {0.3, 0.3}; }), "force 1"), Verdict::doubtful);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.force *= 30.0; }), "shielding"), Verdict::doubtful);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.force[0] += 5.0; }), "force_offset"), Verdict::doubtful);
  EXPECT_EQ(verdict(watched([=](State& s, std::uint64_t t) {
                      if (t == 50) s.acceleration[1] = nan;
                    }),
                    "acceleration 2"),
            Verdict::wrong);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.joint[0] = -1.5; }), "encoder_sign"), Verdict::wrong);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t t) { s.joint[1] += t % 2 == 0 ? 0.003 : 0.0; }), "angles"),
            Verdict::doubtful);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.stop = true; }), "stop button"), Verdict::wrong);
  const Finding untouched = finding_with(watched([](State&, std::uint64_t) {}), "stop button");
  const Finding released = finding_with(watched([](State& s, std::uint64_t t) { s.stop = t == 7; }), "stop button");
  EXPECT_EQ(released.verdict, Verdict::fine);
  EXPECT_NE(released.text, untouched.text);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t) { s.time = 1.0; }), "clock"), Verdict::wrong);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t t) { s.sequence = 1 + t / 2; }), "rate_hz"), Verdict::wrong);
  EXPECT_EQ(verdict(watched([](State& s, std::uint64_t t) { s.sequence = 2 * t; }), "cable"), Verdict::doubtful);
  EXPECT_EQ(
      verdict(watched([](State& s, std::uint64_t t) { s.sequence = t < 100 ? t : std::max<std::uint64_t>(t, 130); }),
              "link_silence_ms"),
      Verdict::wrong);
}

}  // namespace
}  // namespace mbk::session
