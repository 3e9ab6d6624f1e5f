#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/experiment/safety/limits.h"
#include "mbk/experiment/safety/motion_window.h"
#include "mbk/experiment/safety/motors_off.h"
#include "mbk/experiment/safety/robot_reports.h"
#include "mbk/experiment/safety/trip.h"
#include "mbk/model/robot/dynamics.h"

namespace mbk::safety {

/// Ticks in which a trip reduces the torque linearly to zero; then the drives are switched off.
inline constexpr int kRampTicks = 20;

/// Input of the gate at a tick, unchecked.
struct Observation {
  double time = 0.0;                      ///< on the loop's clock [s]
  double late = 0.0;                      ///< time since the last command left, beyond a tick [s]
  device::State state;                    ///< the robot's newest
  bool fresh = true;                      ///< it arrived since the last tick
  bool link = true;                       ///< the link reports that it works
  bool operator_stop = false;             ///< key or console
  bool recording = true;                  ///< recorded data reach the disk in time
  device::Abilities robot;                ///< what it reports, and which sensors are fitted
  bool perturbing = false;                ///< the hand must stay near home
  bool follows = false;                   ///< the joints must follow `joint_reference`
  Vector2d joint_reference = {0.0, 0.0};  ///< [rad]
};

/// The last check before the motors: every torque passes it, directly before the device. It trusts neither controller
/// nor sensors nor robot. The controller's torque is cut to the limits of force, torque and torque rate. A violation
/// trips: the torque goes to zero in kRampTicks, the reason stays, and only `reset` continues.
/// The commanded handle force is |J⁻ᵀτ| with J of the last plausible angles. After `create` nothing allocates.
///   A command is not a fact. While driving, the gate compares the robot's acknowledgement, flags and clock with the
/// commands, and the torque that encoders and force sensor show,
///   τ = I θ̈ + C θ̇ + F_r − Jᵀ F_h                                              (Dyck 2013, eq. 5.1)
/// with the commanded torque, mean over 40 ms and then over kTorqueTime. After commanding the motors off it waits for
/// the robot's confirmation (MotorsOff): the flag "motors off", an acknowledgement of the first such command or a later
/// one, a new state, and no torque in the motion. A missing confirmation trips.
///   This is a software limit, not a certified safety function: a stop button that cuts the motors' power is required
/// too.
class Gate {
 public:
  /// The decision at a tick.
  struct Decision {
    Vector2d torque = {0.0, 0.0};  ///< [N·m]
    bool enabled = false;          ///< drives on
    bool cut = false;              ///< the controller requested more
  };

  /// A tick of the last two seconds.
  struct Moment {
    Observation seen;
    Vector2d asked = {0.0, 0.0};  ///< [N·m]
    Decision decision;
  };

  /// @param home  the test location [m], base frame   @param sample_time  [s] > 0
  /// @fails  usage: as check(limits); sample_time is not above zero.
  [[nodiscard]] static Result<Gate> create(const Limits& limits, const robot::PlanarRobot& robot, const Vector2d& home,
                                           double sample_time);

  /// Once for each command: the decision must be sent.   @param asked  τ of the controller [N·m]
  Decision step(const Observation& seen, const Vector2d& asked) noexcept;

  /// The trial is over: motors off from the next step on, without a trip.
  void release() noexcept { released_ = true; }

  [[nodiscard]] bool tripped() const { return trip_.reason != Reason::none; }
  [[nodiscard]] const Trip& trip() const { return trip_; }  ///< Reason::none where there is none
  /// The ramp of a trip is over, or the trial was released.
  [[nodiscard]] bool off() const { return released_ || (tripped() && ramp_left_ == 0); }
  /// State of the motors since then.
  [[nodiscard]] const MotorsOff& motors() const { return motors_; }
  /// Off, and either confirmed or given up.
  [[nodiscard]] bool settled() const {
    return motors_.state != MotorsOff::State::not_asked && motors_.state != MotorsOff::State::waiting;
  }

  /// The robot's state between two trials.
  void see_idle(bool stop_button, bool confirmed_off) noexcept;

  /// By the operator: on again, with the motion forgotten.
  /// @fails  usage: the ramp is not over; the stop button is still pressed; the robot still does not confirm its
  ///         motors off.
  [[nodiscard]] Result<void> reset();

  /// The last two seconds, oldest first; fewer at the beginning. Not for the loop: allocates.
  [[nodiscard]] std::vector<Moment> history() const;

 private:
  /// How long a reading has been constant.
  struct Stillness {
    Vector2d last = {0.0, 0.0};
    int ticks = 0;
    bool begun = false;
    void see(const Vector2d& value) noexcept;
  };

  Gate(const Limits& limits, const robot::PlanarRobot& robot, const Vector2d& home, double sample_time);
  void forget() noexcept;
  void trip(Reason reason, const Observation& seen, double value = 0.0, double limit = 0.0) noexcept;
  void check(const Observation& seen, const Vector2d& asked) noexcept;
  bool check_readings(const Observation& seen) noexcept;
  bool check_stillness(const Observation& seen, const Vector2d& asked) noexcept;
  bool check_motion(const Observation& seen) noexcept;
  bool check_accelerometer(const Observation& seen, const MotionWindow::Means& means) noexcept;
  bool check_torque(const Observation& seen, const MotionWindow::Means& means) noexcept;
  bool check_drives(const Observation& seen) noexcept;
  void confirm_off(const Observation& seen) noexcept;
  [[nodiscard]] MotorsOff::Why missing_for_off(const Observation& seen) noexcept;
  bool add_motion(const Observation& seen, double time) noexcept;
  [[nodiscard]] Vector2d torque_shown(const MotionWindow::Means& means) const noexcept;
  [[nodiscard]] const Vector2d& told(std::uint64_t command) const noexcept;
  [[nodiscard]] Vector2d cut(const Vector2d& asked, bool& was_cut) const noexcept;
  bool beyond(Reason reason, const Observation& seen, double value, double limit) noexcept;

  Limits limits_;
  robot::PlanarRobot robot_;
  Vector2d home_;
  double sample_time_;
  std::uint64_t ticks_ = 0;  // steps begun: of them all but the running one have left as commands

  Trip trip_;
  Vector2d sent_ = {0.0, 0.0}, ramp_from_ = {0.0, 0.0};
  int ramp_left_ = 0;
  bool released_ = false;
  double fresh_at_ = 0.0;  // [s]
  double cut_for_ = 0.0;   // [s]
  bool stop_pressed_ = false;

  MotorsOff motors_;
  std::uint64_t off_command_ = 0;  // the first one with motors off
  double off_at_ = 0.0;            // [s]

  bool seen_before_ = false;
  Vector2d joint_ = {0.0, 0.0}, force_ = {0.0, 0.0};  // last plausible ones
  double stamp_ = 0.0, step_ = 0.0;                   // of them, on the robot's clock, and since those before [s]
  Stillness force_still_, acceleration_still_;
  std::array<int, 2> encoder_still_ = {0, 0};
  Vector2d torque_low_ = {0.0, 0.0}, torque_high_ = {0.0, 0.0};  // while the encoders stand still

  ReportCheck reports_;
  MotionWindow motion_;
  double disagreement_ = 0.0, liveliness_ = 0.0;  // mean squares of accelerations [m²/s⁴]
  Vector2d unexplained_ = {0.0, 0.0};             // mean torque that the motion shows beside the command [N·m]
  double drives_wrong_ = 0.0;                     // how long the drives have measured another torque [s]

  static constexpr std::size_t kTold = 128;
  std::array<Vector2d, kTold> told_{};  // ring of the torques that left, by number of the command

  std::vector<Moment> history_;  // ring
  std::size_t next_moment_ = 0, moments_ = 0;
};

}  // namespace mbk::safety
