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

 private:
  Matrix squares_, velocity_, acceleration_;
};

}  // namespace mbk::explore
