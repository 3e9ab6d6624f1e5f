#include "mbk/validate/misbehaving_robot.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <string>
#include <thread>

#include "mbk/experiment/drivers/udp_device.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/simulate/laboratory/find_scenario.h"
#include "mbk/validate/udp_fault_kinds.h"

namespace mbk::validation {
namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;

TEST(UdpFaults, AreOfManyKindsEachWithAMechanismAndKnownReasons) {
  std::set<std::string_view> names, codes;
  for (int i = 0; i < safety::kReasons; ++i) codes.insert(word_of(static_cast<safety::Reason>(i)));
  for (const UdpFaultKind& kind : udp_fault_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_EQ(find_udp_fault(kind.name), &kind);
    for (const std::string_view reason : kind.reasons) EXPECT_TRUE(codes.contains(reason)) << kind.name << reason;
    EXPECT_EQ(kind.expected == Expected::trip, kind.detection[0] > 0 && kind.detection[1] > 0) << kind.name;
    EXPECT_FALSE(kind.expected == Expected::not_detected && kind.bound.empty()) << kind.name;
    RobotFault fault;
    numeric::Random random(3);
    kind.make(fault, random);
    EXPECT_TRUE(fault.drive || fault.sense || fault.say || fault.hear || fault.to_robot || fault.from_robot ||
                fault.second_robot || fault.gone != 0)
        << kind.name;
  }
  EXPECT_GE(names.size(), 40U);
  EXPECT_EQ(find_udp_fault("no such fault"), nullptr);
}

/// A robot with a fault on a thread of its own, and a device that commands it.
class Misbehaving : public testing::Test {
 protected:
  void begin(const std::string& name, double moment = 0.02) {
    numeric::Random random(1);
    RobotFault fault;
    const UdpFaultKind* kind = find_udp_fault(name);
    ASSERT_NE(kind, nullptr);
    kind->make(fault, random);
    MisbehavingRobot::Options options;
    options.local = {kLoopback, 0};
    options.moment = moment;
    options.version = kind->version;
    auto made = MisbehavingRobot::create(*simulated_, fault, options);
    ASSERT_TRUE(made) << made.error().line();
    robot_ = std::move(*made);
    thread_ = std::thread([this] { robot_->serve(); });
    drivers::UdpOptions link;
    link.port = robot_->local().port;
    link.watchdog = 5.0;
    device_ = drivers::UdpDevice::create(link, {}).value();
    ASSERT_TRUE(device_->start());
  }

  /// Commands this for so many ticks, or until it is `done`.
  template <class Done>
  bool drive(const Vector2d& torque, bool on, int ticks, const Done& done) {
    device::State state;
    for (int i = 0; i < ticks; ++i) {
      device_->read(state);
      if (done(device_->newest())) return true;
      device_->write({tick_++, torque, on});
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  const RobotTruth& end() {
    robot_->end();
    if (thread_.joinable()) thread_.join();
    return robot_->truth();
  }
  void TearDown() override {
    if (robot_) end();
  }

  static constexpr auto kNever = [](const drivers::StateDatagram&) { return false; };
  const Vector2d torque_ = {0.6, -0.4};
  std::unique_ptr<laboratory::SimulatedDevice> simulated_ =
      laboratory::SimulatedDevice::create(laboratory::find_scenario("relaxed_sinusoidal", "").value()).value();
  std::unique_ptr<MisbehavingRobot> robot_;
  std::unique_ptr<drivers::UdpDevice> device_;
  std::thread thread_;
  std::uint64_t tick_ = 0;
};

TEST_F(Misbehaving, LatchedDrivesGoOnAndTheTruthSaysSo) {
  begin("latched-says-off");
  EXPECT_TRUE(drive(torque_, true, 5000, [](const drivers::StateDatagram& d) { return d.raw.sequence > 100; }));
  drive({0.0, 0.0}, false, 50, kNever);
  EXPECT_FALSE(device_->newest().enabled);  // a lie
  const RobotTruth& truth = end();
  EXPECT_GE(truth.fault_began, truth.motors_on + 20);
  EXPECT_GT(truth.told_off, truth.fault_began);
  EXPECT_FALSE(truth.off());
  EXPECT_GT(truth.speed, 0.0);
}

TEST_F(Misbehaving, TheTruthSaysWhenTheTorqueEnds) {
  begin("says-off-drives");
  EXPECT_TRUE(drive(torque_, true, 5000, [](const drivers::StateDatagram& d) { return d.raw.sequence > 100; }));
  EXPECT_FALSE(device_->newest().enabled);  // a lie
  drive({0.0, 0.0}, false, 50, kNever);
  const RobotTruth& truth = end();
  EXPECT_TRUE(truth.off());
  EXPECT_GE(truth.torque_off, truth.told_off);
  EXPECT_GE(truth.told_off, 100);
}

TEST_F(Misbehaving, StatesGrowOldOnTheirWay) {
  begin("states-age");
  const auto behind = [&](const drivers::StateDatagram& d) { return tick_ > d.answered + 25; };
  EXPECT_TRUE(drive(torque_, true, 5000, behind));
}

TEST_F(Misbehaving, VersionTwoSaysWhatTheDrivesDo) {
  begin("drives-dead-measured", 1.0);
  EXPECT_TRUE(drive(torque_, true, 5000, [&](const drivers::StateDatagram& d) {
    return d.version == 2 && d.drives_measure && d.measured == torque_;
  }));
  EXPECT_TRUE(drive(torque_, true, 5000, [&](const drivers::StateDatagram& d) { return d.measured.isZero(0.0); }));
}

TEST_F(Misbehaving, AProgramThatDiesComesBackWithoutItsSession) {
  begin("dies-and-returns");
  drive(torque_, true, 5000, [](const drivers::StateDatagram& d) { return d.raw.sequence > 15; });
  // while it is gone, and after it: its new states are nobody's
  std::uint64_t last = 0;
  int silent = 0;
  EXPECT_TRUE(drive(torque_, true, 5000, [&](const drivers::StateDatagram& d) {
    silent = d.raw.sequence == last ? silent + 1 : 0;
    last = d.raw.sequence;
    return silent > 400;
  }));
  EXPECT_TRUE(end().off());
}

TEST(MisbehavingRobot, RefusesWhatCannotBeMeant) {
  auto robot = laboratory::SimulatedDevice::create(laboratory::find_scenario("relaxed_sinusoidal", "").value()).value();
  MisbehavingRobot::Options options;
  options.local = {kLoopback, 0};
  options.moment = -1.0;
  EXPECT_FALSE(MisbehavingRobot::create(*robot, {}, options));
  options.moment = 1.0;
  options.version = 3;
  EXPECT_FALSE(MisbehavingRobot::create(*robot, {}, options));
}

}  // namespace
}  // namespace mbk::validation
