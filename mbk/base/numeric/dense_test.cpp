#include "mbk/base/numeric/dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <vector>

#include "mbk/base/numeric/random.h"

namespace mbk::numeric {
namespace dense_test {

Eigen::VectorXcd drawn(Random& random, Index n) {
  Eigen::VectorXcd v(n);
  for (std::complex<double>& one : v) one = {random.normal(), random.normal()};
  return v;
}

/// Of known eigenvalues, turned by n reflections I − 2 v v*/v*v; what stands above the diagonal is not to be read.
Eigen::MatrixXcd hermitian_with(const Vector& eigenvalues, Random& random) {
  const Index n = eigenvalues.size();
  Eigen::MatrixXcd A = eigenvalues.cast<std::complex<double>>().asDiagonal();
  for (Index k = 0; k < n; ++k) {
    const Eigen::VectorXcd v = drawn(random, n).normalized();
    const Eigen::MatrixXcd turn = Eigen::MatrixXcd::Identity(n, n) - 2.0 * v * v.adjoint();
    A = (turn * A * turn).eval();
  }
  A.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  return A;
}

TEST(HermitianEigenvalues, AreThoseThatTheMatrixWasMadeOf) {
  Random random(1);
  for (Index n = 1; n <= 6; ++n) {
    for (int turn = 0; turn < 20; ++turn) {
      Vector expected(n);
      for (double& one : expected) one = std::exp(3.0 * random.normal()) * (random.uniform() < 0.5 ? -1.0 : 1.0);
      if (turn % 2 == 1 && n > 2) expected[1] = expected[0];  // one that comes twice
      std::ranges::sort(expected);
      const Vector found = hermitian_eigenvalues(hermitian_with(expected, random));
      ASSERT_EQ(found.size(), n);
      EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.cwiseAbs().maxCoeff());
    }
  }
}

TEST(HermitianEigenvalues, OfTwoByTwoAreTheRootsOfItsPolynomial) {
  Random random(2);
  for (int turn = 0; turn < 100; ++turn) {
    const double a = random.normal(), d = random.normal();
    const std::complex<double> c = drawn(random, 1)[0];
    const Eigen::MatrixXcd A = (Eigen::MatrixXcd(2, 2) << a, std::conj(c), c, d).finished();
    const double middle = 0.5 * (a + d), half = std::sqrt(0.25 * (a - d) * (a - d) + std::norm(c));
    const Vector found = hermitian_eigenvalues(A);
    EXPECT_NEAR(found[0], middle - half, 1e-14 * (std::abs(middle) + half));
    EXPECT_NEAR(found[1], middle + half, 1e-14 * (std::abs(middle) + half));
  }
}

Eigen::MatrixXcd complex_drawn(Random& random, Index rows, Index columns) {
  Eigen::MatrixXcd A(rows, columns);
  for (Index j = 0; j < columns; ++j) A.col(j) = drawn(random, rows);
  return A;
}

TEST(ComplexInverse, TimesTheMatrixIsOne) {
  Random random(3);
  for (Index n = 1; n <= 5; ++n) {
    const Eigen::MatrixXcd A = complex_drawn(random, n, n), inverse = complex_inverse(A);
    EXPECT_LE((A * inverse - Eigen::MatrixXcd::Identity(n, n)).norm(), 1e-13 * A.norm() * inverse.norm());
  }
  EXPECT_FALSE(complex_inverse(Eigen::MatrixXcd::Zero(2, 2)).allFinite());
}

TEST(ComplexSingularValues, AreTheRootsOfTheGramMatrixsEigenvalues) {
  Random random(4);
  for (Index n = 1; n <= 4; ++n) {
    const Eigen::MatrixXcd A = complex_drawn(random, n + 1, n);
    const Vector found = complex_singular_values(A),
                 expected = hermitian_eigenvalues(A.adjoint() * A).cwiseSqrt().reverse();
    ASSERT_EQ(found.size(), n);
    EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected[0]);
  }
  const Eigen::MatrixXcd alike =
      (Eigen::MatrixXcd(2, 2) << 1.0, std::complex<double>(0.0, 1.0), std::complex<double>(0.0, 1.0), -1.0)
          .finished();  // the second row is i times the first
  EXPECT_NEAR(complex_singular_values(alike)[1], 0.0, 1e-15);
}

/// Plain elimination, the largest of the diagonal as it was given first; it changes places with what stands there.
Vector pivots_of(Eigen::MatrixXcd A) {
  const Index n = A.rows();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  const Vector given = A.diagonal().real();
  Vector pivots(n);
  for (Index step = 0; step < n; ++step) {
    const auto here = order.begin() + step;
    std::iter_swap(here, std::max_element(here, order.end(), [&](Index a, Index b) { return given[a] < given[b]; }));
    pivots[step] = A(*here, *here).real();
    A -= (A.col(*here) * A.row(*here) / A(*here, *here)).eval();
  }
  return pivots;
}

TEST(HermitianPivotedCholesky, SolvesAndHasThePivotsOfElimination) {
  Random random(5);
  for (int turn = 0; turn < 200; ++turn) {
    const Index n = 1 + turn % 6;
    const Eigen::MatrixXcd C = complex_drawn(random, n + 1, n);
    Eigen::MatrixXcd A = C.adjoint() * C;
    const Vector size = A.diagonal().real().cwiseSqrt().cwiseInverse();
    if (turn % 2 == 1) A = (size.asDiagonal() * A * size.asDiagonal()).eval();  // as that of coherences
    Eigen::MatrixXcd given = A;
    given.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
    const HermitianPivotedCholesky factor(given);
    const Eigen::VectorXcd x = drawn(random, n);
    EXPECT_LE((factor.solve(A * x) - x).norm(), 1e-8 * x.norm()) << turn;
    ASSERT_EQ(factor.pivots().size(), n);
    EXPECT_LE((factor.pivots() - pivots_of(A)).cwiseAbs().maxCoeff(), 1e-11 * A.norm()) << turn;
  }
}

TEST(HermitianPivotedCholesky, OneThatIsSingularHasAPivotOfNothing) {
  Random random(6);
  for (int turn = 0; turn < 100; ++turn) {
    const Index n = 2 + turn % 3;
    Eigen::MatrixXcd C = complex_drawn(random, 7, n);
    // The last is one of the others, times any number: real, imaginary or neither.
    const std::complex<double> times = turn % 4 == 0   ? std::complex<double>(3.0, 0.0)
                                       : turn % 4 == 1 ? std::complex<double>(0.0, 2.0)
                                                       : drawn(random, 1)[0];
    C.col(n - 1) = times * C.col(turn % (n - 1));
    const Vector size = C.colwise().norm().cwiseInverse();
    const Eigen::MatrixXcd A = size.asDiagonal() * (C.adjoint() * C) * size.asDiagonal();
    EXPECT_LE(HermitianPivotedCholesky(A).pivots().cwiseAbs().minCoeff(), 1e-13) << turn;
  }
}

}  // namespace dense_test
}  // namespace mbk::numeric
