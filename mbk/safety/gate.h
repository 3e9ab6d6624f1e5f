#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mbk/core/result.h"
#include "mbk/robot/kinematics.h"
#include "mbk/safety/limits.h"
#include "mbk/safety/trip.h"

namespace mbk::safety {

/// A trip brings the torque to zero along a straight line in so many ticks; then the drives are off.
inline constexpr int kRampTicks = 20;

/// What the gate is told at a tick: all of it as it came, nothing believed.
struct Observation {
  double time = 0.0;                   ///< on the loop's clock [s]
  bool fresh = true;                   ///< a new state has come since the last tick
  bool link = true;                    ///< the link says that it works
  bool stop_button = false;            ///< of the robot
  bool operator_stop = false;          ///< key or console
  bool recording = true;               ///< what is recorded reaches the disk in time
  double late = 0.0;                   ///< by how much the tick came late [s]; 0 for a robot that waits
  Vector2d joint = {0.0, 0.0};         ///< [rad]
  Vector2d force = {0.0, 0.0};         ///< of the hand on the robot, base frame [N]
  Vector2d acceleration = {0.0, 0.0};  ///< of the hand, base frame [m/s²]
  bool has_force = true;
  bool has_acceleration = true;
  bool follows = false;                   ///< the joints shall be at `joint_reference`
  Vector2d joint_reference = {0.0, 0.0};  ///< [rad]
  bool perturbing = false;                ///< the hand shall be about home
};

/// The last gate before the motors: every torque passes it, and nothing is behind it but the device. It believes
/// neither controller nor sensors. What a controller asks for is cut to the limits of force, torque and their rate;
/// what must not be trips: the torque goes to zero in kRampTicks, the reason stays, and only `reset` leads back. The
/// commanded handle force is |J⁻ᵀτ| with J of the last plausible angles. After `create` nothing allocates.
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
  [[nodiscard]] static Result<Gate> create(const Limits& limits, const robot::Geometry& geometry, const Vector2d& home,
                                           double sample_time);

  /// @param asked  τ of the controller [N·m]
  Decision step(const Observation& seen, const Vector2d& asked) noexcept;

  [[nodiscard]] bool tripped() const { return trip_.reason != Reason::none; }
  [[nodiscard]] const Trip& trip() const { return trip_; }  ///< Reason::none where there is none
  /// The ramp of a trip is over.
  [[nodiscard]] bool off() const { return tripped() && ramp_left_ == 0; }

  /// By the operator: on again, with nothing remembered of the motion.
  /// @fails  usage: the ramp is not over; the stop button was still pressed at the last tick.
  [[nodiscard]] Result<void> reset();

  /// The last two seconds, oldest first; fewer at the beginning. Not for the loop: allocates.
  [[nodiscard]] std::vector<Moment> history() const;

 private:
  static constexpr int kWindow = 20;  // ticks of speed and of half the acceleration

  /// How long a reading has been the same.
  struct Stillness {
    Vector2d last = {0.0, 0.0};
    int ticks = 0;
    bool begun = false;
    void see(const Vector2d& value) noexcept;
  };

  Gate(const Limits& limits, const robot::Geometry& geometry, const Vector2d& home, double sample_time);
  void forget() noexcept;
  void trip(Reason reason, const Observation& seen, double value = 0.0, double limit = 0.0) noexcept;
  void check(const Observation& seen, const Vector2d& asked) noexcept;
  bool check_readings(const Observation& seen) noexcept;
  bool check_stillness(const Observation& seen, const Vector2d& asked) noexcept;
  bool check_motion(const Observation& seen) noexcept;
  [[nodiscard]] Vector2d cut(const Vector2d& asked, bool& was_cut) const noexcept;
  bool beyond(Reason reason, const Observation& seen, double value, double limit) noexcept;

  Limits limits_;
  robot::Geometry geometry_;
  Vector2d home_;
  double sample_time_;
  std::uint64_t ticks_ = 0;

  Trip trip_;
  Vector2d sent_ = {0.0, 0.0}, ramp_from_ = {0.0, 0.0};
  int ramp_left_ = 0, silent_ticks_ = 0;
  double cut_for_ = 0.0;  // [s]
  bool stop_pressed_ = false;

  bool seen_before_ = false;
  Vector2d joint_ = {0.0, 0.0}, force_ = {0.0, 0.0};  // last plausible ones
  Stillness force_still_, acceleration_still_;
  std::array<int, 2> encoder_still_ = {0, 0};
  Vector2d torque_low_ = {0.0, 0.0}, torque_high_ = {0.0, 0.0};  // while the encoders stand still

  std::array<Vector2d, 2 * kWindow + 1> hand_{}, accelerometer_{};  // rings, newest at `at_`
  int at_ = 0, filled_ = 0;
  double disagreement_ = 0.0, liveliness_ = 0.0;  // mean squares of accelerations [m²/s⁴]

  std::vector<Moment> history_;  // ring
  std::size_t next_moment_ = 0, moments_ = 0;
};

}  // namespace mbk::safety
