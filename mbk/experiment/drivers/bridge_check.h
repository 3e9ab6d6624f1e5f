#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/experiment/drivers/udp_socket.h"

namespace mbk::drivers {

/// What the program of a robot behind UDP has to do (docs/guide/own_robot.md), as far as it shows at the other end of
/// the wire. From `motors_on` on its motors go on for it, with command 0.
enum class BridgeRule : std::uint8_t {
  answers,
  whole_states,
  session,
  starts_off,
  greeting_number,
  numbering,
  clock,
  rate,
  silence,
  finite,
  acknowledges,
  damaged,
  other_kinds,
  old,
  other_session,
  stranger,
  not_finite,
  counts,
  late_greeting,
  motors_on,
  greeting_while_on,
  motors_off,
  watchdog,
  latched,
  greets_again,
  last_words
};
[[nodiscard]] constexpr auto word_table(BridgeRule) {
  using enum BridgeRule;
  return std::to_array<Word<BridgeRule>>({{answers, "answers"},
                                          {whole_states, "whole-states"},
                                          {session, "session"},
                                          {starts_off, "starts-off"},
                                          {greeting_number, "greeting-number"},
                                          {numbering, "numbering"},
                                          {clock, "clock"},
                                          {rate, "rate"},
                                          {silence, "silence"},
                                          {finite, "finite"},
                                          {acknowledges, "acknowledges"},
                                          {damaged, "damaged"},
                                          {other_kinds, "other-kinds"},
                                          {old, "old"},
                                          {other_session, "other-session"},
                                          {stranger, "stranger"},
                                          {not_finite, "not-finite"},
                                          {counts, "counts"},
                                          {late_greeting, "late-greeting"},
                                          {motors_on, "motors-on"},
                                          {greeting_while_on, "greeting-while-on"},
                                          {motors_off, "motors-off"},
                                          {watchdog, "watchdog"},
                                          {latched, "latched"},
                                          {greets_again, "greets-again"},
                                          {last_words, "last-words"}});
}

/// A rule in words.
struct BridgeRuleText {
  std::string_view rule;  ///< "answers a greeting": of the robot
  std::string_view mend;  ///< what to do where it does not
};
[[nodiscard]] const BridgeRuleText& text_of(BridgeRule rule);

enum class RuleVerdict : std::uint8_t { passed, failed, not_tested };
[[nodiscard]] constexpr auto word_table(RuleVerdict) {
  using enum RuleVerdict;
  return std::to_array<Word<RuleVerdict>>({{passed, "passed"}, {failed, "failed"}, {not_tested, "not tested"}});
}

/// What was seen of one rule.
struct RuleFinding {
  BridgeRule rule = BridgeRule::answers;
  RuleVerdict verdict = RuleVerdict::not_tested;
  std::string seen;  ///< with numbers and units; why, where it was not tested
};

/// What was seen of a robot's program.
struct BridgeReport {
  std::vector<RuleFinding> findings;             ///< one of each rule, in their order
  std::uint64_t states = 0;                      ///< that were believed
  std::optional<double> rate;                    ///< of the states, by the robot's clock [Hz]
  std::optional<double> median_answer;           ///< from a command to the state that obeys it [s]
  std::optional<double> longest_answer;          ///< [s]
  std::vector<std::array<double, 2>> watchdogs;  ///< asked for, and from the last command to the state that says so [s]

  [[nodiscard]] bool failed() const;
  /// Every rule was tested and passed.
  [[nodiscard]] bool conforms() const;
};

/// The wire between the check and a robot.
class BridgeWire {
 public:
  enum class From { mbk, stranger };  ///< whose address a datagram comes from

  BridgeWire() = default;
  BridgeWire(const BridgeWire&) = delete;
  BridgeWire& operator=(const BridgeWire&) = delete;
  virtual ~BridgeWire() = default;

  /// Monotonic [ns].
  [[nodiscard]] virtual std::int64_t now() noexcept = 0;
  virtual void wait_until(std::int64_t time) noexcept = 0;
  virtual void send(From from, std::span<const std::byte> bytes) noexcept = 0;
  /// The next datagram of the robot's to mbk's address.   @returns  its bytes; −1 where none has come
  virtual int receive(std::span<std::byte> into) noexcept = 0;
};

/// The wire to a robot that is reached by UDP.
class UdpBridgeWire : public BridgeWire {
 public:
  /// @param local_port  where the check listens; 0: any that is free
  /// @fails  data: the port is taken.
  [[nodiscard]] static Result<UdpBridgeWire> open(const UdpAddress& robot, std::uint16_t local_port = 0);
  UdpBridgeWire(UdpBridgeWire&& other) noexcept
      : robot_(other.robot_), mbk_(std::move(other.mbk_)), stranger_(std::move(other.stranger_)) {}

  [[nodiscard]] std::int64_t now() noexcept override;
  void wait_until(std::int64_t time) noexcept override;
  void send(From from, std::span<const std::byte> bytes) noexcept override;
  int receive(std::span<std::byte> into) noexcept override;

 private:
  UdpBridgeWire(const UdpAddress& robot, UdpSocket mbk, UdpSocket stranger)
      : robot_(robot), mbk_(std::move(mbk)), stranger_(std::move(stranger)) {}

  UdpAddress robot_;
  UdpSocket mbk_, stranger_;
};

struct BridgeCheckOptions {
  double rate = 1000.0;        ///< at which the robot has to send states, and commands are sent [Hz] > 0
  double watch = 1.0;          ///< how long its states are watched [s] > 0
  double answer_within = 2.0;  ///< of a greeting [s] > 0
  bool motors = false;         ///< also the rules for which its motors go on, with command 0
};

/// Whether the program of a robot keeps the rules, each tried in turn: it is greeted, commanded, sent what it must not
/// believe, and with `motors` switched on with command 0, left without commands, and switched off. At the end the
/// motors are told to be off. What could not be seen because this machine was held up is not tested.
/// @fails  usage: an option that is not above zero.
[[nodiscard]] Result<BridgeReport> check_bridge(BridgeWire& wire, const BridgeCheckOptions& options);

}  // namespace mbk::drivers
