#include "mbk/base/numeric/polynomial_roots.h"

#include <gtest/gtest.h>

namespace mbk::numeric {
namespace {

using Roots = Eigen::VectorXcd;

TEST(PolynomialRoots, AreThoseThatItWasMadeOf) {
  Roots roots(5);
  roots << -0.01, std::complex(-1.0, 20.0), std::complex(-1.0, -20.0), -300.0, 4000.0;
  Vector c(6);
  c << monic_from_roots(roots), 1.0;
  const Roots found = polynomial_roots(c);
  ASSERT_EQ(found.size(), 5);
  for (Index k = 0; k < 5; ++k) EXPECT_LT(std::abs(found[k] - roots[k]), 1e-9 * std::abs(roots[k])) << found[k];
}

TEST(PolynomialRoots, CountZerosAndLeaveLeadingZerosOut) {
  Vector c(5);
  c << 0.0, 0.0, -6.0, 2.0, 0.0;
  const Roots found = polynomial_roots(c);
  ASSERT_EQ(found.size(), 3);
  EXPECT_EQ(found[0], 0.0);
  EXPECT_EQ(found[1], 0.0);
  EXPECT_DOUBLE_EQ(found[2].real(), 3.0);
}

TEST(PolynomialRoots, OfAConstantAreNone) {
  EXPECT_EQ(polynomial_roots(Vector::Ones(1)).size(), 0);
  EXPECT_EQ(polynomial_roots(Vector::Unit(3, 0)).size(), 0);
}

TEST(PolynomialAt, IsTheSumOfItsPowers) {
  Vector c(3);
  c << 1.0, -2.0, 3.0;
  EXPECT_EQ(polynomial_at(c, {0.0, 2.0}), std::complex(1.0 - 12.0, -4.0));
}

}  // namespace
}  // namespace mbk::numeric
