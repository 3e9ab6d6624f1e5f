#pragma once

#include <Eigen/Core>

#include "mbk/model/impedance/model.h"

namespace mbk::participant {

/// Where the handle is and how it moves, base frame.
struct HandState {
  Eigen::Vector2d position = {0.0, 0.0};  ///< [m]
  Eigen::Vector2d velocity = {0.0, 0.0};  ///< [m/s]
  double rotation = 0.0;                  ///< of the last link, θ₂ [rad]
  double rotation_rate = 0.0;             ///< [rad/s]
};

/// What a load asks of the hand in one state: it takes the force  Λ ẍ + h  [N] from the robot, so that
///   F_h = −(Λ ẍ + h)
/// is what it exerts on the robot, and exerts the moment `moment` on the last link.
struct LoadDynamics {
  Eigen::Matrix2d inertia = Eigen::Matrix2d::Zero();  ///< Λ, symmetric positive semidefinite [kg]
  Eigen::Vector2d bias = {0.0, 0.0};                  ///< h: damping, stiffness, Coriolis, minus voluntary force [N]
  double moment = 0.0;                                ///< about the hand, on the last link [N·m]
};

/// Something that hangs at the handle beyond the force sensor: a limb, a spring rig, another robot, or nothing.
/// It decides (reflexes, will, noise) once a control tick and is a pure function of the hand's state in between. No
/// call allocates.
class Load {
 public:
  virtual ~Load() = default;

  /// The tick at time t [s] begins. `force_on_robot` [N] is what the load exerted at the tick before.
  /// @param sample_time  T [s]
  virtual void tick(double t, double sample_time, const HandState& hand, const Eigen::Vector2d& force_on_robot);

  /// Λ, h and the moment in a state, with what the last tick decided.
  [[nodiscard]] virtual LoadDynamics dynamics(const HandState& hand) const = 0;

  /// The intrinsic impedance for small motions about a place, without will, reflexes or noise: the truth that
  /// measurements are compared with. x₀ is where the load would rest.
  [[nodiscard]] virtual impedance::Model impedance(const Eigen::Vector2d& hand) const = 0;

 protected:  // copied only as what they are
  Load() = default;
  Load(const Load&) = default;
  Load(Load&&) = default;
  Load& operator=(const Load&) = default;
  Load& operator=(Load&&) = default;
};

}  // namespace mbk::participant
