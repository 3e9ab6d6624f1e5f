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
  at_stop,      ///< the trial goes on; the stop is not confirmed, and the program says so
  refusal,      ///< the trial does not begin
  no_harm,      ///< the link is built for it: the trial goes on, or trips for one of the reasons
  not_detected  ///< cannot be seen from outside; `bound` says what limits the harm
};

[[nodiscard]] constexpr auto word_table(Expected) {
  using enum Expected;
  return std::to_array<Word<Expected>>({{trip, "trip"},
                                        {at_stop, "at-stop"},
                                        {refusal, "refusal"},
                                        {no_harm, "no-harm"},
                                        {not_detected, "not-detected"}});
}

/// Who knows after the stop that the motors are off.
enum class SafeState {
  confirmed,      ///< the robot says so, and it is true
  not_confirmed,  ///< nobody knows, and the program says so
  either,         ///< it depends on the moment; never a wrong confirmation
  unresolved      ///< confirmed although a torque may be left, which is smaller than what motion shows
};

[[nodiscard]] constexpr auto word_table(SafeState) {
  using enum SafeState;
  return std::to_array<Word<SafeState>>(
      {{confirmed, "confirmed"}, {not_confirmed, "not-confirmed"}, {either, "either"}, {unresolved, "unresolved"}});
}

/// A kind of fault of a robot behind UDP: what it is, and what is documented of it; a row of tables/udp_faults.toml.
struct UdpFaultKind {
  std::string name;  ///< for the command line: "latched-frozen-answer"
  std::string what;  ///< what happens, physically
  Expected expected = Expected::trip;
  std::array<int, 2> detection{};         ///< ticks to the trip at most, in a trial of positions and of forces
  std::vector<std::string_view> reasons;  ///< words of every safety::Reason that is right
  SafeState safe_state = SafeState::confirmed;
  std::string bound;          ///< what stays the robot's duty, or limits the harm
  std::uint16_t version = 1;  ///< of the robot's states
  std::function<void(RobotFault&, numeric::Random&)> make;
};

/// All of them.
[[nodiscard]] std::span<const UdpFaultKind> udp_fault_kinds();

/// Codes of what a robot that moves otherwise than it is commanded leads to.
[[nodiscard]] std::span<const std::string_view> motion_reasons();

/// @returns  null where there is none of that name
[[nodiscard]] const UdpFaultKind* find_udp_fault(std::string_view name);

}  // namespace mbk::validation
