#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// A condition satisfied by a passive limb: a symmetric matrix is positive semidefinite.
struct Semidefiniteness {
  double free_smallest = 0;  ///< smallest eigenvalue of the free model's symmetric part, in its own unit
  double smallest = 0;       ///< of the consistent model; 0 within rounding if the condition is active
  bool active = false;       ///< active: the data alone would give a negative eigenvalue
};

/// The model closest to the free one that is realisable with masses, dampers and springs: M = Mᵀ ⪰ 0, K = Kᵀ ⪰ 0,
/// (B + Bᵀ)/2 ⪰ 0. If a condition is active, the standard errors of the free model do not apply to this one.
struct ConsistentFit {
  impedance::Model model;   ///< x₀ is NaN where the condition on K is active: the limb is then free in one direction
  impedance::Model judged;  ///< behind `fit`, as Identification::judged
  Vector centre;            ///< x̄, n, mean position of the data [m]
  Vector force_at_centre;   ///< −F_h at rest at x̄, n [N]; with it the model explains the force even if x₀ is NaN
  Semidefiniteness inertia, damping, stiffness;
  Fit fit;                         ///< on the same data as Identification::fit
  double residual_power_free = 0;  ///< [N²], mean over the rows used for the parameters, sum of both axes
  double residual_power_tied = 0;  ///< with M and K symmetric and nothing else
  double residual_power = 0;       ///< of the consistent model
  double force_change = 0;  ///< √(mean ‖Δf‖²) [N]: difference of its force from that of the free model, same rows
  std::string largest_change;        ///< the parameter of M, B, K that moved furthest in terms of its standard error
  double largest_change_errors = 0;  ///< its change in standard errors of the free fit
  double duality_gap = 0;            ///< relative duality gap of the optimisation, which proves the minimum

  /// Increase of the residual's power over the free model [%].
  [[nodiscard]] double increase_percent() const { return 100.0 * (residual_power / residual_power_free - 1.0); }
};

}  // namespace mbk
