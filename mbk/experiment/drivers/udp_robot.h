#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/drivers/datagram.h"
#include "mbk/experiment/drivers/udp_socket.h"

namespace mbk::drivers {

/// How the datagrams of a UdpRobot go between it and its socket. Derive from it where they shall come late, get lost or
/// say something else.
class UdpRobotLink {
 public:
  UdpRobotLink() = default;
  UdpRobotLink(const UdpRobotLink&) = delete;
  UdpRobotLink& operator=(const UdpRobotLink&) = delete;
  virtual ~UdpRobotLink() = default;

  /// The next command, as UdpSocket::receive gives it.
  virtual int receive(UdpSocket& socket, std::span<std::byte> into, UdpAddress& from) noexcept;

  /// A state, to who greeted last.
  virtual void send(UdpSocket& socket, const StateDatagram& state, const UdpAddress& to) noexcept;
};

/// The other end of UdpDevice: lets a device, such as a simulated robot, be a robot that is reached by datagrams. It
/// obeys who greeted it last, takes no greeting from anyone else while its motors are on, and switches them off until
/// the next greeting where no command has come for the watchdog's time. Between greetings it stands still, so that a
/// session begins where the last one ended; ten seconds after the last command it stops sending.
///   At its own clock it sends a state at each tick and obeys the newest command that has come. Where its program is
/// held up, the device moves on all the same, as a real robot does: by as many ticks as were missed, two seconds at
/// most, under the last command, or with the motors off from where the watchdog's time is over. In lock-step it answers
/// each command with the state that follows, and a repeated command with the same state again.
class UdpRobot {
 public:
  /// @param robot  started; outlives this   @param local  where it listens; port 0: any that is free
  /// @param sample_time  of its own clock [s] > 0
  /// @param link  where given, every datagram passes it; outlives this
  /// @fails  usage: sample_time. data: the port is taken.
  [[nodiscard]] static Result<UdpRobot> create(device::Device& robot, const UdpAddress& local, double sample_time,
                                               UdpRobotLink* link = nullptr);

  [[nodiscard]] UdpAddress local() const { return socket_.local(); }

  /// Until `over` is set, and at most 50 ms longer. In each tick `stop_button` says whether somebody presses it.
  void serve(const std::atomic<bool>& over, const std::atomic<bool>& stop_button) noexcept;

 private:
  UdpRobot(device::Device& robot, UdpSocket socket, double sample_time, UdpRobotLink& link);
  void take_all() noexcept;
  void take(const CommandDatagram& came, const UdpAddress& from) noexcept;
  void greet(const CommandDatagram& came, const UdpAddress& from) noexcept;
  void advance() noexcept;
  void look() noexcept;
  void send() noexcept;
  void watch_time(std::int64_t now) noexcept;
  void make_up(std::uint64_t ticks) noexcept;

  device::Device* robot_;
  UdpRobotLink* link_;
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
