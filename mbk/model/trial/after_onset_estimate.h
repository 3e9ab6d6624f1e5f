#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/impulse_response_estimate.h"

namespace mbk {

/// M, B or K with the 95 % intervals of its entries and of the eigenvalues of its symmetric part.
struct MatrixEstimate {
  Matrix value, half_width;                  ///< n×n
  Vector eigenvalue, eigenvalue_half_width;  ///< n, rising
  bool identifiable = false;                 ///< see AfterOnsetEstimate
};

/// M, B and K immediately after a step of the robot reference, before the person can respond:
///   −ΔF_h = M Δẍ + B Δẋ + K Δx,   Δ: less the mean over the time before the onset.
/// A matrix is identifiable if the half-widths of the intervals of both eigenvalues are less than half of the largest
/// eigenvalue, and the largest is positive.
struct AfterOnsetEstimate {
  int axes = 2;
  double window_s = 0;            ///< after an onset; later samples are not used
  double baseline_s = 0;          ///< before an onset
  Index onsets = 0;               ///< that were pooled
  Index omitted = 0;              ///< excluded: no rest before them, or too close to an end
  double displacement = 0;        ///< largest |Δx| [m or rad], mean over the onsets
  double handle_mass = 0;         ///< that was subtracted from M [kg]
  double degrees_of_freedom = 0;  ///< degrees of freedom of Student's t for the intervals
  MatrixEstimate M, B, K;
  std::vector<ExplainedForce> explained;  ///< n, of −ΔF_h, in sample
};

}  // namespace mbk
