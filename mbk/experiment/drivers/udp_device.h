#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/drivers/datagram.h"
#include "mbk/experiment/drivers/fittings.h"
#include "mbk/experiment/drivers/udp_socket.h"

namespace mbk::drivers {

/// Where the robot is, and how long either side waits for the other.
struct UdpOptions {
  std::string address = "127.0.0.1";  ///< of the robot: four numbers, or a name
  std::uint16_t port = 25000;         ///< where the robot listens > 0
  std::uint16_t local_port = 0;       ///< where mbk listens; 0: any that is free
  double watchdog = 0.05;             ///< the robot switches its motors off after so long without a command [s]
  double answer_within = 2.0;         ///< of the greeting, and in lock-step of each command [s] > 0
  bool lock_step = false;             ///< the robot is a simulation and waits for each command
};

/// A robot that is reached by datagrams (datagram.h). `start` greets it with a number of its own, so that what belongs
/// to an earlier session counts for neither side. `read` takes the newest state that has come; what comes from someone
/// else, is broken, or is older than what came before is not believed, but counted. What the robot reports of itself
/// (the command that it obeys, motors, sensors, watchdog, fault) is passed on; the gate judges it. The link is broken
/// where the network is not there. In lock-step `read` waits for the answer to the last command, and asks again where
/// it gets lost.
class UdpDevice : public device::Device {
 public:
  /// What came and what did not, since `start`.
  struct Counts {
    std::uint64_t believed = 0;
    std::uint64_t foreign = 0;               ///< from another address or port
    std::array<std::uint64_t, 5> refused{};  ///< by Refusal
    std::uint64_t old = 0;                   ///< another session's, or not newer than what came before
    std::uint64_t lost = 0;                  ///< numbers missing between states that came
    std::uint64_t repeated = 0;              ///< commands sent again, in lock-step
  };

  /// @fails  usage: no port; watchdog outside 0.001 … 10 s; answer_within is not above zero; force_latency < 0.
  [[nodiscard]] static Result<std::unique_ptr<UdpDevice>> create(const UdpOptions& options, const Fittings& fittings);

  [[nodiscard]] const device::Facts& facts() const override { return facts_; }

  /// @fails  data: the address is not known; the port is taken; no answer, with what came instead; the robot's motors
  ///         are on; it keeps its own time in spite of lock_step; another mbk on this machine talks to it;
  ///         it has other sensors than `fittings` says.
  [[nodiscard]] Result<void> start() override;
  bool read(device::State& state) noexcept override;
  bool write(const device::Command& command) noexcept override;

  /// Says "motors off" several times, so that one lost datagram does no harm.
  void stop() noexcept override;

  /// Sends "motors off", encoded in `start`, with a sequence beyond every other of the session: no command that is
  /// still under way, or that another thread of the dying program still sends, is believed after it.
  void emergency_off() noexcept override;

  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// The newest state as it came.
  [[nodiscard]] const StateDatagram& newest() const { return newest_; }

 private:
  UdpDevice(UdpOptions options, const Fittings& fittings);
  void take_all() noexcept;
  bool send_last() noexcept;
  bool sends_unasked(std::uint64_t asked) noexcept;
  void await_answer() noexcept;
  [[nodiscard]] Error no_answer() const;

  std::shared_ptr<const int> claim_;  ///< that this process talks to the robot, and no other of this machine
  UdpOptions options_;
  Fittings fittings_;
  device::Facts facts_;
  std::optional<UdpSocket> socket_;
  UdpAddress robot_;
  Counts counts_;
  CommandDatagram last_;
  StateDatagram newest_;
  /// What a state that came since the last `read` said, though a newer one has come since.
  struct Alarms {
    bool stop = false, watchdog_expired = false;
    decltype(StateDatagram::fault) fault = 0;
  } alarms_;
  bool heard_ = false, broken_ = false;
  std::array<std::byte, kCommandBytes> last_words_{};
  std::atomic<bool> has_last_words_{false};
};

}  // namespace mbk::drivers
