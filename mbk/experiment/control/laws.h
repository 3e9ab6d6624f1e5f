#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/robot/kinematics.h"
#include "mbk/model/robot/velocity_estimate.h"

namespace mbk::control {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Joint position control, proportional and derivative:
///   τ = K_p (θ_r − θ) + K_d (θ̇_r − θ̇)                                          [N·m]
/// (Dyck 2013, §3.4.1). Allocation-free.
class JointPositionControl {
 public:
  struct Gains {
    Vector2d proportional = {60.0, 60.0};  ///< K_p [N·m/rad] ≥ 0
    Vector2d derivative = {1.5, 1.5};      ///< K_d [N·m·s/rad] ≥ 0
    Hertz velocity_cutoff{100.0};          ///< of the velocity estimate
  };
  /// @fails  usage: a gain is negative or not finite; as robot::VelocityEstimate.
  [[nodiscard]] static Result<JointPositionControl> create(const Gains& gains, double sample_time);

  /// @param measured  θ [rad]   @param reference, reference_rate  θ_r [rad], θ̇_r [rad/s]
  Vector2d step(const Vector2d& measured, const Vector2d& reference, const Vector2d& reference_rate) noexcept;

 private:
  JointPositionControl(const Gains& gains, robot::VelocityEstimate velocity) : gains_(gains), velocity_(velocity) {}
  Gains gains_;
  robot::VelocityEstimate velocity_;
};

/// Open-loop force by the Jacobian transpose: τ = J(θ)ᵀ F*, so that a robot without friction and inertia would exert F*
/// on the hand (Dyck 2013, §4.1). Allocation-free.
class ForceControl {
 public:
  explicit ForceControl(const robot::Geometry& geometry) : geometry_(geometry) {}

  /// @param force_on_hand  F* [N], base frame
  [[nodiscard]] Vector2d step(const Vector2d& measured, const Vector2d& force_on_hand) const noexcept;

 private:
  robot::Geometry geometry_;
};

/// Force along one line, and a high-gain spring and damper that hold the hand on it (Dyck 2013, §4.4.2):
///   τ = Jᵀ [ F* − P (k (x − x_c) + b ẋ) ],   P = I − u uᵀ,   u the line's direction
/// Allocation-free.
class LineConstraint {
 public:
  struct Options {
    double angle = 1.5707963267948966;  ///< of the line from +x [rad]: the y axis
    Vector2d through = {0.3, -0.05};    ///< x_c, a point of the line [m]
    double stiffness = 4000.0;          ///< k [N/m] ≥ 0
    double damping = 60.0;              ///< b [N·s/m] ≥ 0
    Hertz velocity_cutoff{100.0};
  };
  /// @fails  usage: a gain is negative or not finite; as robot::VelocityEstimate.
  [[nodiscard]] static Result<LineConstraint> create(const Options& options, const robot::Geometry& geometry,
                                                     double sample_time);

  /// @param force_on_hand  F* [N], base frame; what is across the line is not applied
  Vector2d step(const Vector2d& measured, const Vector2d& force_on_hand) noexcept;

 private:
  LineConstraint(const Options& options, const robot::Geometry& geometry, robot::VelocityEstimate velocity);
  Options options_;
  robot::Geometry geometry_;
  Matrix2d across_;
  robot::VelocityEstimate velocity_;
};

}  // namespace mbk::control
