#pragma once

#include "mbk/base/core/axes.h"
#include "mbk/model/impedance/model.h"

namespace mbk::participant {

/// Where the handle is and how it moves: with two axes the hand in the base frame, with one the robot's angle or place
/// [rad or m].
template <int Axes>
struct HandState {
  AxisVector<Axes> position = AxisVector<Axes>::Zero();  ///< [m]
  AxisVector<Axes> velocity = AxisVector<Axes>::Zero();  ///< [m/s]
  double rotation = 0.0;                                 ///< of the last link, θ₂ [rad]
  double rotation_rate = 0.0;                            ///< [rad/s]
};

/// What a load asks of the hand in one state: it takes the force  Λ ẍ + h  [N] from the robot, so that
///   F_h = −(Λ ẍ + h)
/// is what it exerts on the robot, and exerts the moment `moment` on the last link. With one axis that turns, kg·m² and
/// N·m.
template <int Axes>
struct LoadDynamics {
  AxisMatrix<Axes> inertia = AxisMatrix<Axes>::Zero();  ///< Λ, symmetric positive semidefinite [kg]
  AxisVector<Axes> bias = AxisVector<Axes>::Zero();     ///< h: damping, stiffness, Coriolis, minus voluntary force [N]
  double moment = 0.0;                                  ///< about the hand, on the last link [N·m]
};

/// Something that hangs at the handle beyond the force sensor: a limb, a joint such as ankle or elbow, a spring rig,
/// another robot, or nothing. It decides (reflexes, voluntary control, noise) once a control tick and is a pure
/// function of the hand's state in between. `tick` and `dynamics` do not allocate.
template <int Axes>
class Load {
 public:
  virtual ~Load() = default;

  /// The tick at time t [s], of length `sample_time` [s], begins. `force_on_robot` [N] is what the load exerted at the
  /// tick before.
  virtual void tick(double /*t*/, double /*sample_time*/, const HandState<Axes>& /*hand*/,
                    const AxisVector<Axes>& /*force_on_robot*/) {}

  /// Λ, h and the moment in a state, with what the last tick decided.
  [[nodiscard]] virtual LoadDynamics<Axes> dynamics(const HandState<Axes>& hand) const = 0;

  /// The intrinsic impedance for small motions about a place, without voluntary control, reflexes or noise: the truth
  /// that measurements are compared with. x₀ is where the load would rest.
  [[nodiscard]] virtual impedance::Model impedance(const AxisVector<Axes>& hand) const = 0;

 protected:  // copied only as what they are
  Load() = default;
  Load(const Load&) = default;
  Load(Load&&) = default;
  Load& operator=(const Load&) = default;
  Load& operator=(Load&&) = default;
};

}  // namespace mbk::participant
