#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/robot/friction.h"
#include "mbk/simulate/participant/one_axis_load.h"

namespace mbk::laboratory {

/// Everything about one instant of a tick of the one-axis machine, exactly.
struct OneAxisTrueState {
  double time = 0.0;      ///< [s]
  double position = 0.0;  ///< [rad or m]
  double velocity = 0.0;
  double acceleration = 0.0;
  double reaction = 0.0;    ///< what the limb exerts on the machine [N·m or N]
  double motor = 0.0;       ///< torque or force of the motor, held during the tick
  double work_motor = 0.0;  ///< ∫ motor · velocity dt [J]
  double absorbed = 0.0;    ///< −∫ reaction · velocity dt, by the limb [J]
  double lost = 0.0;        ///< in the machine's friction [J]
};

/// A machine of one axis with a limb on it, (j_m + j) ẍ = u − F_r(ẋ) − h, integrated by the classical fourth-order
/// Runge–Kutta method with the motor held over each tick.
class OneAxisLoop {
 public:
  struct Machine {
    double inertia = 0.02;          ///< j_m [kg·m² or kg] > 0
    robot::JointFriction friction;  ///< of the axis
    int steps_per_tick = 1;         ///< ≥ 1
  };
  /// Servo of the axis: u = K_p (r − x) + K_d (ṙ − ẋ); gains of zero and a force command leave it open loop.
  struct Servo {
    double proportional = 800.0;   ///< K_p [N·m/rad or N/m] ≥ 0
    double derivative = 12.0;      ///< K_d ≥ 0
    Hertz velocity_cutoff{200.0};  ///< of the velocity estimate
  };

  /// At rest at `position`. `load` must outlive the loop.
  /// @fails  usage: an inertia is not above zero; steps_per_tick < 1; a friction is negative.
  [[nodiscard]] static Result<OneAxisLoop> create(const Machine& machine, double position,
                                                  participant::OneAxisLoad& load, double start_time);

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double position() const { return state_.position; }

  /// What perfect sensors read at this instant, before a controller decides: with the motor as it is still held.
  struct Reading {
    double position = 0.0, velocity = 0.0, acceleration = 0.0;
    double reaction = 0.0;  ///< what the limb exerts on the machine [N·m or N]
  };
  [[nodiscard]] Reading read() const;

  /// Begins a tick of length T [s]. Acceleration and reaction, which jump with the motor, are the means of before and
  /// after, as in ClosedLoop::hold.
  const OneAxisTrueState& hold(double motor, double sample_time);
  /// Moves on to the end of the tick.
  void advance();

 private:
  struct Change {
    double velocity, acceleration, work_motor, absorbed, lost;
  };
  OneAxisLoop(const Machine& machine, double position, participant::OneAxisLoad& load, double start_time);
  [[nodiscard]] double reaction(double acceleration) const;
  [[nodiscard]] Change change(const participant::JointState& state) const;

  Machine machine_;
  participant::OneAxisLoad* load_;
  double time_, sample_time_ = 0.0, motor_ = 0.0;
  participant::JointState state_;
  OneAxisTrueState seen_;
};

}  // namespace mbk::laboratory
