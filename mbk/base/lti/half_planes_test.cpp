#include "mbk/base/lti/half_planes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/lti/on_axis.h"
#include "mbk/base/lti/test_polynomials.h"

namespace mbk::lti {
namespace {

using numeric::Random;

constexpr double kRoots = 1e-9;  // conditioning of random polynomials of degree 8

/// s² − 2 σ s + σ² + ω²: roots σ ± jω.
Polynomial pair(const Rational& sigma, const Rational& omega) {
  return {sigma * sigma + omega * omega, -2 * sigma, 1};
}

void expect_counts(const Polynomial& p, int left, int axis, int right) {
  const HalfPlaneCount count = count_half_planes(p);
  EXPECT_EQ(count.left, left);
  EXPECT_EQ(count.axis, axis);
  EXPECT_EQ(count.right, right);
}

TEST(CountHalfPlanes, HasTheTextbookCases) {
  expect_counts({1, 1}, 1, 0, 0);
  expect_counts({-1, 1}, 0, 0, 1);
  expect_counts({1, 1, 1}, 2, 0, 0);
  expect_counts({0, 1}, 0, 1, 0);
  expect_counts({4, 0, 1}, 0, 2, 0);
  expect_counts({7}, 0, 0, 0);
  expect_counts({-1, 0, 1}, 1, 0, 1);       // s² − 1: symmetric about the origin
  expect_counts({4, 0, 0, 0, 1}, 2, 0, 2);  // s⁴ + 4
  expect_counts({3, 2, 2, 1, 1}, 2, 0, 2);  // a zero in the first column of Routh's array
  expect_counts({1, 2, 1}, 1, 0, 0);        // (s + 1)²: different roots
}

TEST(CountHalfPlanes, AgreesWithTheRootsThatMadeThePolynomial) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    Polynomial p{random_rational(random) > 0 ? 3 : -2};
    int left = 0, axis = 0, right = 0;
    for (int i = 0; i < 1 + trial % 4; ++i) {
      // denominators and offsets keep the roots different
      const Rational sigma(static_cast<int>(random.below(3)) - 1, 2 + i), omega = Rational(i + 1, 7);
      (sigma < 0 ? left : sigma > 0 ? right : axis) += 2;
      p = p * pair(sigma, omega);
    }
    if (trial % 3 == 0) {
      p = p * Polynomial{0, 1};
      ++axis;
    }
    if (trial % 5 == 0) {
      p = p * Polynomial{-5, 1} * Polynomial{5, 1};
      ++left, ++right;
    }
    expect_counts(p, left, axis, right);
    EXPECT_EQ(count_half_planes(p * p).right, right);
  }
}

TEST(CountHalfPlanes, SeesARealPartThatNoDoubleSees) {
  const Rational tiny = Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 40);
  expect_counts(pair(tiny, 3), 0, 0, 2);
  expect_counts(pair(-tiny, 3), 2, 0, 0);
}

TEST(ComplexRoots, AreRoots) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Polynomial p = random_polynomial(random, 8);
    const auto roots = complex_roots(p);
    ASSERT_EQ(roots.size(), 8u);
    for (const auto& root : roots) {
      double terms = 0.0;
      for (int i = 0; i <= 8; ++i) terms += std::abs(to_double(p.coefficient(i))) * std::pow(std::abs(root), i);
      EXPECT_LT(std::abs(evaluate(p, root)), kRoots * terms);
    }
  }
  EXPECT_TRUE(complex_roots(Polynomial{1}).empty());
}

TEST(ComplexRoots, MayHaveAProductThatNoDoubleHolds) {
  const auto roots = complex_roots(with_roots({*exact(-1e200), *exact(-3e200)}));
  ASSERT_EQ(roots.size(), 2u);
  EXPECT_NEAR(roots[0].real() / -1e200, 1.0, kRoots);
  EXPECT_NEAR(roots[1].real() / -3e200, 1.0, kRoots);
  const auto beyond = complex_roots(with_roots({-1, *exact(-1e300), *exact(-1e-300), *exact(-1e-301)}));
  ASSERT_EQ(beyond.size(), 4u);
}

TEST(ComplexRoots, OfWideRangeKeepTheirDigits) {
  const auto roots = complex_roots(with_roots({*exact(-1e-6), -1, *exact(-1e6)}));
  ASSERT_EQ(roots.size(), 3u);
  EXPECT_NEAR(roots[0].real() / -1e-6, 1.0, kRoots);
  EXPECT_NEAR(roots[1].real() / -1.0, 1.0, kRoots);
  EXPECT_NEAR(roots[2].real() / -1e6, 1.0, kRoots);
}

}  // namespace
}  // namespace mbk::lti
