#include "mbk/experiment/drivers/udp_device.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <thread>

#include "mbk/experiment/drivers/udp_robot.h"
#include "tests/support/allocations.h"

namespace mbk::drivers {
namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;
constexpr double kLong = 5.0;  // [s], longer than a loaded machine takes

/// A robot that says what the test wants it to say.
class Peer {
 public:
  Peer() : socket_(UdpSocket::open({kLoopback, 0}).value()) {}

  [[nodiscard]] UdpOptions options() const {
    UdpOptions options;
    options.port = socket_.local().port;
    options.answer_within = kLong;
    return options;
  }

  /// The next command that has come.
  CommandDatagram hear() {
    CommandDatagram command;
    std::array<std::byte, 200> bytes{};
    EXPECT_TRUE(socket_.wait(kLong));
    const int size = socket_.receive(bytes, mbk_);
    EXPECT_EQ(decode(std::span(bytes).first(static_cast<std::size_t>(std::max(size, 0))), command), Refusal::none);
    return command;
  }

  StateDatagram state(std::uint64_t sequence) {
    StateDatagram d;
    d.session = session_;
    d.answered = answered_;
    d.raw.sequence = sequence;
    d.raw.encoder = {static_cast<double>(sequence), -1.0};
    return d;
  }

  void say(std::span<const std::byte> bytes) { EXPECT_TRUE(socket_.send(bytes, mbk_)); }
  void say(const StateDatagram& d) { say(encode(d)); }
  void say(std::uint64_t sequence) { say(state(sequence)); }

  /// Answers the greeting of `device` with the state 10.
  Result<void> welcome(UdpDevice& device, const std::function<void(StateDatagram&)>& change = {}) {
    std::thread answering([&] {
      const CommandDatagram greeting = hear();
      EXPECT_TRUE(greeting.greeting);
      EXPECT_FALSE(greeting.enabled);
      session_ = greeting.session;
      answered_ = greeting.sequence;
      StateDatagram d = state(10);
      if (change) change(d);
      say(d);
    });
    auto started = device.start();
    answering.join();
    return started;
  }

  void obey(const CommandDatagram& command) { answered_ = command.sequence; }
  [[nodiscard]] const UdpAddress& mbk() const { return mbk_; }

 private:
  UdpSocket socket_;
  UdpAddress mbk_;
  std::uint32_t session_ = 0;
  std::uint64_t answered_ = 0;
};

/// Reads until a state with this number has come; what is sent over the loopback may take a moment.
device::State read_until(UdpDevice& device, std::uint64_t sequence) {
  device::State state;
  for (int i = 0; i < 5000 && state.sequence != sequence; ++i) {
    EXPECT_TRUE(device.read(state));
    if (state.sequence != sequence) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return state;
}

TEST(UdpDevice, BeginsWithTheStateOfTheHandshake) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  device::State state;
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.sequence, 10U);
  EXPECT_EQ(state.joint, Eigen::Vector2d(10.0, -1.0));
}

TEST(UdpDevice, ReadsAndCommandsThroughTheWiring) {
  Peer peer;
  Fittings fittings;
  fittings.wiring.radians_per_count = {1e-3, -1e-3};
  fittings.wiring.torque_per_command = {0.5, -2.0};
  auto device = UdpDevice::create(peer.options(), fittings).value();
  ASSERT_TRUE(peer.welcome(*device));
  device::State state;
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.joint, Eigen::Vector2d(1e-2, 1e-3));
  ASSERT_TRUE(device->write({0, {1.0, 1.0}, true}));
  const CommandDatagram command = peer.hear();
  EXPECT_EQ(command.command, Eigen::Vector2d(2.0, -0.5));
  EXPECT_TRUE(command.enabled);
  EXPECT_EQ(command.watchdog, 50U);
}

TEST(UdpDevice, KeepsAStopThatANewerStateNoLongerShows) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  StateDatagram pressed = peer.state(11);
  pressed.raw.stop = pressed.watchdog_expired = true;
  device::State state;
  ASSERT_TRUE(device->read(state));
  peer.say(pressed);
  peer.say(12);
  // Both wait in the socket, and one tick reads both.
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  state = read_until(*device, 12);
  EXPECT_TRUE(state.stop);
  EXPECT_TRUE(state.watchdog_expired);
  ASSERT_TRUE(device->read(state));
  EXPECT_FALSE(state.stop);
  EXPECT_FALSE(state.watchdog_expired);
}

TEST(UdpDevice, TakesTheNewestAndCountsWhatIsLostOldOrTwice) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  for (const std::uint64_t sequence : {11, 13, 12, 13, 16}) peer.say(sequence);
  read_until(*device, 16);
  EXPECT_EQ(device->counts().believed, 4U);
  EXPECT_EQ(device->counts().old, 2U);
  EXPECT_EQ(device->counts().lost, 3U);
}

TEST(UdpDevice, BelievesNothingThatIsBrokenOrOfAnotherSession) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  auto corrupt = encode(peer.state(11));
  corrupt[40] ^= std::byte{1};
  peer.say(corrupt);
  peer.say(std::span(corrupt).first(20));
  StateDatagram stranger = peer.state(12);
  ++stranger.session;
  peer.say(stranger);
  peer.say(13);
  read_until(*device, 13);
  EXPECT_EQ(device->counts().refused[static_cast<std::size_t>(Refusal::checksum)], 1U);
  EXPECT_EQ(device->counts().refused[static_cast<std::size_t>(Refusal::length)], 1U);
  EXPECT_EQ(device->counts().old, 1U);
  EXPECT_EQ(device->counts().believed, 2U);
}

TEST(UdpDevice, BelievesNobodyElse) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  UdpSocket foreign = UdpSocket::open({kLoopback, 0}).value();
  ASSERT_TRUE(foreign.send(encode(peer.state(99)), {kLoopback, peer.mbk().port}));
  peer.say(11);
  read_until(*device, 11);
  EXPECT_EQ(device->counts().foreign, 1U);
}

TEST(UdpDevice, PassesOnWhatTheRobotReportsOfItself) {
  Peer peer;
  Fittings fittings;
  fittings.wiring.torque_per_command = {0.5, -2.0};
  auto device = UdpDevice::create(peer.options(), fittings).value();
  ASSERT_TRUE(peer.welcome(*device));
  EXPECT_TRUE(device->facts().acknowledges);
  device::State state;
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.answered, 0U);  // the greeting does not count as a command
  EXPECT_EQ(state.motors, device::Motors::off);
  EXPECT_FALSE(state.drives_measure);

  ASSERT_TRUE(device->write({0, {1.0, 1.0}, true}));
  peer.obey(peer.hear());
  StateDatagram reported = peer.state(11);
  reported.version = 2;
  reported.enabled = reported.watchdog_expired = reported.drives_measure = true;
  reported.has_force = false;
  reported.measured = {1.0, 0.25};
  reported.fault = 17;
  peer.say(reported);
  state = read_until(*device, 11);
  EXPECT_EQ(state.answered, 1U);
  EXPECT_EQ(state.motors, device::Motors::on);
  EXPECT_TRUE(state.watchdog_expired);
  EXPECT_FALSE(state.has_force);
  EXPECT_TRUE(state.has_acceleration);
  EXPECT_TRUE(state.drives_measure);
  EXPECT_EQ(state.drive_torque, Eigen::Vector2d(0.5, -0.5));
  EXPECT_EQ(state.fault, 17U);
}

TEST(UdpDevice, RefusesARobotWhoseMotorsAreOnBeforeAnyCommand) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  const auto refused = peer.welcome(*device, [](StateDatagram& d) { d.enabled = true; });
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("motors"), std::string::npos) << refused.error().line();
}

TEST(UdpDevice, StopsSeveralTimes) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  device->write({0, {1.0, 1.0}, true});
  device->stop();
  EXPECT_TRUE(peer.hear().enabled);
  for (int i = 0; i < 3; ++i) {
    const CommandDatagram command = peer.hear();
    EXPECT_FALSE(command.enabled);
    EXPECT_EQ(command.command, Eigen::Vector2d(0.0, 0.0));
  }
}

TEST(UdpDevice, ItsLastWordsAreBelievedAndNothingAfterThem) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  device->emergency_off();  // before it is connected there is nobody to tell
  ASSERT_TRUE(peer.welcome(*device));
  ASSERT_TRUE(device->write({1, {1.0, 2.0}, true}));
  const CommandDatagram driven = peer.hear();
  EXPECT_TRUE(driven.enabled);
  const long before = testing_support::allocations();
  device->emergency_off();
  EXPECT_EQ(testing_support::allocations(), before);
  ASSERT_TRUE(device->write({2, {1.0, 2.0}, true}));  // the loop, in another thread of the dying program
  std::uint64_t last = 0;
  for (int i = 0; i < 5; ++i) {
    const CommandDatagram off = peer.hear();
    EXPECT_EQ(off.session, driven.session);
    EXPECT_FALSE(off.enabled);
    EXPECT_FALSE(off.greeting);
    EXPECT_EQ(off.command, Eigen::Vector2d(0.0, 0.0));
    EXPECT_GT(off.sequence, driven.sequence + 1'000'000'000'000U);
    EXPECT_EQ(static_cast<std::uint64_t>(static_cast<double>(off.sequence)), off.sequence);
    EXPECT_GT(static_cast<std::int32_t>(off.sequence), static_cast<std::int32_t>(driven.sequence));
    last = off.sequence;
  }
  EXPECT_LT(peer.hear().sequence, last);
}

TEST(UdpDevice, AsksAgainInLockStepWhereACommandIsLost) {
  Peer peer;
  UdpOptions options = peer.options();
  options.lock_step = true;
  auto device = UdpDevice::create(options, {}).value();
  EXPECT_FALSE(device->facts().keeps_time);
  ASSERT_TRUE(peer.welcome(*device));
  ASSERT_TRUE(device->write({0, {1.0, 1.0}, true}));
  std::thread deaf([&] {
    const CommandDatagram first = peer.hear(), again = peer.hear();
    EXPECT_EQ(first.sequence, again.sequence);
    peer.obey(again);
    peer.say(11);
  });
  device::State state;
  EXPECT_TRUE(device->read(state));
  deaf.join();
  EXPECT_EQ(state.sequence, 11U);
  EXPECT_GE(device->counts().repeated, 1U);
}

TEST(UdpDevice, GivesUpInLockStepOnce) {
  Peer peer;
  UdpOptions options = peer.options();
  options.lock_step = true;
  options.answer_within = 1.0;
  auto device = UdpDevice::create(options, {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  device->write({0, {1.0, 1.0}, true});
  device::State state;
  EXPECT_FALSE(device->read(state));
  const std::uint64_t repeated = device->counts().repeated;
  EXPECT_GT(repeated, 0U);
  EXPECT_FALSE(device->write({1, {1.0, 1.0}, true}));
  EXPECT_FALSE(device->read(state));
  EXPECT_EQ(device->counts().repeated, repeated);
}

TEST(UdpDevice, RefusesLockStepOfARobotThatSendsByItself) {
  Peer peer;
  UdpOptions options = peer.options();
  options.lock_step = true;
  auto device = UdpDevice::create(options, {}).value();
  std::atomic<bool> over{false};
  std::thread sending;
  const auto started = peer.welcome(*device, [&](StateDatagram&) {
    sending = std::thread([&] {
      for (std::uint64_t number = 11; !over; ++number) {
        peer.say(number);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  });
  over = true;
  sending.join();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().line().find("lock_step"), std::string::npos) << started.error().line();
}

TEST(UdpDevice, NamesWhatCameInsteadOfAnAnswer) {
  Peer peer;
  UdpOptions options = peer.options();
  options.answer_within = 0.2;
  auto device = UdpDevice::create(options, {}).value();
  const auto silent = device->start();
  ASSERT_FALSE(silent);
  EXPECT_NE(silent.error().line().find("0.2 s"), std::string::npos) << silent.error().line();
  EXPECT_NE(silent.error().line().find("firewall"), std::string::npos);
  options.answer_within = 1.0;
  Peer second;
  options.port = second.options().port;
  auto other = UdpDevice::create(options, {}).value();
  std::thread talking([&] {
    second.hear();
    auto newer = encode(second.state(1));
    newer[4] = std::byte{9};
    second.say(newer);
  });
  const auto refused = other->start();
  talking.join();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("version"), std::string::npos) << refused.error().line();
}

TEST(UdpDevice, RefusesARobotWithOtherSensors) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  const auto started = peer.welcome(*device, [](StateDatagram& d) { d.has_force = false; });
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().line().find("has_force"), std::string::npos);
}

TEST(UdpDevice, RefusesOptionsThatCannotBeMeant) {
  UdpOptions options;
  options.port = 0;
  EXPECT_FALSE(UdpDevice::create(options, {}));
  options = {};
  options.watchdog = 60.0;
  EXPECT_FALSE(UdpDevice::create(options, {}));
  options.watchdog = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(UdpDevice::create(options, {}));
  options = {};
  options.address = "no.such.robot.invalid";
  EXPECT_FALSE(UdpDevice::create(options, {}).value()->start());
}

TEST(UdpDevice, DoesNotAllocateWhileItRuns) {
  Peer peer;
  auto device = UdpDevice::create(peer.options(), {}).value();
  ASSERT_TRUE(peer.welcome(*device));
  device::State state;
  const long before = testing_support::allocations();
  for (std::uint64_t i = 0; i < 100; ++i) {
    peer.say(11 + i);
    device->read(state);
    device->write({i, {1.0, 1.0}, true});
  }
  EXPECT_EQ(testing_support::allocations(), before);
}

/// Adds up what it is commanded while its motors are on.
class Adding : public device::Device {
 public:
  Adding() {
    facts_.name = "adding";
    facts_.keeps_time = false;
  }
  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  bool read(device::State& state) noexcept override {
    state.sequence = steps_ + 1;
    state.joint = sum_;
    return true;
  }
  bool write(const device::Command& command) noexcept override {
    ++steps_;
    if (steps_ == held_up_at_) std::this_thread::sleep_for(kHeldUp);
    if (command.enabled) sum_ += command.torque;
    enabled_ = command.enabled;
    return true;
  }
  void stop() noexcept override {}
  [[nodiscard]] bool enabled() const { return enabled_; }

  /// The thread that serves it once gets no processor for so long.
  static constexpr std::chrono::milliseconds kHeldUp{300};
  void hold_up_at(std::uint64_t step) { held_up_at_ = step; }

 private:
  device::Facts facts_;
  std::atomic<std::uint64_t> held_up_at_{0};
  std::uint64_t steps_ = 0;
  Eigen::Vector2d sum_ = {0.0, 0.0};
  std::atomic<bool> enabled_{false};
};

/// A UdpRobot on a thread of its own.
class Serving {
 public:
  Serving()
      : robot_(UdpRobot::create(adding_, {kLoopback, 0}, 1e-3).value()),
        thread_([this] { robot_.serve(over_, stop_button_); }) {}
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  ~Serving() { end(); }
  void end() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] std::unique_ptr<UdpDevice> device(bool lock_step, double watchdog = 10.0,
                                                  double answer_within = kLong) const {
    UdpOptions options;
    options.port = robot_.local().port;
    options.lock_step = lock_step;
    options.watchdog = watchdog;
    options.answer_within = answer_within;
    return UdpDevice::create(options, {}).value();
  }
  void press(bool pressed) { stop_button_ = pressed; }
  [[nodiscard]] const Adding& adding() const { return adding_; }
  void hold_up_at(std::uint64_t step) { adding_.hold_up_at(step); }

 private:
  Adding adding_;
  std::atomic<bool> over_{false}, stop_button_{false};
  UdpRobot robot_;
  std::thread thread_;
};

/// Reads until the newest state satisfies `done`, at most kLong.   @returns  whether it did
bool soon(UdpDevice& device, const std::function<bool(const StateDatagram&)>& done) {
  device::State state;
  for (int i = 0; i < static_cast<int>(1e3 * kLong); ++i) {
    const bool fine = device.read(state);
    if (done(device.newest()) && fine) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(UdpRobot, GoesStepByStepWithLockStep) {
  const Serving serving;
  auto device = serving.device(true);
  ASSERT_TRUE(device->start());
  device::State state;
  for (std::uint64_t i = 0; i < 500; ++i) {
    ASSERT_TRUE(device->read(state));
    ASSERT_EQ(state.sequence, i + 1);
    ASSERT_EQ(state.joint, Eigen::Vector2d(i, -2.0 * static_cast<double>(i)));
    ASSERT_TRUE(device->write({i, {1.0, -2.0}, true}));
  }
  device->stop();
  EXPECT_EQ(device->counts().old + device->counts().foreign + device->counts().lost, 0U);
}

TEST(UdpRobot, RunsByItsOwnClockAndObeysTheNewestCommand) {
  const Serving serving;
  auto device = serving.device(false);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return d.raw.encoder[0] > 20.0 && d.enabled; }));
  device->stop();
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return !d.enabled; }));
}

TEST(UdpRobot, SwitchesItsMotorsOffUntilTheNextGreetingWhereNoCommandComes) {
  const Serving serving;
  auto device = serving.device(false, 0.02);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return d.watchdog_expired && !d.enabled; }));
  EXPECT_FALSE(serving.adding().enabled());
  device->write({1, {1.0, 0.0}, true});
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return d.answered == 3 && !d.enabled; }));
  device->stop();
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return d.answered == 4; }));
  ASSERT_TRUE(device->start());
  device::State state;
  EXPECT_TRUE(device->read(state));
}

/// The program that drove it was killed: nobody says goodbye.
TEST(UdpRobot, TakesTheNextGreetingAfterItsWatchdogHasExpired) {
  const Serving serving;
  auto device = serving.device(false, 0.02);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  ASSERT_TRUE(soon(*device, [](const StateDatagram& d) { return d.watchdog_expired && !d.enabled; }));
  auto next = serving.device(false);
  ASSERT_TRUE(next->start());
  EXPECT_FALSE(next->newest().watchdog_expired || next->newest().enabled);
}

TEST(UdpRobot, ObeysNobodyElseWhileItsMotorsAreOn) {
  const Serving serving;
  auto device = serving.device(false), other = serving.device(false, 10.0, 0.3);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  ASSERT_TRUE(soon(*device, [](const StateDatagram& d) { return d.enabled; }));
  EXPECT_FALSE(other->start());
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return d.rejected > 0 && d.enabled; }));
  device->stop();
  ASSERT_TRUE(soon(*device, [](const StateDatagram& d) { return !d.enabled; }));
  EXPECT_TRUE(serving.device(false)->start());
}

TEST(UdpRobot, SwitchesItsMotorsOffWithItsStopButton) {
  Serving serving;
  auto device = serving.device(false);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  ASSERT_TRUE(soon(*device, [](const StateDatagram& d) { return d.enabled && !d.raw.stop; }));
  serving.press(true);
  EXPECT_TRUE(soon(*device, [](const StateDatagram& d) { return !d.enabled && d.raw.stop; }));
}

TEST(UdpRobot, MovesOnWhileItsProgramIsHeldUp) {
  Serving serving;
  serving.hold_up_at(50);
  auto device = serving.device(false);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  // 300 ticks less what it sleeps late: those that nobody heard of
  EXPECT_TRUE(
      soon(*device, [&](const StateDatagram& d) { return d.raw.sequence > 300 && device->counts().lost >= 250; }));
  EXPECT_GT(device->newest().raw.encoder[0], 250.0);  // under the last command
}

TEST(UdpRobot, SwitchesItsMotorsOffWhileItsProgramIsHeldUp) {
  Serving serving;
  serving.hold_up_at(50);
  auto device = serving.device(false, 0.1);
  ASSERT_TRUE(device->start());
  const auto go_on = [&, tick = std::uint64_t{0}](const StateDatagram& d) mutable {
    device->write({tick++, {1.0, 0.0}, true});
    return d.watchdog_expired;
  };
  EXPECT_TRUE(soon(*device, go_on));
  EXPECT_LT(device->newest().raw.encoder[0], 50.0 + 150.0);  // the watchdog's time and what it was driven before
}

/// Loses every other state, and says of each that the robot has a fault.
class Spoiling : public UdpRobotLink {
 public:
  void send(UdpSocket& socket, const StateDatagram& state, const UdpAddress& to) noexcept override {
    StateDatagram spoiled = state;
    spoiled.version = 2;
    spoiled.fault = 9;
    if (++sent_ % 2 == 1) UdpRobotLink::send(socket, spoiled, to);
  }

 private:
  int sent_ = 0;
};

TEST(UdpRobot, SendsThroughTheLinkThatItIsGiven) {
  Adding adding;
  Spoiling link;
  UdpRobot robot = UdpRobot::create(adding, {kLoopback, 0}, 1e-3, &link).value();
  std::atomic<bool> over{false};
  const std::atomic<bool> button{false};
  std::thread serving([&] { robot.serve(over, button); });
  UdpOptions options;
  options.port = robot.local().port;
  options.answer_within = kLong;
  auto device = UdpDevice::create(options, {}).value();
  EXPECT_TRUE(device->start());
  EXPECT_TRUE(soon(*device, [&](const StateDatagram& d) { return d.fault == 9 && device->counts().lost >= 20; }));
  over = true;
  serving.join();
}

TEST(UdpRobot, LeavesItsMotorsOff) {
  Serving serving;
  auto device = serving.device(false);
  ASSERT_TRUE(device->start());
  device->write({0, {1.0, 0.0}, true});
  ASSERT_TRUE(soon(*device, [](const StateDatagram& d) { return d.enabled; }));
  serving.end();
  EXPECT_FALSE(serving.adding().enabled());
}

TEST(UdpRobot, RefusesAPortThatIsTaken) {
  Adding adding;
  const auto first = UdpRobot::create(adding, {kLoopback, 0}, 1e-3);
  ASSERT_TRUE(first);
  const auto second = UdpRobot::create(adding, first->local(), 1e-3);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().line().find("Address already in use"), std::string::npos);
}

}  // namespace
}  // namespace mbk::drivers
