#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <map>
#include <mutex>
#include <random>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/experiment/drivers/udp_device.h"

namespace mbk::drivers {
namespace {

using realtime::monotonic_ns;

constexpr double kShortestWatchdog = 1e-3, kLongestWatchdog = 10.0;  // [s]
constexpr double kAskAgain = 0.02;                                   // [s]

std::int64_t after(double seconds) noexcept {
  return monotonic_ns() + std::llround(1e9 * seconds);
}

/// A name that only one socket of this computer can have, and that ends with its process. All devices of a process
/// share it.   @returns  null if another process has it
std::shared_ptr<const int> claim_of(const UdpAddress& robot) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<const int>> claims;
  const std::scoped_lock lock(mutex);
  const std::string name = "mbk robot " + robot.text();
  if (auto claim = claims[name].lock()) return claim;
  const std::shared_ptr<const int> claim(new int(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)), [](const int* one) {
    if (*one >= 0) close(*one);
    delete one;
  });
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);  // the first zero makes it no file
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  const bool taken = bind(*claim, reinterpret_cast<const sockaddr*>(&address), length) != 0 && errno == EADDRINUSE;
  if (taken) return nullptr;
  claims[name] = claim;
  return claim;
}

}  // namespace

UdpDevice::UdpDevice(UdpOptions options, const Fittings& fittings) : options_(std::move(options)), fittings_(fittings) {
  facts_.name = fmt::format("UDP {}:{}", options_.address, options_.port);
  facts_.has_force = fittings.has_force;
  facts_.has_acceleration = fittings.has_acceleration;
  facts_.keeps_time = !options_.lock_step;
  facts_.acknowledges = true;
  facts_.force_latency = fittings.force_latency;
}

Result<std::unique_ptr<UdpDevice>> UdpDevice::create(const UdpOptions& options, const Fittings& fittings) {
  if (options.port == 0) return bad_usage("the robot's UDP port is 0", "name the port where the robot listens");
  if (!(options.watchdog >= kShortestWatchdog && options.watchdog <= kLongestWatchdog)) {
    return bad_usage(fmt::format("watchdog {:g} s is not between {:g} and {:g} s", options.watchdog, kShortestWatchdog,
                                 kLongestWatchdog));
  }
  MBK_TRY(above_zero({{"time to answer", options.answer_within, "s"}}));
  if (fittings.force_latency < 0) return bad_usage("the force latency is below zero");
  return std::unique_ptr<UdpDevice>(new UdpDevice(options, fittings));
}

Result<void> UdpDevice::start() {
  const auto robot = MBK_TRY(UdpAddress::find(options_.address, options_.port));
  if (claim_ = claim_of(robot); !claim_) {
    return bad_data(fmt::format("{}: another mbk on this computer is using this robot", facts_.name),
                    "end that one, or wait until its trial is over");
  }
  auto socket = MBK_TRY(UdpSocket::open({0, options_.local_port}));
  has_last_words_ = false;
  robot_ = robot;
  socket_ = std::move(socket);
  counts_ = {};
  newest_ = {};
  alarms_ = {};
  heard_ = broken_ = false;
  last_ = {};
  while (last_.session == 0) last_.session = std::random_device{}();
  last_.watchdog = static_cast<std::uint32_t>(std::lround(1e3 * options_.watchdog));
  last_.greeting = true;
  last_.lock_step = options_.lock_step;
  last_.sequence = 1;
  CommandDatagram off = last_;
  off.greeting = false;
  off.sequence = kLastSequence;
  last_words_ = encode(off);
  has_last_words_ = true;
  std::uint64_t asked = 0;
  for (const std::int64_t until = after(options_.answer_within); !heard_ && monotonic_ns() < until; ++asked) {
    if (!send_last()) break;
    if (socket_->wait(kAskAgain)) take_all();
  }
  last_.greeting = false;
  if (!heard_) return tl::unexpected(no_answer());
  if (newest_.enabled) {
    return bad_data(fmt::format("{}: the robot reports its motors on before any command", facts_.name),
                    "switch them off at the robot; its program must answer a greeting with the motors off");
  }
  if (options_.lock_step && sends_unasked(asked)) {
    return bad_data(
        fmt::format("{}: the robot keeps its own time: it sends states without waiting for commands", facts_.name),
        "remove lock_step from [device]: it would disable the checks of the robot's time");
  }
  const auto differs = [&](const char* what, const char* key, bool sent, bool expected) -> Result<void> {
    if (sent == expected) return {};
    return bad_data(fmt::format("{}: the robot reports {} {}, but the experiment expects {}", facts_.name,
                                sent ? "its" : "no", what, expected ? "one" : "none"),
                    fmt::format("set {} in [device], or connect the sensor", key));
  };
  MBK_TRY(differs("force sensor", "has_force", newest_.has_force, facts_.has_force));
  return differs("accelerometer", "has_acceleration", newest_.has_acceleration, facts_.has_acceleration);
}

/// Whether more states come than were asked for, within a time in which a robot sends dozens.
bool UdpDevice::sends_unasked(std::uint64_t asked) noexcept {
  constexpr double kListen = 0.05;  // [s]
  constexpr std::uint64_t kMore = 2;
  const std::uint64_t before = counts_.believed;
  for (const std::int64_t until = after(kListen); monotonic_ns() < until;) {
    if (socket_->wait(kListen)) take_all();
  }
  return counts_.believed > before + asked + kMore;
}

Error UdpDevice::no_answer() const {
  std::string came;
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) came += fmt::format("{}{} × {}", came.empty() ? "; received instead: " : ", ", count, what);
  };
  for (std::size_t i = 0; i < counts_.refused.size(); ++i) add(counts_.refused[i], word_of(static_cast<Refusal>(i)));
  add(counts_.foreign, "from another address");
  add(counts_.old, "of another session");
  return fail(ErrorKind::data, fmt::format("{}: no answer within {:g} s{}", facts_.name, options_.answer_within, came),
              "start the robot's program, and check address, port, cable and firewall, and whether another mbk talks "
              "to it")
      .value();
}

void UdpDevice::take_all() noexcept {
  std::array<std::byte, 2 * kStateBytes2> bytes{};
  UdpAddress from;
  for (int i = 0; i < kMaxAtOnce; ++i) {
    const int size = socket_->receive(bytes, from);
    if (size < 0) return;
    if (from != robot_) {
      ++counts_.foreign;
      continue;
    }
    StateDatagram came;
    const Refusal refusal = decode(std::span(bytes).first(static_cast<std::size_t>(size)), came);
    if (refusal != Refusal::none) {
      ++counts_.refused[static_cast<std::size_t>(refusal)];
      continue;
    }
    if (came.session != last_.session || (heard_ && came.raw.sequence <= newest_.raw.sequence)) {
      ++counts_.old;
      continue;
    }
    ++counts_.believed;
    if (heard_) counts_.lost += came.raw.sequence - newest_.raw.sequence - 1;
    newest_ = came;
    heard_ = true;
    alarms_.stop |= came.raw.stop;
    alarms_.watchdog_expired |= came.watchdog_expired;
    if (came.fault != 0) alarms_.fault = came.fault;
  }
}

void UdpDevice::await_answer() noexcept {
  const std::int64_t until = after(options_.answer_within);
  take_all();
  while (newest_.answered != last_.sequence) {
    if (broken_ || monotonic_ns() > until) {
      broken_ = true;
      return;
    }
    if (!socket_->wait(kAskAgain)) {
      ++counts_.repeated;
      if (!send_last()) broken_ = true;
    }
    take_all();
  }
}

bool UdpDevice::read(device::State& state) noexcept {
  if (!socket_) return false;
  if (options_.lock_step) {
    await_answer();
  } else {
    take_all();
  }
  state = fittings_.wiring.state(newest_.raw);
  state.answered = newest_.answered > 0 ? newest_.answered - 1 : 0;  // the greeting does not count as a command
  state.motors = newest_.enabled ? device::Motors::on : device::Motors::off;
  state.has_force = newest_.has_force;
  state.has_acceleration = newest_.has_acceleration;
  state.stop = alarms_.stop;
  state.watchdog_expired = alarms_.watchdog_expired;
  state.drives_measure = newest_.drives_measure;
  state.drive_torque = fittings_.wiring.torque(newest_.measured);
  state.fault = alarms_.fault;
  // Until a newer state comes the newest one goes on saying what it says.
  alarms_ = {newest_.raw.stop, newest_.watchdog_expired, newest_.fault};
  return !broken_;
}

bool UdpDevice::send_last() noexcept {
  return socket_->send(encode(last_), robot_);
}

bool UdpDevice::write(const device::Command& command) noexcept {
  if (!socket_) return false;
  ++last_.sequence;
  last_.command = fittings_.wiring.command(command.torque);
  last_.enabled = command.enabled;
  if (!send_last()) broken_ = true;
  return !broken_;
}

void UdpDevice::stop() noexcept {
  if (!socket_) return;
  write({});
  constexpr timespec kPause{0, 1'000'000};
  for (int i = 1; i < kGoodbyes; ++i) {
    nanosleep(&kPause, nullptr);
    send_last();
  }
}

void UdpDevice::emergency_off() noexcept {
  if (!has_last_words_) return;
  for (int i = 0; i < kGoodbyes; ++i) socket_->send(last_words_, robot_);
}

}  // namespace mbk::drivers
