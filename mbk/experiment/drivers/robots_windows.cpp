#include <fmt/format.h>

#include "mbk/experiment/drivers/plugin_device.h"
#include "mbk/experiment/drivers/udp_device.h"
#include "mbk/experiment/drivers/udp_socket.h"

// Windows keeps no real time, so that no robot is driven from there.
namespace mbk::drivers {
namespace {

tl::unexpected<Error> no_robot() {
  return bad_usage("on Windows mbk drives no robot", "run experiments on Linux");
}

}  // namespace

Result<std::unique_ptr<PluginDevice>> PluginDevice::create(const PluginOptions& /*options*/,
                                                           const Fittings& /*fittings*/) {
  return no_robot();
}

Result<std::unique_ptr<UdpDevice>> UdpDevice::create(const UdpOptions& /*options*/, const Fittings& /*fittings*/) {
  return no_robot();
}

std::string UdpAddress::text() const {
  return fmt::format("{}.{}.{}.{}:{}", host >> 24U, host >> 16U & 255U, host >> 8U & 255U, host & 255U, port);
}

Result<UdpAddress> UdpAddress::find(const std::string& /*name*/, std::uint16_t /*port*/) {
  return no_robot();
}

Result<UdpSocket> UdpSocket::open(const UdpAddress& /*local*/) {
  return no_robot();
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept = default;
UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept = default;
UdpSocket::~UdpSocket() = default;

UdpAddress UdpSocket::local() const {
  return {};
}

int UdpSocket::receive(std::span<std::byte> /*into*/, UdpAddress& /*from*/) noexcept {
  return -1;
}

bool UdpSocket::send(std::span<const std::byte> /*bytes*/, const UdpAddress& /*to*/) noexcept {
  return false;
}

bool UdpSocket::wait(double /*longest*/) const noexcept {
  return false;
}

}  // namespace mbk::drivers
