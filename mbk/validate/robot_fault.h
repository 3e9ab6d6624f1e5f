#pragma once

#include <cstdint>
#include <functional>

#include "mbk/experiment/device/device.h"
#include "mbk/experiment/drivers/datagram.h"

namespace mbk::validation {

using Eigen::Vector2d;

/// How one datagram gets through.
struct Passage {
  int copies = 1;        ///< 0: lost
  int delay = 0;         ///< ticks that it comes late
  bool damaged = false;  ///< one bit is flipped
};

/// What is wrong with a robot behind UDP from one tick on. Each part gets k, the ticks since it began, and may be
/// empty; none is called before.
struct RobotFault {
  enum class Begins {
    at_greeting,  ///< before its motors were ever on
    at_moment,    ///< some time after its motors first went on, while they are
    at_stop       ///< with the first command to switch them off after that moment
  };
  Begins begins = Begins::at_moment;
  double min_torque = 0.0;  ///< begins only where a joint is commanded at least this [N·m]

  std::function<Vector2d(const Vector2d& told, int k)> drive;          ///< torque that acts, of what is commanded
  std::function<void(device::State& state, int k)> sense;              ///< what its sensors give
  std::function<void(drivers::StateDatagram& state, int k)> say;       ///< what its program says
  std::function<void(drivers::CommandDatagram& command, int k)> hear;  ///< what its program understands
  std::function<Passage(int k)> to_robot, from_robot;                  ///< what the wire does

  /// A second robot at the same link: makes its state of the first one's. From another port where `elsewhere`.
  std::function<void(drivers::StateDatagram& state, int k)> second_robot;
  bool elsewhere = false;

  /// The robot's program ends, and with it the torque; after so many ticks another one begins at the same port. 0: it
  /// goes on; −1: none begins.
  int gone = 0;
};

}  // namespace mbk::validation
