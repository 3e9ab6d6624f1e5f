#include "mbk/measure/explore/spline_basis.h"

#include <algorithm>

#include "mbk/base/numeric/dense.h"

namespace mbk::explore {
namespace {

/// Knot k of the whole sequence, with degree + 1 equal ones at each end.
double knot(const SplineBasis& basis, Index k) {
  const Index interior = k - basis.degree - 1;
  if (interior < 0) return 0.0;
  return interior < static_cast<Index>(basis.knots.size()) ? basis.knots[static_cast<std::size_t>(interior)] : 1.0;
}

}  // namespace

ActiveSplines active_splines(const SplineBasis& basis, double s) {
  ActiveSplines active;
  active.first = std::ranges::upper_bound(basis.knots, s) - basis.knots.begin();
  const Index interval = active.first + basis.degree;  // knot(interval) ≤ s < knot(interval + 1)
  auto& value = active.value;
  value[0] = 1.0;
  for (Index d = 1; d <= basis.degree; ++d) {  // Cox and de Boor's recursion
    double carried = 0.0;
    for (Index j = 0; j < d; ++j) {
      const double right = knot(basis, interval + j + 1), left = knot(basis, interval + j + 1 - d);
      const double share = value[j] / (right - left);
      value[j] = carried + (right - s) * share;
      carried = (s - left) * share;
    }
    value[d] = carried;
  }
  return active;
}

Matrix spline_values(const SplineBasis& basis, const Vector& s) {
  Matrix values = Matrix::Zero(s.size(), basis.size());
  for (Index i = 0; i < s.size(); ++i) {
    const ActiveSplines active = active_splines(basis, s[i]);
    values.row(i).segment(active.first, basis.degree + 1) = active.value.head(basis.degree + 1).transpose();
  }
  return values;
}

SplineBasis even_splines(Index cells, int degree) {
  SplineBasis basis{degree, {}};
  for (Index k = 1; k < cells; ++k) basis.knots.push_back(static_cast<double>(k) / static_cast<double>(cells));
  return basis;
}

Matrix in_finer_splines(const SplineBasis& coarse, const SplineBasis& fine) {
  Vector places(fine.size());  // Greville's, at which the collocation matrix can be inverted
  for (Index k = 0; k < fine.size(); ++k) {
    places[k] = 0.0;
    for (Index j = 1; j <= fine.degree; ++j) places[k] += knot(fine, k + j) / static_cast<double>(fine.degree);
  }
  return numeric::Lu(spline_values(fine, places)).solve(spline_values(coarse, places)).transpose();
}

}  // namespace mbk::explore
