#include "mbk/base/numeric/independent_columns.h"

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

IndependentColumns independent_columns(const Matrix& Z, double tolerance, double negligible) {
  const Index p = Z.cols();
  const Matrix small = Z.rows() > 4 * p ? householder_triangle(Z) : Z;
  const double shortest = p == 0 ? 0.0 : negligible * small.colwise().norm().maxCoeff();
  Matrix directions(small.rows(), p);
  IndependentColumns found;
  for (Index j = 0; j < p; ++j) {
    const auto count = static_cast<Index>(found.kept.size());
    const double length = small.col(j).norm();
    Vector rest = small.col(j);
    for (int pass = 0; pass < 2; ++pass) {
      for (Index k = 0; k < count; ++k) rest -= directions.col(k).dot(rest) * directions.col(k);
    }
    if (!(length > shortest && rest.norm() > tolerance * length)) continue;
    directions.col(count) = rest.normalized();
    found.kept.push_back(j);
  }
  const auto count = static_cast<Index>(found.kept.size());
  found.combination = Matrix::Zero(count, p);
  if (count == 0) return found;
  const Matrix basis = small(Eigen::all, found.kept);
  found.combination = householder_solve(basis, small);
  for (Index k = 0; k < count; ++k)
    found.combination.col(found.kept[static_cast<std::size_t>(k)]) = Vector::Unit(count, k);
  return found;
}

}  // namespace mbk::numeric
