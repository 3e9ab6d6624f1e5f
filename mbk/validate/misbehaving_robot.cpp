#include "mbk/validate/misbehaving_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/realtime/clock.h"
#include "mbk/base/realtime/thread_setup.h"

namespace mbk::validation {
namespace {

using drivers::CommandDatagram;
using drivers::StateDatagram;
using drivers::UdpAddress;
using drivers::UdpSocket;

constexpr int kNotYet = -1;
constexpr std::int64_t kStall = 5;  // ticks in a row

}  // namespace

/// The simulated robot, with sensors and motors that the fault spoils.
class MisbehavingRobot::Drives : public device::Device {
 public:
  Drives(MisbehavingRobot& all, laboratory::SimulatedDevice& robot) : all_(&all), robot_(&robot) {}

  [[nodiscard]] const device::Facts& facts() const override { return robot_->facts(); }
  [[nodiscard]] Result<void> start() override { return robot_->start(); }
  void stop() noexcept override { robot_->stop(); }

  bool read(device::State& state) noexcept override {
    robot_->read(state);
    state.sequence -= begin_;
    state.time -= begin_time_;
    if (const int k = all_->since(); k >= 0 && all_->fault_.sense) all_->fault_.sense(state, k);
    return true;
  }

  bool write(const device::Command& command) noexcept override {
    RobotTruth& truth = all_->truth_;
    if (all_->ended_) return true;  // whoever ends the program is no part of what happened
    const Vector2d told = command.enabled ? command.torque : Vector2d::Zero();
    if (command.enabled && truth.motors_on < 0) {
      truth.motors_on = truth.ticks;
      all_->say("motors on");
    }
    if (command.enabled && all_->due() && told.cwiseAbs().maxCoeff() >= all_->fault_.min_torque) all_->begin_fault();
    const int k = all_->since();
    acts_ = k >= 0 && all_->fault_.drive ? all_->fault_.drive(told, k) : told;
    robot_->write({command.tick, acts_, true});
    ++truth.ticks;
    watch();
    return true;
  }

  /// A program that begins anew counts its samples and its time from the beginning.
  void begin_anew() {
    device::State state;
    robot_->read(state);
    begin_ = state.sequence - 1;
    begin_time_ = state.time;
  }

  /// The torque that acts, as perfect drives measure it [N·m].
  [[nodiscard]] const Vector2d& acts() const { return acts_; }

 private:
  void watch() {
    RobotTruth& truth = all_->truth_;
    if (truth.motors_on < 0) return;
    const bool off = acts_.isZero(0.0);
    if (off != truth.off()) {
      truth.torque_off = off ? truth.ticks - 1 : -1;
      all_->say(off ? "torque off" : "torque on");
    }
    if (truth.fault_began < 0) return;
    const laboratory::TrueState<2>& now = robot_->truth();
    truth.speed = std::max(truth.speed, now.velocity.norm());
    truth.force = std::max(truth.force, now.force_hand_on_robot.norm());
  }

  MisbehavingRobot* all_;
  laboratory::SimulatedDevice* robot_;
  Vector2d acts_ = {0.0, 0.0};
  std::uint64_t begin_ = 0;
  double begin_time_ = 0.0;
};

/// The wire, and what the robot's program hears and says.
class MisbehavingRobot::Link : public drivers::UdpRobotLink {
 public:
  Link(MisbehavingRobot& all, std::optional<UdpSocket> elsewhere)
      : all_(&all), random_(all.options_.seed, 1), elsewhere_(std::move(elsewhere)) {}

  int receive(UdpSocket& socket, std::span<std::byte> into, UdpAddress& from) noexcept override {
    take_all(socket);
    const auto next = std::ranges::find_if(came_, [this](const Came& one) { return one.due <= now(); });
    if (next == came_.end()) return -1;
    const std::size_t size = std::min(into.size(), next->size);
    std::copy_n(next->bytes.begin(), size, into.begin());
    from = next->from;
    came_.erase(next);
    return static_cast<int>(size);
  }

  void send(UdpSocket& socket, const StateDatagram& state, const UdpAddress& to) noexcept override {
    note_stall();
    StateDatagram said = state;
    said.version = all_->options_.version;
    said.drives_measure = said.version >= 2;
    said.measured = all_->drives_->acts();
    const int k = all_->since();
    const RobotFault& fault = all_->fault_;
    if (k >= 0 && fault.say) fault.say(said, k);
    const Passage passage = k >= 0 && fault.from_robot ? fault.from_robot(k) : Passage{};
    for (int i = 0; i < passage.copies; ++i) {
      leaving_.push_back({now() + passage.delay, passage.damaged ? damaged(encode(said)) : encode(said)});
    }
    for (auto one = leaving_.begin(); one != leaving_.end();) {
      if (one->due > now()) {
        ++one;
        continue;
      }
      socket.send(one->bytes, to);
      one = leaving_.erase(one);
    }
    if (k >= 0 && fault.second_robot) {
      StateDatagram other = state;
      fault.second_robot(other, k);
      (elsewhere_ ? *elsewhere_ : socket).send(encode(other), to);
    }
    if (k >= 0 && fault.gone != 0 && !was_gone_) {
      was_gone_ = true;
      all_->leaves_ = true;
    }
  }

  /// Nothing that was on its way comes through.
  void drop_all() {
    came_.clear();
    leaving_.clear();
  }

 private:
  struct Came {
    std::int64_t due;
    std::array<std::byte, 2 * drivers::kCommandBytes> bytes;
    std::size_t size;
    UdpAddress from;
  };
  struct Leaving {
    std::int64_t due;
    drivers::StateBytes bytes;
  };

  [[nodiscard]] std::int64_t now() const { return all_->truth_.ticks; }

  void take_all(UdpSocket& socket) {
    Came one{};
    for (int size = 0; (size = socket.receive(one.bytes, one.from)) >= 0;) {
      one.size = static_cast<std::size_t>(size);
      CommandDatagram command;
      const bool whole = decode(std::span(one.bytes).first(one.size), command) == drivers::Refusal::none;
      if (whole) note(command);
      const int k = all_->since();
      const RobotFault& fault = all_->fault_;
      const Passage passage = k >= 0 && fault.to_robot ? fault.to_robot(k) : Passage{};
      if (whole && k >= 0 && fault.hear) {
        fault.hear(command, k);
        std::ranges::copy(encode(command), one.bytes.begin());
      }
      if (passage.damaged) one.bytes[random_.below(one.size)] ^= std::byte{1};
      one.due = now() + passage.delay;
      for (int i = 0; i < passage.copies; ++i) came_.push_back(one);
    }
  }

  void note(const CommandDatagram& command) {
    RobotTruth& truth = all_->truth_;
    truth.last_command = truth.ticks;
    if (command.greeting) {
      all_->say("greeting");
      if (all_->fault_.begins == RobotFault::Begins::at_greeting && all_->since() < 0) all_->begin_fault();
      return;
    }
    if (command.enabled || truth.motors_on < 0) return;
    if (all_->fault_.begins == RobotFault::Begins::at_stop && all_->since() < 0 && all_->moment_is_over()) {
      all_->begin_fault();
    }
    if (truth.told_off < 0 && all_->since() >= 0) {
      truth.told_off = truth.ticks;
      all_->say("told off");
    }
  }

  void note_stall() {
    RobotTruth& truth = all_->truth_;
    const std::int64_t missed = sent_ < 0 ? 0 : now() - sent_ - 1;
    sent_ = now();
    if (missed <= 0) return;
    truth.missed += missed;
    if (missed < kStall) return;
    truth.stalled = missed;
    all_->say("stall");
  }

  drivers::StateBytes damaged(drivers::StateBytes bytes) {
    bytes[random_.below(bytes.size())] ^= static_cast<std::byte>(1U << random_.below(8));
    return bytes;
  }

  MisbehavingRobot* all_;
  numeric::Random random_;
  std::optional<UdpSocket> elsewhere_;
  std::deque<Came> came_;
  std::deque<Leaving> leaving_;
  std::int64_t sent_ = -1;
  bool was_gone_ = false;
};

MisbehavingRobot::MisbehavingRobot(laboratory::SimulatedDevice& robot, RobotFault fault, const Options& options,
                                   Watch watch)
    : fault_(std::move(fault)),
      options_(options),
      watch_(std::move(watch)),
      drives_(std::make_unique<Drives>(*this, robot)) {}

MisbehavingRobot::~MisbehavingRobot() = default;

Result<std::unique_ptr<MisbehavingRobot>> MisbehavingRobot::create(laboratory::SimulatedDevice& robot, RobotFault fault,
                                                                   const Options& options, Watch watch) {
  if (!(options.moment >= 0.0 && std::isfinite(options.moment))) {
    return bad_usage(fmt::format("the fault begins at {:g} s, which is not at or after 0 s", options.moment));
  }
  if (options.version < 1 || options.version > drivers::kNewestStateVersion) {
    return bad_usage(fmt::format("there is no version {} of a state", options.version),
                     fmt::format("take 1 to {}", drivers::kNewestStateVersion));
  }
  std::unique_ptr<MisbehavingRobot> made(new MisbehavingRobot(robot, std::move(fault), options, std::move(watch)));
  std::optional<UdpSocket> elsewhere;
  if (made->fault_.elsewhere) {
    auto socket = UdpSocket::open({options.local.host, 0});
    if (!socket) return tl::unexpected(socket.error());
    elsewhere = std::move(*socket);
  }
  made->link_ = std::make_unique<Link>(*made, std::move(elsewhere));
  auto served =
      MBK_TRY(drivers::UdpRobot::create(*made->drives_, options.local, options.sample_time, made->link_.get()));
  made->robot_ = std::move(served);
  made->local_ = made->robot_->local();
  return made;
}

void MisbehavingRobot::end() noexcept {
  ended_ = true;
  leaves_ = true;
}

void MisbehavingRobot::serve() {
  (void)realtime::prepare_thread();  // where that is refused it is held up more often, and says so
  const std::atomic<bool> no_button{false};
  for (;;) {
    robot_->serve(leaves_, no_button);
    leaves_ = false;
    if (ended_) return;
    be_gone();
    if (ended_) return;
  }
}

/// The motors have no torque where nobody commands them.
void MisbehavingRobot::be_gone() {
  robot_.reset();
  link_->drop_all();
  say("gone");
  realtime::WallClock clock(options_.sample_time);
  clock.start();
  std::uint64_t passed = 0;
  for (std::int64_t tick = 0; !ended_ && (fault_.gone < 0 || tick < fault_.gone);) {
    clock.wait();
    for (const std::uint64_t until = clock.missed() + ++passed; std::cmp_less(tick, until); ++tick) {
      drives_->write({});
    }
  }
  if (ended_) return;
  drives_->begin_anew();
  if (auto served = drivers::UdpRobot::create(*drives_, local_, options_.sample_time, link_.get())) {
    robot_ = std::move(*served);
    say("back");
  } else {
    end();
  }
}

int MisbehavingRobot::since() const {
  if (truth_.fault_began < 0) return kNotYet;
  return static_cast<int>(std::min<std::int64_t>(truth_.ticks - truth_.fault_began, std::numeric_limits<int>::max()));
}

bool MisbehavingRobot::moment_is_over() const {
  return truth_.motors_on >= 0 &&
         static_cast<double>(truth_.ticks - truth_.motors_on) * options_.sample_time >= options_.moment;
}

bool MisbehavingRobot::due() const {
  return truth_.fault_began < 0 && fault_.begins == RobotFault::Begins::at_moment && moment_is_over();
}

void MisbehavingRobot::begin_fault() {
  truth_.fault_began = truth_.ticks;
  say("fault");
}

void MisbehavingRobot::say(std::string_view event) const {
  if (watch_) watch_(event, truth_);
}

}  // namespace mbk::validation
