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

/// A trip brings the torque to zero along a straight line in so many ticks; then the drives are off.
inline constexpr int kRampTicks = 20;

/// What the gate is told at a tick: all of it as it came, nothing believed.
struct Observation {
  double time = 0.0;                      ///< on the loop's clock [s]
  double late = 0.0;                      ///< time since the last command left, beyond a tick [s]
  device::State state;                    ///< the newest of the robot
  bool fresh = true;                      ///< it has come since the last tick
  bool link = true;                       ///< the link says that it works
  bool operator_stop = false;             ///< key or console
  bool recording = true;                  ///< what is recorded reaches the disk in time
  device::Abilities robot;                ///< what it can say, and what is fitted
  bool perturbing = false;                ///< the hand shall be about home
  bool follows = false;                   ///< the joints shall be at `joint_reference`
  Vector2d joint_reference = {0.0, 0.0};  ///< [rad]
};

/// The last gate before the motors: every torque passes it, and nothing is behind it but the device. It believes
/// neither controller nor sensors nor robot. What a controller asks for is cut to the limits of force, torque and their
/// rate; what must not be trips: the torque goes to zero in kRampTicks, the reason stays, and only `reset` leads back.
/// The commanded handle force is |J⁻ᵀτ| with J of the last plausible angles. After `create` nothing allocates.
///   A command is not a fact. While it drives, the gate holds the robot's acknowledgement, its flags and clock against
/// what was commanded, and the torque that encoders and force sensor show,
///   τ = I θ̈ + C θ̇ + F_r − Jᵀ F_h                                              (Dyck 2013, eq. 5.1)
/// against the torque that left, mean over 40 ms and then over kTorqueTime. Once motors are off by command it waits for
/// the robot to confirm it (MotorsOff): motors off by its flag, an answer to the first such command or a later one, a
/// new state, and no torque in the motion. What is not confirmed in time trips.
///   A software limit, no certified safety function: a stop button that cuts the motors' power has to be there too.
class Gate {
 public:
  /// What it decided at a tick.
  struct Decision {
    Vector2d torque = {0.0, 0.0};  ///< [N·m]
    bool enabled = false;          ///< drives on
    bool cut = false;              ///< the controller asked for more
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

  /// Once for each command: what it decides has to leave.   @param asked  τ of the controller [N·m]
  Decision step(const Observation& seen, const Vector2d& asked) noexcept;

  /// The trial is over: motors off from the next step on, without a trip.
  void release() noexcept { released_ = true; }

  [[nodiscard]] bool tripped() const { return trip_.reason != Reason::none; }
  [[nodiscard]] const Trip& trip() const { return trip_; }  ///< Reason::none where there is none
  /// The ramp of a trip is over, or the trial was released.
  [[nodiscard]] bool off() const { return released_ || (tripped() && ramp_left_ == 0); }
  /// What is known of the motors since then.
  [[nodiscard]] const MotorsOff& motors() const { return motors_; }
  /// Off, and known or given up.
  [[nodiscard]] bool settled() const {
    return motors_.state != MotorsOff::State::not_asked && motors_.state != MotorsOff::State::waiting;
  }

  /// What was seen of the robot between two trials.
  void see_idle(bool stop_button, bool confirmed_off) noexcept;

  /// By the operator: on again, with nothing remembered of the motion.
  /// @fails  usage: the ramp is not over; the stop button is still pressed; the robot still does not say that its
  ///         motors are off.
  [[nodiscard]] Result<void> reset();

  /// The last two seconds, oldest first; fewer at the beginning. Not for the loop: allocates.
  [[nodiscard]] std::vector<Moment> history() const;

 private:
  /// How long a reading has been the same.
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
