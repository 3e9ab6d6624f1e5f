#pragma once

#include <Eigen/Core>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"

namespace mbk::participant {

/// Human voluntary correction: intermittent, delayed, in small smooth steps. At the end of each interval
///   ΔF = −w (g_x K [e_x] + g_F [e_F]),   e_x = x(t − d) − x*,   e_F = F_h(t − d) − F*,   |ΔF| ≤ ΔF_max
/// where [e] is e if |e| is above its threshold, else 0; K is the arm's stiffness now and w an external weight
/// (co-contraction). Each component of ΔF has a random error of standard deviation ε|ΔF|. The voluntary force takes up
/// ΔF on the minimum-jerk ramp s³(10 − 15s + 6s²), s from 0 to 1 over the ramp's duration (Flash & Hogan 1985), and
/// leaks away: Ḟ_v = (ΔF ramp)˙ − F_v/τ.
/// g_x alone holds a position, g_F alone a force; with both gains zero there is no voluntary control. The numbers were
/// tuned so that the arm of `rigid_arm_options` behaves as in Dyck (2013), figs. 4.3–4.5; they were not fitted to
/// anyone.
class IntermittentController {
 public:
  struct Options {
    double interval = 0.28;                    ///< from decision to decision [s] > 0
    double delay = 0.15;                       ///< d, from perception to decision [s] ≥ 0
    double position_gain = 0.0;                ///< g_x ≥ 0, of K times the displacement
    double position_threshold = 0.0015;        ///< [m] ≥ 0
    Eigen::Vector2d position = {0.30, -0.05};  ///< x*, base frame [m]
    double force_gain = 0.0;                   ///< g_F [N/N] ≥ 0
    double force_threshold = 0.2;              ///< [N] ≥ 0
    Eigen::Vector2d force = {0.0, 0.0};        ///< F*, hand on robot, base frame [N]
    double random_error = 0.2;                 ///< ε ≥ 0
    double largest_increment = 2.5;            ///< ΔF_max, before the error [N] ≥ 0
    double ramp = 0.22;                        ///< duration of a correction [s] > 0, not above the interval
    double leak = 8.0;                         ///< τ [s] > 0
  };

  /// The first decision is at a random time of the first interval.
  /// @param sample_time  T [s] > 0; intervals are rounded to whole ticks
  /// @fails  usage: a limit stated in Options is violated.
  [[nodiscard]] static Result<IntermittentController> create(const Options& options, double sample_time,
                                                             std::uint64_t seed, std::uint32_t stream = 0);

  /// Whether the next step takes a decision. Only then is the stiffness used.
  [[nodiscard]] bool is_to_decide() const { return to_decision_ == 0; }

  /// One tick. Before the delay has passed, the errors are zero. Does not allocate.
  /// @param stiffness  K [N/m], arbitrary if no decision is due   @param weight  w
  /// @returns  F_v [N], part of the force of the hand on the robot
  const Eigen::Vector2d& step(const Eigen::Vector2d& hand, const Eigen::Vector2d& force_hand_on_robot,
                              const Eigen::Matrix2d& stiffness, double weight);

  [[nodiscard]] const Eigen::Vector2d& force() const { return force_; }

 private:
  struct Errors {
    Eigen::Vector2d position = {0.0, 0.0}, force = {0.0, 0.0};
  };
  IntermittentController(const Options& options, double sample_time, numeric::Random random);
  [[nodiscard]] Eigen::Vector2d increment(const Errors& felt, const Eigen::Matrix2d& stiffness, double weight);

  Options options_;
  numeric::Random random_;
  std::vector<Errors> delayed_;  // ring, as many as ticks in the delay, and one
  std::size_t next_ = 0;
  int interval_ticks_, ramp_ticks_, to_decision_, ramp_tick_;
  double keep_;  // of the force over one tick
  Eigen::Vector2d increment_ = {0.0, 0.0}, force_ = {0.0, 0.0};
};

}  // namespace mbk::participant
