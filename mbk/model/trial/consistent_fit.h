#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// One of the conditions that a passive limb meets: a symmetric matrix is positive semidefinite.
struct Semidefiniteness {
  double free_smallest = 0;  ///< smallest eigenvalue of the free model's symmetric part, in its own unit
  double smallest = 0;       ///< of the consistent model's; 0 to rounding where the condition is active
  bool active = false;       ///< the data alone would go on to a negative eigenvalue
};

/// The model nearest to a free one that a limb of masses, dampers and springs can have: M = Mᵀ ⪰ 0, K = Kᵀ ⪰ 0,
/// (B + Bᵀ)/2 ⪰ 0. Where a condition is active, the standard errors of the free model do not hold for this one.
struct ConsistentFit {
  impedance::Model model;   ///< x₀ is NaN where the condition on K is active: the limb is then free in one direction
  impedance::Model judged;  ///< behind `fit`, as Identification::judged
  Vector centre;            ///< x̄, n, mean position of the data [m]
  Vector force_at_centre;  ///< −F_h at rest at x̄, n [N]; with it the model explains the force where x₀ is NaN too
  Semidefiniteness inertia, damping, stiffness;
  Fit fit;                         ///< on the same data as Identification::fit
  double residual_power_free = 0;  ///< [N²], mean over the rows behind the parameters, both axes added
  double residual_power_tied = 0;  ///< with M and K symmetric and nothing else
  double residual_power = 0;       ///< of the consistent model
  double force_change = 0;         ///< √(mean ‖Δf‖²) [N]: how far its force is from the free model's, same rows
  std::string largest_change;      ///< the parameter of M, B, K that moved furthest in terms of its standard error
  double largest_change_errors = 0;  ///< that many standard errors of the free fit
  double duality_gap = 0;            ///< of the program that was solved, relative: what proves the minimum

  /// Increase of the residual's power over the free model [%].
  [[nodiscard]] double increase_percent() const { return 100.0 * (residual_power / residual_power_free - 1.0); }
};

}  // namespace mbk
