#pragma once

#include <optional>

#include "mbk/model/robot/capstan.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::laboratory {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Energies since the beginning [J]. For a rigid drive, and any load,
///   absorbed = motors − viscous − dry − (kinetic − kinetic at the beginning)
/// and with elastic cables also − cables − elastic.
struct EnergyLedger {
  double motors = 0.0;    ///< ∫ τ·θ̇_m dt, the work of the motors
  double absorbed = 0.0;  ///< −∫ (F_h·v + moment θ̇₂) dt, what the load and the handle took
  double viscous = 0.0;   ///< lost in the viscous part of the joints' friction
  double dry = 0.0;       ///< lost in its Coulomb and Stribeck part
  double cables = 0.0;    ///< lost in the damping of the cables
};

/// Everything about one instant of a tick, exactly: what sensors would read if they were perfect. Base frame.
struct TrueState {
  double time = 0.0;                          ///< [s]
  Vector2d theta = {0.0, 0.0};                ///< joint angles of the links [rad]
  Vector2d theta_rate = {0.0, 0.0};           ///< [rad/s]
  Vector2d motor_angle = {0.0, 0.0};          ///< where the encoders sit; `theta` for a rigid drive [rad]
  Vector2d position = {0.0, 0.0};             ///< of the hand [m]
  Vector2d velocity = {0.0, 0.0};             ///< [m/s]
  Vector2d acceleration = {0.0, 0.0};         ///< [m/s²]
  Vector2d force_hand_on_robot = {0.0, 0.0};  ///< at the sensor, so with the handle beyond it [N]
  Vector2d motor_torque = {0.0, 0.0};         ///< held during the tick [N·m]
  double kinetic_energy = 0.0;                ///< of the robot up to the sensor, motors included [J]
  double elastic_energy = 0.0;                ///< of the cables [J]
  EnergyLedger energy;
};

/// A planar robot with a load at its handle, integrated in joint angles by the classical fourth-order Runge–Kutta
/// method with the motor torque held over each tick. The energies are integrated with the motion. Nothing allocates.
///
///   [I + Jᵀ(Λ + m_h) J] θ̈ = τ − F_r − C θ̇ − Jᵀ[(Λ + m_h) J̇ θ̇ + h] + [0, moment]ᵀ,   F_h = −[(Λ + m_h) ẍ + h]
///
/// with Λ and h of the load (participant/load.h) and m_h the handle beyond the force sensor.
class ClosedLoop {
 public:
  struct Options {
    robot::PlanarRobot robot;
    std::optional<robot::Capstan> capstan;  ///< elastic drives, where given
    double handle_mass = 0.0;               ///< m_h, beyond the force sensor [kg] ≥ 0
    int steps_per_tick = 1;                 ///< Runge–Kutta steps in each tick ≥ 1
  };

  /// At rest with the hand at `home` [m]. `load` must outlive the loop.
  /// @fails  usage: home is out of reach; a mass, inertia, stiffness or friction is negative or not finite; the motors'
  ///         inertia leaves the links none; steps_per_tick < 1.
  [[nodiscard]] static Result<ClosedLoop> create(const Options& options, const Vector2d& home, participant::Load& load,
                                                 double start_time = 0.0);

  /// Angles at the encoders [rad]: what a controller may know before it decides.
  [[nodiscard]] Vector2d motor_angle() const { return state_.segment<2>(kMotorAngle); }

  /// Where the loop stands [s].
  [[nodiscard]] double time() const { return time_; }

  /// Begins a tick of length T [s]: the load decides, the torque takes effect. Force and acceleration jump with the
  /// torque; what is given is the mean of before and after, as a sensor of less bandwidth than the tick rate sees them:
  /// either limit would be half a tick off the motion.
  const TrueState& hold(const Vector2d& motor_torque, double sample_time);

  /// Moves on to the end of the tick.
  void advance();

 private:
  static constexpr int kTheta = 0, kRate = 2, kMotorAngle = 4, kMotorRate = 6, kEnergy = 8, kSize = 13;
  using State = Eigen::Matrix<double, kSize, 1>;

  ClosedLoop(const Options& options, const Vector2d& theta, participant::Load& load, double start_time);
  State derivative(const State& state, TrueState* seen = nullptr) const;

  Options options_;
  participant::Load* load_;
  double time_;
  double sample_time_ = 0.0;
  Vector2d torque_ = {0.0, 0.0};
  State state_ = State::Zero();
  TrueState true_state_;
};

}  // namespace mbk::laboratory
