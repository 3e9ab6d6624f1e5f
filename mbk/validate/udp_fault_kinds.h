#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/robot_fault.h"

namespace mbk::validation {

/// What a fault of a robot behind UDP has to lead to.
enum class Expected {
  trip,         ///< the gate trips within the documented ticks
  at_stop,      ///< the trial continues; the stop is not confirmed, and the program reports it
  refusal,      ///< the trial does not start
  no_harm,      ///< the link tolerates it: the trial continues, or trips for one of the reasons
  not_detected  ///< not visible from outside; `bound` states what limits the harm
};

[[nodiscard]] constexpr auto word_table(Expected) {
  using enum Expected;
  return std::to_array<Word<Expected>>({{trip, "trip"},
                                        {at_stop, "at-stop"},
                                        {refusal, "refusal"},
                                        {no_harm, "no-harm"},
                                        {not_detected, "not-detected"}});
}

/// What is known of the motors after the stop.
enum class SafeState {
  confirmed,      ///< reported off by the robot, and true
  not_confirmed,  ///< unknown, and the program reports that
  either,         ///< it depends on the moment; never a wrong confirmation
  unresolved      ///< confirmed although a torque too small to show in the motion may remain
};

[[nodiscard]] constexpr auto word_table(SafeState) {
  using enum SafeState;
  return std::to_array<Word<SafeState>>(
      {{confirmed, "confirmed"}, {not_confirmed, "not-confirmed"}, {either, "either"}, {unresolved, "unresolved"}});
}

/// A kind of fault of a robot behind UDP: what it is, and what is documented about it; a row of tables/udp_faults.toml.
struct UdpFaultKind {
  std::string name;  ///< for the command line: "latched-frozen-answer"
  std::string what;  ///< what happens, physically
  Expected expected = Expected::trip;
  std::array<int, 2> detection{};         ///< ticks to the trip at most, in a trial of positions and of forces
  std::vector<std::string_view> reasons;  ///< words of every correct safety::Reason
  SafeState safe_state = SafeState::confirmed;
  std::string bound;          ///< the robot's duty, or what limits the harm
  std::uint16_t version = 1;  ///< of the robot's states
  std::function<void(RobotFault&, numeric::Random&)> make;
};

/// All of them.
[[nodiscard]] std::span<const UdpFaultKind> udp_fault_kinds();

/// Codes of the reasons that a robot may trip by moving differently from its command.
[[nodiscard]] std::span<const std::string_view> motion_reasons();

/// @returns  null if no fault has that name
[[nodiscard]] const UdpFaultKind* find_udp_fault(std::string_view name);

}  // namespace mbk::validation
