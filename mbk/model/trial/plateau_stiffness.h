#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/findings.h"

namespace mbk {

/// Stiffness by regression of restoring forces on displacements, one of each for every displacement of the hand,
///   f_i = K d_i + e_i,
/// with the commanded displacement z_i as instrument: K = Σ f_i z_iᵀ (Σ d_i z_iᵀ)⁻¹. If the robot follows exactly, d_i
/// = z_i and this is least squares. Errors are independent between displacements and may differ in size.
struct StiffnessRegression {
  Matrix K;                        ///< n×n, not made symmetric [N/m or N·m/rad]
  Matrix covariance;               ///< n²×n², of K row by row
  Matrix standard_error;           ///< n×n
  Matrix half_width95;             ///< n×n, by Student's t
  double degrees_of_freedom = 0;   ///< of the entry with the fewest
  Vector residual_rms;             ///< n [N or N·m]
  double relative_error = 0;       ///< √Σ standard errors² over √Σ k²
  int displacements = 0;           ///< that were used
  int directions = 0;              ///< number of different commanded directions
  double amplitude = 0;            ///< mean |z_i| [m or rad]
  double reached = 0;              ///< smallest d/z over the directions of motion; 1 if the robot follows exactly
  std::optional<double> linear_p;  ///< p-value of the lack of fit over the directions
  std::optional<EllipseFinding> ellipse;            ///< two axes
  std::optional<AntisymmetryFinding> antisymmetry;  ///< two axes
};

/// A displacement of the hand and the response force.
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
  std::string window_rule;      ///< reason for that window
  double baseline_s = 0;        ///< baseline before the onset, subtracted from force and position [s]
  /// Bias of K from inertia and damping due to residual motion in the window, as a share of K, for a limb whose
  /// damping and inertia are kDampingOverStiffness and kInertiaOverStiffness of its stiffness.
  double motion_share = 0;
  int left_out = 0;  ///< excluded ramps: hold or preceding rest shorter than the window or the baseline
  std::vector<DisplacedHand> plateaus;
  bool usable = true;  ///< false: the numbers are shown, but do not describe the limb

  static constexpr double kDampingOverStiffness = 0.2;   ///< [s]
  static constexpr double kInertiaOverStiffness = 0.04;  ///< [s²]
};

}  // namespace mbk
