#include "mbk/base/lti/rational.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/lti/test_polynomials.h"

namespace mbk::lti {
namespace rational_test {

using numeric::Random;

constexpr double kRounding = 1e-13;  // Horner and a small inverse in double

RationalMatrix random_matrix(Random& random, Index size) {
  RationalMatrix matrix(size);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      matrix(i, j) = *RationalFunction::of(random_polynomial(random, 1), random_polynomial(random, 1));
    }
  }
  return matrix;
}

TEST(RationalFunction, IsKeptInLowestTerms) {
  const auto f = RationalFunction::of(with_roots({1, 2, 2}) * Polynomial{6}, with_roots({2, 3}) * Polynomial{2});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->numerator(), with_roots({1, 2}) * Polynomial{3});
  EXPECT_EQ(f->denominator(), with_roots({3}));
  EXPECT_EQ(*f - *f, RationalFunction());
  EXPECT_EQ(*f / *f, RationalFunction(Polynomial{1}));
  EXPECT_FALSE(f->is_proper());
}

TEST(RationalFunction, RefusesAZeroDenominatorAndNumbersThatAreNot) {
  EXPECT_FALSE(RationalFunction::of({1}, {}));
  const double bad[] = {std::numeric_limits<double>::quiet_NaN()}, one[] = {1.0};
  EXPECT_FALSE(RationalFunction::from_decimals(bad, one));
  EXPECT_FALSE(RationalFunction::from_decimals(one, bad));
}

TEST(RationalMatrix, OfAnImpedanceHasItsValueOnTheAxis) {
  const Matrix M{{1.326, -0.935}, {-0.9, 1.883}}, B{{5.76, -2.14}, {-2.0, 10.56}}, K{{42.4, -28.6}, {-20.0, 125.3}};
  const auto Z = RationalMatrix::impedance(M, B, K);
  ASSERT_TRUE(Z);
  const double omega = 3.7;
  const std::complex<double> j(0.0, 1.0);
  const Eigen::MatrixXcd expected = j * omega * M + B - j / omega * K;
  EXPECT_LT(((*Z)(RadPerSec(omega)) - expected).norm(), kRounding * expected.norm());
  EXPECT_EQ(common_denominator(*Z), (Polynomial{0, 1}));
}

TEST(RationalMatrix, RefusesShapesAndNumbersThatAreNot) {
  const Matrix one = Matrix::Ones(1, 1), two = Matrix::Ones(2, 2);
  EXPECT_FALSE(RationalMatrix::impedance(one, two, two));
  EXPECT_FALSE(RationalMatrix::impedance(two, Matrix::Ones(2, 1), two));
  EXPECT_FALSE(RationalMatrix::impedance(one, one, one * std::nan("")));
}

TEST(Inverse, TimesTheMatrixIsTheIdentity) {
  Random random(1);
  for (Index size = 1; size <= 3; ++size) {
    const RationalMatrix matrix = random_matrix(random, size);
    const auto inverted = inverse(matrix);
    ASSERT_TRUE(inverted);
    EXPECT_EQ(matrix * *inverted, RationalMatrix::scalar(size, 1));
    EXPECT_EQ(*inverse(*inverted), matrix);
  }
}

TEST(Inverse, ExchangesRowsWhereItMust) {
  RationalMatrix swap(2);
  swap(0, 1) = swap(1, 0) = RationalFunction(Polynomial{0, 1});
  EXPECT_EQ(swap * *inverse(swap), RationalMatrix::scalar(2, 1));
}

TEST(Inverse, OfASingularMatrixFails) {
  RationalMatrix ones(2);
  for (Index i = 0; i < 4; ++i) ones(i / 2, i % 2) = RationalFunction(Polynomial{1, 1});
  ASSERT_FALSE(inverse(ones));
  EXPECT_EQ(inverse(ones).error().kind, ErrorKind::not_usable);
}

TEST(Poles, AreThoseOfEveryEntry) {
  RationalMatrix matrix(2);
  matrix(0, 0) = *RationalFunction::of({1}, {2, 1});
  matrix(0, 1) = *RationalFunction::of({1}, {4, 4, 1});
  matrix(1, 0) = *RationalFunction::of({1}, {0, 1});
  EXPECT_EQ(common_denominator(matrix), (Polynomial{0, 4, 4, 1}));
  const auto found = poles(matrix);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::abs(found[0]), 0.0, kRounding);
  EXPECT_NEAR(std::abs(found[1] + 2.0), 0.0, kRounding);
}

}  // namespace rational_test
}  // namespace mbk::lti
