#pragma once

#include <cstdint>

#include "mbk/experiment/device/device.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/experiment/safety/trip.h"

namespace mbk::safety {

using device::Motors;

/// A violated rule, with the measured value and its limit.
struct Violation {
  Reason reason = Reason::none;
  double value = 0.0, limit = 0.0;
  explicit operator bool() const noexcept { return reason != Reason::none; }
};

/// Compares the robot's reports with the commands: which command it obeys, the age of its states, its clock, motors and
/// sensors. Nothing allocates.
///   The age of a state is the time passed on this clock minus the time passed on the robot's, since the state that
/// arrived fastest. That reference may drift by kClockDrift, so that two correct clocks agree; a delay of every state
/// from the beginning shows in the acknowledgement only.
class ReportCheck {
 public:
  explicit ReportCheck(const Limits& limits, double sample_time) noexcept
      : limits_(limits), sample_time_(sample_time) {}

  /// Forgets what came before.
  void forget() noexcept;

  /// @param state  a new one    @param now  on the loop's clock, if the robot keeps its own time [s]
  /// @param sent  commands sent so far, all with motors on
  [[nodiscard]] Violation check(const device::State& state, const device::Abilities& robot, double now,
                                std::uint64_t sent) noexcept;

 private:
  static constexpr double kClockDrift = 5e-4;  ///< of one clock against the other
  [[nodiscard]] Violation check_clock(const device::State& state, double now, bool keeps_time) noexcept;
  [[nodiscard]] Violation check_answer(const device::State& state, double now, std::uint64_t sent) noexcept;

  Limits limits_;
  double sample_time_;
  bool begun_ = false, measured_ = false;
  double began_ = 0.0;                      // here [s]
  double last_ = 0.0, last_now_ = 0.0;      // stamps of the state before, there and here [s]
  double fastest_ = 0.0;                    // here − there [s]
  double window_ = 0.0, window_now_ = 0.0;  // where the comparison of the two clocks' rates began [s]
  std::uint64_t answered_ = 0;
  double motors_wrong_since_ = 0.0;
  bool motors_wrong_ = false;
};

}  // namespace mbk::safety
