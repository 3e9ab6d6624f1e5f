#pragma once

#include <limits>

#include "mbk/base/core/result.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::participant {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// A second robot that imitates a limb with abnormal tone (Dyck 2013, §6.3.6): a light device whose motors resist the
/// hand with
///   f = K (x − x₀) + B ẋ + R ẋ/√(|ẋ|² + v_s²) + u G max(0, u·ẋ − v_c),   |f| ≤ f_max                 [N]
/// stiffness and damping, lead-pipe rigidity R, and a catch G along u where the stretch is faster than v_c
/// (spasticity). With a clasp-knife limit the catch is released once u·f exceeds it, until that stretch ends
/// (u·ẋ ≤ 0). f is computed once per tick from the state at its beginning, acts from the next tick on, and reaches the
/// hand through the first-order lag of the motors. Energy is not checked: a stiff program with a slow lag is not
/// passive.
class ToneRobot : public Load<2> {
 public:
  struct Options {
    double inertia = 0.3;                                                   ///< of the device at the hand [kg] ≥ 0
    Matrix2d stiffness = (Matrix2d() << 40.0, 0.0, 0.0, 120.0).finished();  ///< K [N/m], any
    Matrix2d damping = (Matrix2d() << 5.0, 0.0, 0.0, 10.0).finished();      ///< B [N·s/m], any
    Vector2d rest = {0.30, -0.05};                                          ///< x₀, base frame [m]
    double rigidity = 0.0;                                                  ///< R [N] ≥ 0
    double rigidity_speed = 0.005;                                   ///< v_s, speed scale of its sign change [m/s] > 0
    double catch_gain = 0.0;                                         ///< G [N·s/m] ≥ 0
    double catch_speed = 0.05;                                       ///< v_c [m/s] ≥ 0
    double stretch_angle = 0.0;                                      ///< of u from +x, base frame [rad]
    double release_force = std::numeric_limits<double>::infinity();  ///< clasp-knife limit [N] > 0; infinite: none
    double motor_lag = 0.002;                                        ///< time constant [s] ≥ 0
    double largest_force = 30.0;                                     ///< f_max [N] > 0
  };

  /// @fails  usage: a limit stated in Options is violated.
  [[nodiscard]] static Result<ToneRobot> create(const Options& options);

  void tick(double t, double sample_time, const HandState<2>& hand, const Vector2d& force_on_robot) override;
  [[nodiscard]] LoadDynamics<2> dynamics(const HandState<2>& hand) const override;

  /// The device's inertia with the programmed K and B: the impedance for slow, small motions without rigidity, catch,
  /// delay and lag. x₀ is NaN if K has no inverse.
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override;

  /// Whether the clasp-knife has been released in the current stretch.
  [[nodiscard]] bool released() const { return released_; }

 private:
  explicit ToneRobot(const Options& options);
  [[nodiscard]] Vector2d programmed(const HandState<2>& hand);

  Options options_;
  Vector2d stretch_;  // u
  bool released_ = false;
  Vector2d command_ = {0.0, 0.0};  // computed at the last tick
  Vector2d force_ = {0.0, 0.0};    // at the hand now, resisting
};

}  // namespace mbk::participant
