#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/realtime/cycle_record.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/session/robot_check.h"

namespace mbk::session {

/// One reading over a while.
struct Readings {
  std::uint64_t count = 0;
  double mean = 0.0, low = 0.0, high = 0.0;
  double deviation = 0.0;           ///< standard deviation
  double step = 0.0;                ///< of one sample to the next, root mean square
  std::uint64_t longest_still = 0;  ///< samples that were the same to the bit, the longest run
  std::uint64_t not_finite = 0;

  void add(double value) noexcept;

 private:
  double squares_ = 0.0, step_squares_ = 0.0, last_ = 0.0;
  std::uint64_t still_ = 0;
};

/// What a robot said while its motors were off.
struct LiveRecord {
  double duration = 0.0;          ///< [s]
  std::uint64_t ticks = 0;        ///< of mbk
  std::uint64_t fresh = 0;        ///< ticks with a new state
  std::uint64_t lost = 0;         ///< states that never came, by their sequence
  std::uint64_t missed = 0;       ///< ticks at which this machine was late by more than one
  std::uint64_t backward = 0;     ///< ticks whose time on the robot's clock was not after the last
  std::uint64_t longest_gap = 0;  ///< ticks without a new state, the longest run
  bool link = true;
  bool stop_pressed = false, stop_released = false;    ///< seen at any time, the second after the first
  std::array<Readings, 2> joint, force, acceleration;  ///< [rad], [N], [m/s²]
  device::State last;
};

/// Reads `robot` at `rate` for so long, with its motors off, then stops it.
/// @param seconds  > 0
/// @fails  data: as Device::start
[[nodiscard]] Result<LiveRecord> watch_robot(device::Device& robot, Hertz rate, double seconds);

/// What is wrong with what came: the link, its rate and gaps, the stop button, readings that are frozen, noisy, not
/// finite, out of the joints' limits, or not about zero.
[[nodiscard]] std::vector<Finding> check_live(const RobotSetup& setup, const device::Facts& facts,
                                              const LiveRecord& record);

/// The readings, for people.
[[nodiscard]] std::string live_text(const RobotSetup& setup, const device::Facts& facts, const LiveRecord& record);

}  // namespace mbk::session
