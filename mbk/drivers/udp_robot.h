#pragma once

#include <atomic>
#include <cstdint>

#include "mbk/core/result.h"
#include "mbk/device/device.h"
#include "mbk/drivers/datagram.h"
#include "mbk/drivers/udp_socket.h"

namespace mbk::drivers {

/// The other end of UdpDevice: lets a device, such as a simulated robot, be a robot that is reached by datagrams. It
/// obeys who greeted it last, takes no greeting from anyone else while its motors are on, and switches them off until
/// the next greeting where no command has come for the watchdog's time. Between greetings it stands still, so that a
/// session begins where the last one ended; ten seconds after the last command it stops sending.
///   At its own clock it sends a state at each tick and obeys the newest command that has come. In lock-step it answers
/// each command with the state that follows, and a repeated command with the same state again.
class UdpRobot {
 public:
  /// @param robot  started; outlives this   @param local  where it listens; port 0: any that is free
  /// @param sample_time  of its own clock [s] > 0
  /// @fails  usage: sample_time. data: the port is taken.
  [[nodiscard]] static Result<UdpRobot> create(device::Device& robot, const UdpAddress& local, double sample_time);

  [[nodiscard]] UdpAddress local() const { return socket_.local(); }

  /// Until `over` is set, and at most 50 ms longer. In each tick `stop_button` says whether somebody presses it.
  void serve(const std::atomic<bool>& over, const std::atomic<bool>& stop_button) noexcept;

 private:
  UdpRobot(device::Device& robot, UdpSocket socket, double sample_time);
  void take_all() noexcept;
  void take(const CommandDatagram& came, const UdpAddress& from) noexcept;
  void greet(const CommandDatagram& came, const UdpAddress& from) noexcept;
  void advance() noexcept;
  void look() noexcept;
  void send() noexcept;
  void watch_time() noexcept;

  device::Device* robot_;
  UdpSocket socket_;
  double sample_time_;
  UdpAddress master_;
  bool awake_ = false;  // somebody is there to send states to
  CommandDatagram obeyed_;
  std::int64_t heard_ = 0;  // when the last command came [ns]
  StateDatagram state_;
  device::State seen_;
  bool stop_pressed_ = false;
};

}  // namespace mbk::drivers
