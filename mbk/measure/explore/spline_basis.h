#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::explore {

/// B-splines of one degree on [0, 1] with simple interior knots: they are not negative, add up to 1, and of degree d
/// d + 1 at most differ from 0 anywhere (de Boor 1978).
struct SplineBasis {
  int degree = 3;             ///< 0 … 3
  std::vector<double> knots;  ///< interior, rising, within (0, 1)
  [[nodiscard]] Index size() const { return static_cast<Index>(knots.size()) + degree + 1; }
};

/// Those functions of a basis that may differ from 0 at one place.
struct ActiveSplines {
  Index first = 0;
  Eigen::Matrix<double, 4, 1> value = Eigen::Matrix<double, 4, 1>::Zero();  ///< of degree + 1 of them, from `first` on
};

/// @param s in [0, 1]
[[nodiscard]] ActiveSplines active_splines(const SplineBasis& basis, double s);

/// All functions at some places.   @returns s.size() × basis.size()
[[nodiscard]] Matrix spline_values(const SplineBasis& basis, const Vector& s);

/// With cells − 1 knots at equal distances.
[[nodiscard]] SplineBasis even_splines(Index cells, int degree = 3);

/// The functions of a basis as sums of ones on finer knots: φ_j = Σ_k T_jk ψ_k.
/// @param coarse of the degree of `fine`, or lower and without interior knots; each of its knots is one of `fine`
/// @param fine  of degree 1 … 3
/// @returns coarse.size() × fine.size()
[[nodiscard]] Matrix in_finer_splines(const SplineBasis& coarse, const SplineBasis& fine);

}  // namespace mbk::explore
