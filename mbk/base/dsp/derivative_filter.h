#pragma once

#include <optional>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// One sample of a linear system behind a hold: x ← Φ x + Γ₀ u(t) + Γ₁ u(t + h).
struct HeldStep {
  Matrix transition;            ///< Φ
  Vector from_last, from_next;  ///< Γ₀, Γ₁
};

/// Of the filter below, over `step`.
/// @param held  absent: the input runs in straight lines between its samples (first-order hold). Otherwise it keeps
/// each sample's value for this share of the interval, 0 < held ≤ 1, and then jumps to the next one's; 1: zero-order
/// hold, and less is a zero-order hold behind a delay of that part of a sample.
[[nodiscard]] HeldStep held_step(const Vector& denominator, double step, std::optional<double> held = {});

/// All derivatives of a signal behind 1/A in one pass, exactly for a signal that runs in straight lines between its
/// samples, or is held: x_k = sᵏ/A(s) u, k = 0 … n − 1, are the states of the companion form
///   ẋ_k = x_{k+1},  ẋ_{n−1} = u − Σ a_k x_k,  A(s) = sⁿ + a_{n−1} sⁿ⁻¹ + … + a₀,
/// and from one sample to the next, over h, x ← Φ x + Γ₀ u(t) + Γ₁ u(t + h), of the matrix exponential
///   exp(h [F g 0; 0 0 1; 0 0 0])   for straight lines,   exp(h [F g; 0 0])   for an input that is held.
class DerivativeFilter {
 public:
  /// At rest before the first sample.
  /// @param denominator a₀ … a_{n−1}, n ≥ 1. The time unit should be such that its roots are about 1.
  /// @param held  as for held_step
  explicit DerivativeFilter(const Vector& denominator, std::optional<double> held = {});

  [[nodiscard]] Index order() const { return n_; }
  [[nodiscard]] const Vector& state() const { return x_; }

  /// Sets the states, and what the input was at the last sample.
  void set_state(const Vector& state, double input = 0.0);

  /// The next samples, all `step` after the one before.
  /// @param step [same time unit as the denominator] > 0    @param input count values, from the next sample on
  /// @param states n rows, count columns: x at each of them
  void run(double step, const double* input, Index count, Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> states);

  /// One sample in place, where the state is that of the instant itself: the first of a record.
  void begin(double input) { last_input_ = input; }

 private:
  void set_step(double step);
  template <int N>
  void run_fixed(const double* input, Index count, double* states, Index stride);

  Vector a_, x_;
  std::optional<double> held_share_;
  Index n_;
  double last_input_ = 0.0;
  double step_ = 0.0;
  HeldStep held_;
};

}  // namespace mbk::dsp
