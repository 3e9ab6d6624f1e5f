#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "mbk/experiment/device/device.h"

namespace mbk::session {

/// What a robot says of itself while no trial runs.
struct IdleState {
  bool link = false;         ///< a new state has come within kSilence
  bool stop_button = false;  ///< pressed
  device::Motors motors = device::Motors::unknown;
  bool confirmed_off = false;  ///< a new state acknowledges a command with motors off, and says that they are
  std::uint32_t fault = 0;     ///< the robot's own code; 0: none
  bool operator==(const IdleState&) const = default;

  static constexpr double kSilence = 0.5;  ///< [s]
};

/// Between two trials: a thread that tells the robot "motors off" fifty times a second, so that its states keep coming,
/// and looks at them.
class IdleWatch {
 public:
  /// @param robot  between start() and its destruction, and no trial runs on it while this lives
  /// @param seen  called from the thread with the first state, and with each that differs from the one before
  IdleWatch(device::Device& robot, std::function<void(const IdleState&)> seen);
  IdleWatch(const IdleWatch&) = delete;
  IdleWatch& operator=(const IdleWatch&) = delete;
  ~IdleWatch();

 private:
  void watch() noexcept;

  device::Device& robot_;
  std::function<void(const IdleState&)> seen_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

}  // namespace mbk::session
