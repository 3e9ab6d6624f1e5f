#pragma once

#include "mbk/base/core/axes.h"
#include "mbk/model/impedance/model.h"

namespace mbk::participant {

/// Position and motion of the handle: with two axes the hand in the base frame, with one the angle or position of the
/// robot [rad or m].
template <int Axes>
struct HandState {
  AxisVector<Axes> position = AxisVector<Axes>::Zero();  ///< [m]
  AxisVector<Axes> velocity = AxisVector<Axes>::Zero();  ///< [m/s]
  double rotation = 0.0;                                 ///< of the last link, θ₂ [rad]
  double rotation_rate = 0.0;                            ///< [rad/s]
};

/// Dynamics of a load in one state: it takes the force  Λ ẍ + h  [N] from the robot, so that
///   F_h = −(Λ ẍ + h)
/// is the force that it exerts on the robot, and exerts the moment `moment` on the last link. With one axis that turns,
/// kg·m² and N·m.
template <int Axes>
struct LoadDynamics {
  AxisMatrix<Axes> inertia = AxisMatrix<Axes>::Zero();  ///< Λ, symmetric positive semidefinite [kg]
  AxisVector<Axes> bias = AxisVector<Axes>::Zero();     ///< h: damping, stiffness, Coriolis, minus voluntary force [N]
  double moment = 0.0;                                  ///< about the hand, on the last link [N·m]
};

/// A load at the handle beyond the force sensor: a limb, a joint such as ankle or elbow, a spring rig, another robot,
/// or nothing. It decides (reflexes, voluntary control, noise) once per control tick and is a pure function of the hand
/// state in between. `tick` and `dynamics` do not allocate.
template <int Axes>
class Load {
 public:
  virtual ~Load() = default;

  /// The tick at time t [s], of length `sample_time` [s], begins. `force_on_robot` [N] is the force of the load at the
  /// previous tick.
  virtual void tick(double /*t*/, double /*sample_time*/, const HandState<Axes>& /*hand*/,
                    const AxisVector<Axes>& /*force_on_robot*/) {}

  /// Λ, h and the moment in a state, with the decisions of the last tick.
  [[nodiscard]] virtual LoadDynamics<Axes> dynamics(const HandState<Axes>& hand) const = 0;

  /// The intrinsic impedance for small motions about a position, without voluntary control, reflexes or noise: the true
  /// values for comparison with measurements. x₀ is the rest position of the load.
  [[nodiscard]] virtual impedance::Model impedance(const AxisVector<Axes>& hand) const = 0;

 protected:  // copied only as what they are
  Load() = default;
  Load(const Load&) = default;
  Load(Load&&) = default;
  Load& operator=(const Load&) = default;
  Load& operator=(Load&&) = default;
};

}  // namespace mbk::participant
