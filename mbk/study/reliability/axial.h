#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// Mean of axes, which are the same after half a turn, by doubled angles (Mardia & Jupp 2000, §9.1):
///   C + iS = (1/n) Σ exp(2iθ), R = |C + iS|, θ̄ = ½ arg(C + iS), SD = ½ √(−2 ln R)
struct AxialMean {
  Support support = Support::enough;  ///< no_variation: R = 0, the axes point everywhere alike, and there is no mean
  int count = 0;
  double mean = 0;                ///< [rad], in [0, π); NaN where there is none
  double resultant = 0;           ///< R, 0 … 1: 1 where all are alike
  double standard_deviation = 0;  ///< [rad]; ∞ where R = 0
};

/// @param angles [rad], at least one    @fails  data: there are none; one is not finite.
[[nodiscard]] Result<AxialMean> axial_mean(const Vector& angles);

/// second − first of two axes [rad], in (−π/2, π/2].
[[nodiscard]] double axial_difference(double second, double first);

/// Each angle or its half turn, whichever is nearer to the axis `about`: within ±π/2 of it. Statistics of these as of
/// plain numbers (ICC, SEM, Bland–Altman) are those of the axes as long as none of them is far from the mean: see
/// `farthest`.
struct Unwrapped {
  Vector angles;        ///< [rad]
  double farthest = 0;  ///< largest distance from `about` [rad]
  /// Whether all lie within 45° of it. Otherwise where the circle is cut decides, and no such statistic must be used.
  bool trusted = false;
};
[[nodiscard]] Unwrapped unwrapped_about(const Vector& angles, double about);

/// Affine-invariant distances (impedance/impedance_width.h) of matrices: between sessions of a person, and between
/// people. Unless the first are clearly smaller than the second, the matrix does not distinguish people.
struct WidthSpread {
  Support support = Support::enough;
  Vector within;   ///< each pair of sessions of each person
  Vector between;  ///< each pair of people, between the means of their sessions' matrices
};

/// @param matrices  [person][session], each 2×2 or each 3×3 with a positive definite symmetric part; sessions may
/// differ in number
/// @fails  data: shapes differ; a symmetric part is not positive definite.
[[nodiscard]] Result<WidthSpread> width_spread(const std::vector<std::vector<Matrix>>& matrices);

}  // namespace mbk::reliability
