#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/findings.h"

namespace mbk {

/// Stiffness by regression of restoring forces on displacements, one of each for every displacement of the hand,
///   f_i = K d_i + e_i,
/// with what was commanded, z_i, as instrument: K = Σ f_i z_iᵀ (Σ d_i z_iᵀ)⁻¹. Where the robot follows exactly, d_i =
/// z_i and this is least squares. Errors are independent from displacement to displacement and need not be equally
/// large.
struct StiffnessRegression {
  Matrix K;                        ///< n×n, not made symmetric [N/m or N·m/rad]
  Matrix covariance;               ///< n²×n², of K row by row
  Matrix standard_error;           ///< n×n
  Matrix half_width95;             ///< n×n, by Student's t
  double degrees_of_freedom = 0;   ///< of the entry that has fewest
  Vector residual_rms;             ///< n [N or N·m]
  double relative_error = 0;       ///< √Σ standard errors² over √Σ k²
  int displacements = 0;           ///< that were used
  int directions = 0;              ///< different ones that were commanded
  double amplitude = 0;            ///< mean |z_i| [m or rad]
  double reached = 0;              ///< smallest d/z over the directions of motion, 1 where the robot follows
  std::optional<double> linear_p;  ///< probability of such a lack of fit over the directions where K is all there is
  std::optional<EllipseFinding> ellipse;            ///< two axes
  std::optional<AntisymmetryFinding> antisymmetry;  ///< two axes
};

/// A displacement of the hand and the force that answered it.
struct DisplacedHand {
  double onset_s = 0;   ///< on the clock of its recording
  int recording = 0;    ///< 0 for the first
  Vector commanded;     ///< z, n [m or rad]
  Vector displacement;  ///< d, n
  Vector force;         ///< f = −ΔF_h: the force of the robot on the hand, n [N or N·m]
};

/// Stiffness of a hand that is displaced, held there and let go back (Mussa-Ivaldi, Hogan & Bizzi 1985).
struct PlateauStiffness {
  int axes = 2;
  StiffnessRegression fit;
  double from_s = 0, to_s = 0;  ///< the window on the plateau, after the onset of the ramp [s]
  std::string window_rule;      ///< why that window
  double baseline_s = 0;        ///< before the onset, subtracted from force and place [s]
  /// What inertia and damping add to K because the hand still moves on the window, as a share of K, for a limb whose
  /// damping and inertia are kDampingOverStiffness and kInertiaOverStiffness of its stiffness.
  double motion_share = 0;
  int left_out = 0;  ///< ramps whose hold or rest before is shorter than the window or the baseline
  std::vector<DisplacedHand> plateaus;
  bool usable = true;  ///< false: the numbers are shown, but are not those of the limb

  static constexpr double kDampingOverStiffness = 0.2;   ///< [s]
  static constexpr double kInertiaOverStiffness = 0.04;  ///< [s²]
};

}  // namespace mbk
