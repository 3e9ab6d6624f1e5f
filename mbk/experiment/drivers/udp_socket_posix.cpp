#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>

#include "mbk/experiment/drivers/udp_socket.h"

namespace mbk::drivers {
namespace {

sockaddr_in system_address(const UdpAddress& address) noexcept {
  sockaddr_in made{};
  made.sin_family = AF_INET;
  made.sin_addr.s_addr = htonl(address.host);
  made.sin_port = htons(address.port);
  return made;
}

UdpAddress own_address(const sockaddr_in& address) noexcept {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

}  // namespace

std::string UdpAddress::text() const {
  return fmt::format("{}.{}.{}.{}:{}", host >> 24U, (host >> 16U) & 0xFFU, (host >> 8U) & 0xFFU, host & 0xFFU, port);
}

Result<UdpAddress> UdpAddress::find(const std::string& name, std::uint16_t port) {
  addrinfo requested{};
  requested.ai_family = AF_INET;
  requested.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(name.c_str(), nullptr, &requested, &found); error != 0) {
    return bad_data(fmt::format("the address '{}' is unknown: {}", name, gai_strerror(error)),
                    "write it as four numbers, as 192.168.7.2");
  }
  sockaddr_in first{};
  std::memcpy(&first, found->ai_addr, sizeof(first));
  freeaddrinfo(found);
  return UdpAddress{ntohl(first.sin_addr.s_addr), port};
}

Result<UdpSocket> UdpSocket::open(const UdpAddress& local) {
  UdpSocket made(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const sockaddr_in address = system_address(local);
  if (made.descriptor_ < 0 ||
      bind(made.descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return bad_data(fmt::format("cannot listen at UDP {}: {}", local.text(), std::strerror(errno)),
                    "choose another port, or end the program that uses it");
  }
  return made;
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

UdpSocket::~UdpSocket() {
  if (descriptor_ >= 0) close(descriptor_);
}

UdpAddress UdpSocket::local() const {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address), &size);
  return own_address(address);
}

int UdpSocket::receive(std::span<std::byte> into, UdpAddress& from) noexcept {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  const ssize_t bytes =
      recvfrom(descriptor_, into.data(), into.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&address), &size);
  if (bytes < 0) return -1;
  from = own_address(address);
  return static_cast<int>(bytes);
}

bool UdpSocket::send(std::span<const std::byte> bytes, const UdpAddress& to) noexcept {
  const sockaddr_in address = system_address(to);
  const ssize_t sent = sendto(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  return sent >= 0 || errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS || errno == EINTR;
}

bool UdpSocket::wait(double longest) const noexcept {
  pollfd what{descriptor_, POLLIN, 0};
  double whole = 0.0;
  const double part = std::modf(longest, &whole);
  const timespec time{static_cast<std::time_t>(whole), static_cast<long>(1e9 * part)};
  const int ready = ppoll(&what, 1, &time, nullptr);
  if (ready < 0 && errno != EINTR) nanosleep(&time, nullptr);  // whoever asks again does not spin
  return ready > 0;
}

}  // namespace mbk::drivers
