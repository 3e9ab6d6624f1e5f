#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/identification.h"

namespace mbk {

/// How many times the second limb's matrix is the first's along one direction of motion.
struct WidthRatio {
  double ratio = 1;      ///< uᵀZ₂u/uᵀZ₁u
  Interval ratio95;      ///< by the delta method on its logarithm
  double direction = 0;  ///< of u from the x axis [rad], in [0, π); 0 with one axis
  Vector along = {};     ///< u with three axes, base frame; its largest component is positive; empty with fewer
};

/// How far the inertia, damping or stiffness of two limbs are apart (impedance/width.h).
struct WidthFinding {
  double distance = 0;  ///< d = √(Σ ln²λᵢ(Z₁⁻¹Z₂)) of the symmetric parts
  Interval distance95;  ///< by the delta method from both covariances; begins at 0 where both are not distinguishable
  bool distinguishable =
      false;  ///< the symmetric parts differ by more than chance gives in 5 % (Wald's test of all at once)
  /// Both symmetric parts are positive definite with 95 % confidence each; otherwise the distance has no upper end.
  bool surely_positive = false;
  std::vector<WidthRatio> ratios;  ///< increasing, one for each axis
};

/// Of two results: each matrix's width, or why it has none.
struct WidthFindings {
  std::array<std::optional<WidthFinding>, 3> of;  ///< inertia, damping, stiffness
  std::array<std::string, 3> refused;             ///< why there is none; empty where there is one
  Motion motion = Motion::translation;

  [[nodiscard]] bool complete() const { return of[0] && of[1] && of[2]; }
};

}  // namespace mbk
