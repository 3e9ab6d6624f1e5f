#pragma once

#include <optional>
#include <type_traits>

#include "mbk/model/robot/capstan.h"
#include "mbk/model/robot/dynamics.h"
#include "mbk/model/robot/one_axis_robot.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::laboratory {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The robot with this number of axes.
template <int Axes>
using RobotOf = std::conditional_t<Axes == 1, robot::OneAxisRobot, robot::PlanarRobot>;
template <int Axes>
using GeometryOf = decltype(RobotOf<Axes>::geometry);

/// Energies since the start [J]. For a rigid drive, and any load,
///   absorbed = motors − viscous − dry − (kinetic − kinetic at the beginning)
/// and with elastic cables also − cables − elastic.
struct EnergyLedger {
  double motors = 0.0;    ///< ∫ τ·θ̇_m dt, the work of the motors
  double absorbed = 0.0;  ///< −∫ (F_h·v + moment θ̇₂) dt, absorbed by load and handle
  double viscous = 0.0;   ///< lost in the viscous part of the joints' friction
  double dry = 0.0;       ///< lost in its Coulomb and Stribeck part
  double cables = 0.0;    ///< lost in the damping of the cables
};

/// The exact state at one instant of a tick, as read by perfect sensors. Base frame. For a robot of one axis everything
/// is along it: rad and N·m, or m and N.
template <int Axes>
struct TrueState {
  using Values = AxisVector<Axes>;
  double time = 0.0;                            ///< [s]
  Values theta = Values::Zero();                ///< joint angles of the links [rad]
  Values theta_rate = Values::Zero();           ///< [rad/s]
  Values motor_angle = Values::Zero();          ///< at the encoders; `theta` for a rigid drive [rad]
  Values position = Values::Zero();             ///< of the hand [m]
  Values velocity = Values::Zero();             ///< [m/s]
  Values acceleration = Values::Zero();         ///< [m/s²]
  Values force_hand_on_robot = Values::Zero();  ///< at the sensor, including the handle beyond it [N]
  Values motor_torque = Values::Zero();         ///< held during the tick [N·m]
  double kinetic_energy = 0.0;                  ///< of the robot up to the sensor, motors included [J]
  double elastic_energy = 0.0;                  ///< of the cables [J]
  EnergyLedger energy;
};

/// A robot with a load at its handle, integrated in joint angles by the classical fourth-order Runge–Kutta method with
/// the motor torque held over each tick. The energies are integrated with the motion. Nothing allocates.
///
///   [I + Jᵀ(Λ + m_h) J] θ̈ = τ − F_r − C θ̇ − Jᵀ[(Λ + m_h) J̇ θ̇ + h] + [0, moment]ᵀ,   F_h = −[(Λ + m_h) ẍ + h]
///
/// with Λ and h of the load (participant/load.h) and m_h the handle beyond the force sensor. With one axis J = 1, C =
/// 0.
template <int Axes>
class ClosedLoop {
 public:
  using Values = AxisVector<Axes>;
  struct Options {
    RobotOf<Axes> robot;
    std::optional<robot::ElasticDrive<Axes>> capstan;  ///< elastic drives, if given
    double handle_mass = 0.0;                          ///< m_h, beyond the force sensor [kg] ≥ 0
    int steps_per_tick = 1;                            ///< Runge–Kutta steps in each tick ≥ 1
  };

  /// At rest with the hand at `home` [m]. `load` must outlive the loop.
  /// @fails  usage: home is out of reach; a mass, inertia, stiffness or friction is negative or not finite; the inertia
  /// of the motors leaves none for the links; steps_per_tick < 1.
  [[nodiscard]] static Result<ClosedLoop> create(const Options& options, const Values& home,
                                                 participant::Load<Axes>& load, double start_time = 0.0);

  /// Angles at the encoders [rad], available to a controller before it decides.
  [[nodiscard]] Values motor_angle() const { return state_.template segment<Axes>(kMotorAngle); }

  /// Current time of the loop [s].
  [[nodiscard]] double time() const { return time_; }

  /// The current instant before a controller decides, with the previous motor torque.
  [[nodiscard]] TrueState<Axes> state() const;

  /// Begins a tick of length T [s]: the load decides, the torque takes effect. Force and acceleration jump with the
  /// torque; the mean of before and after is returned, as seen by a sensor with less bandwidth than the tick rate:
  /// either limit would be half a tick off the motion.
  const TrueState<Axes>& hold(const Values& motor_torque, double sample_time);

  /// Advances to the end of the tick. Neither torque nor load may change between `hold` and this.
  void advance();

 private:
  static constexpr int kTheta = 0, kRate = Axes, kMotorAngle = 2 * Axes, kMotorRate = 3 * Axes, kEnergy = 4 * Axes,
                       kSize = kEnergy + 5;
  using State = Eigen::Matrix<double, kSize, 1>;

  ClosedLoop(const Options& options, const Values& theta, participant::Load<Axes>& load, double start_time);

  /// Quantities that depend only on the state, not on load and motors.
  struct Mechanics {
    Values theta, rate, motor_angle, motor_rate;
    participant::HandState<Axes> hand;
    AxisMatrix<Axes> J;             ///< of the hand [m]
    Values convective;              ///< J̇ θ̇ [m/s²]
    AxisMatrix<Axes> inertia;       ///< I, without motors behind a cable [kg·m²]
    Values coriolis;                ///< C θ̇ [N·m]
    Values friction;                ///< F_r [N·m]
    Values cable = Values::Zero();  ///< s [N·m]
    double cable_loss = 0.0;        ///< in its damping [W]
  };
  Mechanics mechanics(const State& state) const;
  State derivative(const State& state, const Mechanics& now, TrueState<Axes>* seen = nullptr) const;
  State derivative(const State& state) const { return derivative(state, mechanics(state)); }

  Options options_;
  participant::Load<Axes>* load_;
  double time_;
  double sample_time_ = 0.0;
  Values torque_ = Values::Zero();
  State state_ = State::Zero();
  State change_ = State::Zero();  ///< of the state after `hold`
  TrueState<Axes> true_state_;
};

extern template class ClosedLoop<1>;
extern template class ClosedLoop<2>;

}  // namespace mbk::laboratory
