#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::explore {

/// What inertia and damping add to a stiffness that is read off windows in which the hand still moves, as a share of
/// it: ‖τ_B V‖ + ‖τ_M² A‖, with V and A the regressions of Δx/T and Δẋ/T over the window on the commanded displacement,
/// and τ_B, τ_M² of PlateauStiffness.
class MotionShare {
 public:
  /// @param place  of the hand on the window, N×n [m]    @param commanded  n [m]
  void add(const Matrix& place, double sample_time, const Vector& commanded);

  /// @returns 0 where nothing was added.
  [[nodiscard]] double value() const;

  /// The same less what chance alone gives where every hand moves by an error of its own, as that of a prediction: V
  /// and A count with √max(0, ‖V‖² − Σ s²), s the standard errors of their entries. Such an error is in the residuals
  /// of the stiffness too, and so in its interval.
  [[nodiscard]] double beyond_chance() const;

 private:
  struct Regression {
    Matrix crossed;  ///< Σ v zᵀ
    Vector squares;  ///< Σ v² of each axis
    [[nodiscard]] double norm(const Matrix& inverse) const;
    /// @param inverse  (Σ z zᵀ)⁻¹   @param count  of hands
    [[nodiscard]] double norm_beyond_chance(const Matrix& inverse, Index count) const;
    void add(const Vector& value, const Vector& commanded);
  };
  Index count_ = 0;
  Matrix squares_;
  Regression velocity_, acceleration_;
};

}  // namespace mbk::explore
