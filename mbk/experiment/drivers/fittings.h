#pragma once

#include "mbk/experiment/device/wiring.h"

namespace mbk::drivers {

/// What is fitted to a robot, and how it is wired.
struct Fittings {
  device::Wiring wiring;
  bool has_force = true;         ///< a force sensor
  bool has_acceleration = true;  ///< an accelerometer
  int force_latency = 0;         ///< ticks by which force and acceleration are older than the angles beside them ≥ 0
};

}  // namespace mbk::drivers
