#include "mbk/measure/explore/spline_basis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::explore {
namespace spline_basis_test {

constexpr double kRounding = 1e-12;

/// Cox and de Boor's recursion as it is defined.
double twin(const std::vector<double>& t, Index j, int degree, double s) {
  const auto at = [&](Index k) { return t[static_cast<std::size_t>(k)]; };
  if (degree == 0) return at(j) <= s && s < at(j + 1) ? 1.0 : 0.0;
  double value = 0.0;
  if (at(j + degree) > at(j)) value += (s - at(j)) / (at(j + degree) - at(j)) * twin(t, j, degree - 1, s);
  if (at(j + degree + 1) > at(j + 1)) {
    value += (at(j + degree + 1) - s) / (at(j + degree + 1) - at(j + 1)) * twin(t, j + 1, degree - 1, s);
  }
  return value;
}

TEST(SplineBasis, IsThatOfTheRecursion) {
  for (const int degree : {0, 1, 2, 3}) {
    const SplineBasis basis{degree, {0.1, 0.15, 0.6, 0.9}};
    std::vector<double> t(static_cast<std::size_t>(degree) + 1, 0.0);
    t.insert(t.end(), basis.knots.begin(), basis.knots.end());
    t.insert(t.end(), static_cast<std::size_t>(degree) + 1, 1.0);
    for (const double s : {0.0, 0.05, 0.1, 0.12, 0.3, 0.6, 0.95, 0.999}) {
      const Matrix values = spline_values(basis, Vector::Constant(1, s));
      for (Index j = 0; j < basis.size(); ++j) {
        EXPECT_NEAR(values(0, j), twin(t, j, degree, s), kRounding) << degree << " " << j << " " << s;
      }
    }
  }
}

TEST(SplineBasis, AddsUpToOneAlsoAtBothEnds) {
  const Vector s = Vector::LinSpaced(101, 0.0, 1.0);
  const Matrix values = spline_values(even_splines(7), s);
  EXPECT_GE(values.minCoeff(), -kRounding);
  EXPECT_NEAR((values.rowwise().sum().array() - 1.0).abs().maxCoeff(), 0.0, kRounding);
  EXPECT_NEAR(values(100, values.cols() - 1), 1.0, kRounding);
}

TEST(SplineBasis, IsASumOfFinerOnes) {
  const SplineBasis fine = even_splines(48);
  const Vector s = Vector::LinSpaced(211, 0.0, 1.0);
  for (const SplineBasis& coarse : {SplineBasis{0, {}}, SplineBasis{1, {}}, SplineBasis{2, {}}, even_splines(6),
                                    SplineBasis{3, {1.0 / 48, 2.0 / 48, 17.0 / 48, 40.0 / 48}}}) {
    const Matrix T = in_finer_splines(coarse, fine);
    EXPECT_LT((spline_values(fine, s) * T.transpose() - spline_values(coarse, s)).cwiseAbs().maxCoeff(), 1e-10);
  }
}

}  // namespace spline_basis_test
}  // namespace mbk::explore
