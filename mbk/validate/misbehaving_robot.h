#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/experiment/drivers/udp_robot.h"
#include "mbk/simulate/laboratory/simulated_device.h"
#include "mbk/validate/robot_fault.h"

namespace mbk::validation {

/// What truly happened at a robot, whatever it said of it. Ticks are those of its own clock since the first greeting,
/// which keeps in step with the wall clock; −1: never.
struct RobotTruth {
  std::int64_t ticks = 0;          ///< so far
  std::int64_t motors_on = -1;     ///< the motors were first on
  std::int64_t fault_began = -1;   ///<
  std::int64_t told_off = -1;      ///< the first command since then to switch the motors off reached the wire
  std::int64_t torque_off = -1;    ///< first tick without torque, and there has been none since
  std::int64_t last_command = -1;  ///< reached the wire
  double speed = 0.0;              ///< largest of the hand since the fault began [m/s]
  double force = 0.0;              ///< largest at the handle since then [N]
  std::int64_t missed = 0;         ///< ticks that its program was held up and had to make up for
  std::int64_t stalled = 0;        ///< of them, with the last stall
  [[nodiscard]] bool off() const { return torque_off >= 0; }
};

/// A simulated robot with a participant at its handle, reached by UDP in real time (UdpRobot), that begins to misbehave
/// at a moment, and keeps a record of what it truly did.
class MisbehavingRobot {
 public:
  struct Options {
    drivers::UdpAddress local;  ///< where it listens; port 0: any that is free
    double sample_time = 1e-3;  ///< [s] > 0
    std::uint16_t version = 1;  ///< of its states
    double moment = 1.0;        ///< from when its motors first go on to the fault [s] ≥ 0
    std::uint64_t seed = 1;     ///< of damaged bits
  };

  /// Called for what happens, by its name, with the truth so far: "greeting", "motors on", "fault", "told off", "torque
  /// off", "torque on", "stall" of more than four ticks, "gone", "back".
  using Watch = std::function<void(std::string_view event, const RobotTruth& truth)>;

  /// @param robot  outlives this
  /// @fails  usage: a moment below zero; a version that there is not. As UdpRobot::create.
  [[nodiscard]] static Result<std::unique_ptr<MisbehavingRobot>> create(laboratory::SimulatedDevice& robot,
                                                                        RobotFault fault, const Options& options,
                                                                        Watch watch = {});
  ~MisbehavingRobot();

  [[nodiscard]] drivers::UdpAddress local() const { return local_; }

  /// Until `end`.
  void serve();

  /// From any thread, and from a signal handler.
  void end() noexcept;

  /// Once `serve` is over.
  [[nodiscard]] const RobotTruth& truth() const { return truth_; }

 private:
  class Drives;
  class Link;

  MisbehavingRobot(laboratory::SimulatedDevice& robot, RobotFault fault, const Options& options, Watch watch);
  [[nodiscard]] int since() const;  // k of RobotFault; below zero: not yet
  [[nodiscard]] bool moment_is_over() const;
  [[nodiscard]] bool due() const;
  void begin_fault();
  void say(std::string_view event) const;
  void be_gone();

  RobotFault fault_;
  Options options_;
  Watch watch_;
  RobotTruth truth_;
  std::unique_ptr<Drives> drives_;
  std::unique_ptr<Link> link_;
  std::optional<drivers::UdpRobot> robot_;
  drivers::UdpAddress local_;
  std::atomic<bool> ended_{false}, leaves_{false};
};

}  // namespace mbk::validation
