#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"

namespace mbk::device {

using Eigen::Vector2d;

/// What a robot says of its motors.
enum class Motors : std::uint8_t {
  unknown,  ///< it says nothing
  off,
  on
};

[[nodiscard]] constexpr auto word_table(Motors) {
  using enum Motors;
  return std::to_array<Word<Motors>>({{unknown, "unknown"}, {off, "off"}, {on, "on"}});
}

/// What a robot of two joints reads at one tick, in SI units, base frame, and what it reports of itself.
struct State {
  std::uint64_t sequence = 0;          ///< of the robot's own samples, from 1; the same again: nothing new has come
  double time = 0.0;                   ///< on the robot's clock [s]
  Vector2d joint = {0.0, 0.0};         ///< angles at the encoders [rad]
  Vector2d force = {0.0, 0.0};         ///< of the hand on the robot [N]; zero without a sensor
  Vector2d acceleration = {0.0, 0.0};  ///< of the hand [m/s²]; zero without a sensor
  bool stop = false;                   ///< somebody presses the stop button

  std::uint64_t answered = 0;          ///< commands up to the one that it obeys: 1 the first since `start`; 0: none
  Motors motors = Motors::unknown;     ///< as they are in truth, not as they were told to be
  bool has_force = true;               ///< the force sensor is there
  bool has_acceleration = true;        ///< the accelerometer is there
  bool watchdog_expired = false;       ///< no command came in time: its motors stay off
  bool drives_measure = false;         ///< `drive_torque` is meant
  Vector2d drive_torque = {0.0, 0.0};  ///< of the motors as its drives measure it, at the joints [N·m]
  std::uint32_t fault = 0;             ///< its own fault code; 0: none
};

/// What it shall do until the next tick.
struct Command {
  std::uint64_t tick = 0;
  Vector2d torque = {0.0, 0.0};  ///< of the motors, at the joints [N·m]
  bool enabled = false;          ///< false: drives off, whatever the torque
};

/// What is fitted to a robot, and what it can say.
struct Abilities {
  bool has_force = true;         ///< a force sensor is fitted
  bool has_acceleration = true;  ///< an accelerometer is fitted
  bool keeps_time = true;        ///< it moves on by itself; false: it waits for each command, as a simulation may
  bool acknowledges = false;     ///< its states say which command it obeys, and whether its motors are on
};

/// What does not change while it runs.
struct Facts : Abilities {
  std::string name;       ///< for people: "simulated robot", "UDP 127.0.0.1:25000"
  int force_latency = 0;  ///< ticks by which force and acceleration are older than the angles of their State ≥ 0
};

/// A robot of two joints at the end of some wire. Between `start` and `stop`, `read` and `write` are called once a tick
/// by one thread; they neither wait nor allocate, lock or print. A device watches its link by itself: where no command
/// has come for its own limit of time it switches its motors off.
class Device {
 public:
  virtual ~Device() = default;

  [[nodiscard]] virtual const Facts& facts() const = 0;

  /// @fails  data: the robot does not answer, with what to do about it.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// The newest state; `state` is left as it was where nothing came.   @returns  false where the link is broken
  virtual bool read(State& state) noexcept = 0;

  /// @returns  false where the link is broken
  virtual bool write(const Command& command) noexcept = 0;

  /// Motors off.
  virtual void stop() noexcept = 0;

  /// Motors off by one last command of a program that dies: called by the handler of a fatal signal, in any thread and
  /// at any moment after the constructor, so it must be async-signal-safe (signal-safety(7)): no allocation, no lock.
  /// A device that cannot leaves it to its watchdog.
  virtual void emergency_off() noexcept {}

 protected:
  Device() = default;
  Device(const Device&) = default;
  Device(Device&&) = default;
  Device& operator=(const Device&) = default;
  Device& operator=(Device&&) = default;
};

}  // namespace mbk::device
