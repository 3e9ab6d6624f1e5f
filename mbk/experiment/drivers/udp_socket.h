#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "mbk/base/core/result.h"

namespace mbk::drivers {

inline constexpr int kMaxAtOnce = 256;  ///< datagrams that are taken in one tick: a flood must not hold anyone up

/// Where datagrams come from or go to: IPv4.
struct UdpAddress {
  std::uint32_t host = 0;  ///< a.b.c.d as a·2²⁴ + b·2¹⁶ + c·2⁸ + d
  std::uint16_t port = 0;
  bool operator==(const UdpAddress&) const = default;

  /// "192.168.7.2:25000".
  [[nodiscard]] std::string text() const;

  /// @fails  data: the name is not known, or has no IPv4 address.
  [[nodiscard]] static Result<UdpAddress> find(const std::string& name, std::uint16_t port);
};

/// A socket for datagrams. After `open` nothing allocates or waits but `wait`.
class UdpSocket {
 public:
  /// @param local  where it listens; host 0: every network, port 0: any that is free
  /// @fails  data: the port is taken or forbidden.
  [[nodiscard]] static Result<UdpSocket> open(const UdpAddress& local);

  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&& other) noexcept;
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  ~UdpSocket();

  /// Where it listens.
  [[nodiscard]] UdpAddress local() const;

  /// The next datagram; one that is longer than `into` is cut.   @returns  its bytes; -1 where none has come
  int receive(std::span<std::byte> into, UdpAddress& from) noexcept;

  /// @returns  false where the network is not there; a full queue is like any other loss: true
  bool send(std::span<const std::byte> bytes, const UdpAddress& to) noexcept;

  /// Until a datagram has come, at most so long [s].   @returns  whether one has come
  [[nodiscard]] bool wait(double longest) const noexcept;

 private:
  explicit UdpSocket(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace mbk::drivers
