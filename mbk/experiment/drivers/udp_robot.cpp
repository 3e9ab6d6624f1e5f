#include "mbk/experiment/drivers/udp_robot.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/realtime/clock.h"

namespace mbk::drivers {
namespace {

using realtime::monotonic_ns;

constexpr double kNap = 0.05;                     // [s]
constexpr double kLongestStall = 2.0;             // that is made up for [s]
constexpr std::int64_t kForget = 10'000'000'000;  // [ns]
constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;

}  // namespace

int UdpRobotLink::receive(UdpSocket& socket, std::span<std::byte> into, UdpAddress& from) noexcept {
  return socket.receive(into, from);
}

void UdpRobotLink::send(UdpSocket& socket, const StateDatagram& state, const UdpAddress& to) noexcept {
  socket.send(encode(state), to);
}

UdpRobot::UdpRobot(device::Device& robot, UdpSocket socket, double sample_time, UdpRobotLink& link)
    : robot_(&robot), link_(&link), socket_(std::move(socket)), sample_time_(sample_time) {
  state_.has_force = robot.facts().has_force;
  state_.has_acceleration = robot.facts().has_acceleration;
}

Result<UdpRobot> UdpRobot::create(device::Device& robot, const UdpAddress& local, double sample_time,
                                  UdpRobotLink* link) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  auto socket = MBK_TRY(UdpSocket::open(local));
  static UdpRobotLink straight;
  return UdpRobot(robot, std::move(socket), sample_time, link != nullptr ? *link : straight);
}

void UdpRobot::serve(const std::atomic<bool>& over, const std::atomic<bool>& stop_button) noexcept {
  realtime::WallClock clock(sample_time_);
  bool ticking = false;
  while (!over.load(std::memory_order_relaxed)) {
    stop_pressed_ = stop_button.load(std::memory_order_relaxed);
    if (!awake_ || obeyed_.lock_step) {
      ticking = false;
      if (socket_.wait(kNap)) take_all();
      continue;
    }
    if (!ticking) clock.start();
    ticking = true;
    const std::uint64_t missed_before = clock.missed();
    clock.wait();
    make_up(clock.missed() - missed_before);
    take_all();
    if (!awake_ || obeyed_.lock_step) continue;
    watch_time(monotonic_ns());
    advance();
    send();
  }
  obeyed_.enabled = false;
  advance();
}

void UdpRobot::take_all() noexcept {
  std::array<std::byte, 2 * kCommandBytes> bytes{};
  UdpAddress from;
  for (int i = 0; i < kMaxAtOnce; ++i) {
    const int size = link_->receive(socket_, bytes, from);
    if (size < 0) return;
    CommandDatagram came;
    if (decode(std::span(bytes).first(static_cast<std::size_t>(size)), came) != Refusal::none ||
        !came.command.allFinite()) {
      ++state_.rejected;
    } else if (came.greeting) {
      greet(came, from);
    } else {
      take(came, from);
    }
  }
}

void UdpRobot::greet(const CommandDatagram& came, const UdpAddress& from) noexcept {
  const bool again = awake_ && from == master_ && came.session == obeyed_.session;
  if (obeyed_.enabled && !state_.watchdog_expired && !again) {
    ++state_.rejected;
    return;
  }
  if (!again) {
    master_ = from;
    awake_ = true;
    obeyed_ = came;
    obeyed_.enabled = false;
    obeyed_.command.setZero();
    state_.session = came.session;
    state_.watchdog_expired = false;
    state_.enabled = false;
    heard_ = monotonic_ns();
  }
  if (obeyed_.sequence != came.sequence) return;  // a late copy of the greeting
  look();
  send();
}

void UdpRobot::take(const CommandDatagram& came, const UdpAddress& from) noexcept {
  if (!awake_ || from != master_ || came.session != obeyed_.session || came.sequence < obeyed_.sequence) {
    ++state_.rejected;
    return;
  }
  if (came.sequence > obeyed_.sequence) {
    heard_ = monotonic_ns();
    const bool lock_step = obeyed_.lock_step;
    obeyed_ = came;
    obeyed_.lock_step = lock_step;
    if (lock_step) advance();
  }
  if (obeyed_.lock_step) send();
}

/// What came while the program was held up is not known yet: nobody obeyed it.
void UdpRobot::make_up(std::uint64_t ticks) noexcept {
  const auto most = static_cast<std::uint64_t>(kLongestStall / sample_time_);
  const std::int64_t period = std::llround(1e9 * sample_time_), now = monotonic_ns();
  for (auto left = static_cast<std::int64_t>(std::min(ticks, most)); left > 0; --left) {
    watch_time(now - left * period);
    advance();
  }
}

void UdpRobot::watch_time(std::int64_t now) noexcept {
  const std::int64_t silent = now - heard_;
  if (obeyed_.enabled && silent > obeyed_.watchdog * kNanosecondsPerMillisecond) state_.watchdog_expired = true;
  if (silent > kForget) awake_ = false;
}

void UdpRobot::advance() noexcept {
  state_.enabled = obeyed_.enabled && !state_.watchdog_expired && !stop_pressed_;
  robot_->write({obeyed_.sequence, obeyed_.command, state_.enabled});
  look();
}

void UdpRobot::look() noexcept {
  robot_->read(seen_);
  state_.answered = obeyed_.sequence;
  state_.raw = {seen_.sequence, seen_.time, seen_.joint, seen_.force, seen_.acceleration, seen_.stop || stop_pressed_};
}

void UdpRobot::send() noexcept {
  link_->send(socket_, state_, master_);
}

}  // namespace mbk::drivers
