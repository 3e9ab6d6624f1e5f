#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/simulate/participant/load.h"
#include "mbk/simulate/participant/remnant.h"

namespace mbk::participant {

/// Torque of a stretch reflex, resisting the stretch:
///   τ_r = G H(s) e^{−sd} max(0, u θ̇),   H(s) = ω²/(s² + 2ζω s + ω²)                                   [N·m]
/// u = ±1 the direction of stretch (Kearney, Stein & Parameswaran 1997, fig. 1: the reflex path of the parallel
/// cascade). Velocities are held between ticks, for which the low-pass is exact.
class StretchReflex {
 public:
  struct Options {
    double gain = 0.0;                           ///< G [N·m·s/rad] ≥ 0
    double delay = 0.040;                        ///< d [s] ≥ 0, rounded to whole ticks
    RadPerSec natural_frequency{Hertz(5.0)};     ///< ω > 0
    double damping_ratio = 1.0;                  ///< ζ > 0
    bool stretched_by_positive_velocity = true;  ///< u = +1, else −1
  };

  /// @param sample_time  T [s] > 0
  /// @fails  usage: a limit stated in Options is violated; ωT is not below 1.
  [[nodiscard]] static Result<StretchReflex> create(const Options& options, double sample_time);

  /// One tick at this joint velocity [rad/s]; returns u τ_r [N·m], with the sign of the stretch, to be added to h.
  double step(double velocity);

 private:
  StretchReflex(const Options& options, double sample_time);

  double gain_, direction_;
  std::vector<double> delayed_;  // ring, as many as ticks in the delay, and one
  std::size_t next_ = 0;
  Eigen::Matrix2d transition_;
  Eigen::Vector2d input_;
  Eigen::Vector2d state_ = {0.0, 0.0};  // low-passed stretch velocity and its rate
};

/// A joint of one axis with its reflex and a remnant,
///   I θ̈ + B θ̇ + K (θ − θ₀) + u τ_r − n = −reaction
/// the parallel cascade of Kearney et al. (1997). The defaults have the order of magnitude of an ankle.
class OneAxisJoint : public Load<1> {
 public:
  struct Options {
    double inertia = 0.015;   ///< I [kg·m²] > 0
    double viscosity = 0.8;   ///< B [N·m·s/rad] ≥ 0
    double stiffness = 45.0;  ///< K [N·m/rad] ≥ 0
    double rest = 0.0;        ///< θ₀ [rad]
    StretchReflex::Options reflex;
    Remnant<1>::Options remnant{.floor = 0.05};  ///< [N·m]; there is no voluntary torque
    std::uint64_t seed = 1;                      ///< of the remnant
  };

  /// @param sample_time  T [s] of the ticks that will follow
  /// @fails  usage: a limit stated in Options is violated; as the parts.
  [[nodiscard]] static Result<OneAxisJoint> create(const Options& options, double sample_time);

  void tick(double t, double sample_time, const HandState<1>& joint, const AxisVector<1>& reaction) override;
  [[nodiscard]] LoadDynamics<1> dynamics(const HandState<1>& joint) const override;
  [[nodiscard]] impedance::Model impedance(const AxisVector<1>& position) const override;

 private:
  OneAxisJoint(const Options& options, StretchReflex reflex, const Remnant<1>& remnant);

  Options options_;
  StretchReflex reflex_;
  Remnant<1> remnant_;
  double reflex_torque_ = 0.0, noise_ = 0.0;
};

}  // namespace mbk::participant
