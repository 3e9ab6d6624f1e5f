#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/random.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::participant {

/// Forces of a limb other than inertia, damping and stiffness, each with its own mechanism and each violating an
/// assumption of M ẍ + B ẋ + K (x − x₀) = −F. To be added to h of LoadDynamics,
///   F_c v/√(|v|² + v_c²) + k₃ |x − x₀|² (x − x₀) + g (x(t − d) − x₀) − K ṙ t − A cos φ(t),   dφ = 2πf dt + √(2πw) dW
/// dry friction, hardening, a stretch response after a delay, an equilibrium that moves at ṙ, and a tremor whose line
/// has the width w;
///   + r K Σ_τ (x − x₀ − z_τ) + e K |x − x₀|,   τ ż_τ = x − x₀ − z_τ
/// three springs in series with dampers (τ = 0.1, 0.5, 1.5 s), and a stiffness that is 1 + e times as large on one side
/// and 1 − e times on the other. All are zero by default.
class Departures {
 public:
  struct Options {
    double dry_friction = 0.0;                       ///< F_c [N] ≥ 0
    double dry_friction_speed = 0.005;               ///< v_c [m/s] > 0
    double cubic_stiffness = 0.0;                    ///< k₃ [N/m³]
    double reflex_gain = 0.0;                        ///< g [N/m]
    double reflex_delay = 0.060;                     ///< d [s] ≥ 0, rounded to whole ticks
    double tremor_force = 0.0;                       ///< A of each axis [N] ≥ 0
    Hertz tremor_frequency{4.5};                     ///< f > 0
    Hertz tremor_width{0.1};                         ///< w, between the half-power points ≥ 0
    Eigen::Vector2d equilibrium_drift = {0.0, 0.0};  ///< ṙ [m/s]
    double relaxing_share = 0.0;                     ///< r ≥ 0
    double one_sided_share = 0.0;                    ///< e, −1…1
  };

  /// @param sample_time  T [s] > 0    @param rest x₀ [m]
  /// @fails  usage: a limit stated in Options is violated.
  [[nodiscard]] static Result<Departures> create(const Options& options, const Eigen::Vector2d& rest,
                                                 double sample_time, std::uint64_t seed, std::uint32_t stream);

  /// One tick with this hand position.   @param stiffness K [N/m] of the limb
  void step(double t, const Eigen::Vector2d& position, const Eigen::Matrix2d& stiffness);

  /// In a state between ticks [N].
  [[nodiscard]] Eigen::Vector2d force(const HandState<2>& hand) const;

 private:
  Departures(const Options& options, const Eigen::Vector2d& rest, double sample_time, numeric::Random random);

  Options options_;
  Eigen::Vector2d rest_;
  double sample_time_;
  numeric::Random random_;
  std::array<double, 2> phase_;
  std::vector<Eigen::Vector2d> delayed_;  // ring, x − x₀
  std::size_t next_ = 0;
  std::array<Eigen::Vector2d, 3> relaxed_{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.0, 0.0),
                                          Eigen::Vector2d(0.0, 0.0)};  // z_τ
  Eigen::Vector2d held_ = {0.0, 0.0};                                  // reflex, drift and tremor, over the tick
};

}  // namespace mbk::participant
