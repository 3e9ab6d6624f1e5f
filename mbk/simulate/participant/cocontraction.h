#pragma once

#include "mbk/base/core/result.h"

namespace mbk::participant {

/// Co-contraction of the muscles on both sides of the joints, between 0 and 1, increasing with the speed of the hand:
///   c = min(1, c₀ + c₁ (s/v₀)²),   τ ṡ = |v| − s
/// It multiplies stiffness by 1 + g_K c, damping by 1 + g_B c and the weight of voluntary corrections by 1 − g_w c.
/// With c₀ = c₁ = 0 the arm is relaxed and all three are 1.
class Cocontraction {
 public:
  struct Options {
    double rest = 0.0;                ///< c₀, of a hand at rest, 0 to 1
    double slope = 0.0;               ///< c₁ ≥ 0
    double speed = 0.03;              ///< v₀ [m/s] > 0
    double time_constant = 2.5;       ///< τ [s] > 0
    double stiffness_gain = 6.0;      ///< g_K ≥ 0
    double damping_gain = 3.0;        ///< g_B ≥ 0
    double voluntary_damping = 0.62;  ///< g_w, 0 to 1
  };

  /// @param sample_time  T [s] > 0
  /// @fails  usage: a limit stated in Options is violated.
  [[nodiscard]] static Result<Cocontraction> create(const Options& options, double sample_time);

  /// One tick with the hand at that speed [m/s].
  void step(double hand_speed);

  [[nodiscard]] double level() const { return level_; }  ///< c
  [[nodiscard]] double stiffness_scale() const { return 1.0 + options_.stiffness_gain * level_; }
  [[nodiscard]] double damping_scale() const { return 1.0 + options_.damping_gain * level_; }
  [[nodiscard]] double voluntary_weight() const { return 1.0 - options_.voluntary_damping * level_; }

 private:
  Cocontraction(const Options& options, double keep) : options_(options), keep_(keep), level_(options.rest) {}

  Options options_;
  double keep_;
  double speed_ = 0.0;
  double level_;
};

}  // namespace mbk::participant
