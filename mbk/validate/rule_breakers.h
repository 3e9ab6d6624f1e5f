#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/experiment/drivers/bridge_check.h"
#include "mbk/experiment/drivers/datagram.h"
#include "mbk/experiment/drivers/udp_robot.h"

namespace mbk::validation {

/// A robot's program that breaks one rule: what it makes of what it hears, and of what it should say. Either may be
/// empty. One of them serves one robot.
struct SpoiltProgram {
  struct Heard {
    std::vector<std::byte> bytes;
    drivers::UdpAddress from;
    bool dropped = false;
  };
  struct Said {
    drivers::StateDatagram state;
    bool dropped = false, damaged = false;
  };
  std::function<void(Heard&)> hear;
  std::function<void(Said&)> say;
};

/// A way to break a rule of docs/guide/own_robot.md, as programs do.
struct RuleBreaker {
  std::string_view name;  ///< for the command line: "believes-damaged"
  std::string_view what;  ///< what its program does
  drivers::BridgeRule rule;
  std::function<SpoiltProgram()> make;
};

/// At least one of each rule.
[[nodiscard]] std::span<const RuleBreaker> rule_breakers();

/// @returns  null if no rule breaker has that name
[[nodiscard]] const RuleBreaker* find_rule_breaker(std::string_view name);

/// A UdpRobot with a spoilt program.
class SpoiltLink : public drivers::UdpRobotLink {
 public:
  explicit SpoiltLink(SpoiltProgram program) : program_(std::move(program)) {}
  int receive(drivers::UdpSocket& socket, std::span<std::byte> into, drivers::UdpAddress& from) noexcept override;
  void send(drivers::UdpSocket& socket, const drivers::StateDatagram& state,
            const drivers::UdpAddress& to) noexcept override;

 private:
  SpoiltProgram program_;
};

/// What `program` says in place of `state`.   @returns  no bytes where it says nothing
[[nodiscard]] std::vector<std::byte> said_by(const SpoiltProgram& program, const drivers::StateDatagram& state);

}  // namespace mbk::validation
