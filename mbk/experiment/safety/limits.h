#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::safety {

using Eigen::Vector2d;

/// Limits of a session. Commanded forces and torques are cut to their limits; anything else above its limit trips the
/// gate. A limit of 0 is not checked where its line says so.
struct Limits {
  double handle_force = 20.0;          ///< |J⁻ᵀτ| as commanded [N] > 0: cut
  Vector2d joint_torque = {6.0, 6.0};  ///< |τ| as commanded [N·m] > 0: cut
  double torque_rate = 400.0;          ///< change of each τ [N·m/s] > 0: cut
  double max_saturation_time =
      0.1;  ///< longest time that the controller is cut; a quarter of the time uncut is subtracted [s] > 0
  double measured_force = 40.0;           ///< |F_h| that the sensor reads [N] > 0
  double force_jump = 20.0;               ///< of |F_h| from one tick to the next [N] > 0
  double speed = 0.6;                     ///< of the hand, over 20 ms [m/s] > 0
  double acceleration = 25.0;             ///< of the hand, by the encoders over 40 ms [m/s²] > 0
  Vector2d workspace_low = {-1.0, -1.0};  ///< corner of the rectangle that the hand must not leave [m], base frame
  Vector2d workspace_high = {1.0, 1.0};   ///< the other corner [m]
  double joint_margin = 0.0349;           ///< to the joints' limits: 2° [rad] ≥ 0
  double excursion = 0.08;                ///< of the hand from home while it is perturbed [m]; 0: not checked
  double tracking = 0.1745;               ///< |θ_r − θ| of a joint that follows a position: 10° [rad] > 0
  double encoder_jump = 0.02;             ///< from one tick to the next [rad] > 0
  double frozen_sensor = 0.25;            ///< longest time that a reading is constant [s]; 0: not checked
  double frozen_sensor_torque = 0.3;      ///< an encoder may rest while its torque changes by less [N·m] > 0
  double accelerometer = 4.0;  ///< |encoders' − accelerometer's|, over 40 ms; over 0.5 s less [m/s²]; 0: not checked
  double link_silence = 0.01;  ///< longest time without a new state [s] > 0
  double lateness = 0.02;      ///< of a command after the previous one, beyond a tick [s]; 0: not checked
  double answer_lag = 0.02;    ///< age of the command that the robot obeys [s]; 0: not checked
  double state_age = 0.02;     ///< of a state, by the robot's clock [s]; 0: not checked
  double motors_reply = 0.1;   ///< longest time that the robot may report "motors off" while driven [s] > 0
  double motors_off = 0.5;     ///< after the stop, until the robot must have confirmed its motors off [s] > 0
  double torque_error = 0.5;   ///< of the motors' torque, as drives or motion show it, against the command [N·m];
                               ///< 0: not checked
  double off_torque = 0.1;     ///< maximum that drives may measure with the motors off [N·m] > 0
};

/// Maximum distance of a workspace corner from the base [m]: no robot for an arm reaches farther.
inline constexpr double kLargestWorkspace = 4.0;

/// A limit in a file, in the unit of its key.
struct LimitKey {
  std::string_view key;  ///< "link_silence_ms"
  std::variant<double Limits::*, Vector2d Limits::*> member;
  double scale;          ///< from SI to the unit of the key
  double most;           ///< maximum: a larger value would not limit
  std::string_view why;  ///< what may happen below the limit: "the robot is driven without feedback"
  bool may_be_off = false;
  bool less_is_weaker = false;

  /// In the unit of the key; the larger of two joints.
  [[nodiscard]] double of(const Limits& limits) const;
};

/// Every limit but the workspace, in the order of Limits.
[[nodiscard]] std::span<const LimitKey> limit_keys();

/// Limits that are off or weaker than the defaults: "link_silence_ms = 500 (default 10): the robot is driven without
/// feedback".
[[nodiscard]] std::vector<std::string> weakened(const Limits& limits);

/// All of them as one line: "handle_force_N=20 joint_torque_Nm=6,6 …".
[[nodiscard]] std::string text_of(const Limits& limits);

/// @fails  usage: a limit is out of its range, with its key and why; the rectangle is empty.
[[nodiscard]] Result<void> check(const Limits& limits);

}  // namespace mbk::safety
