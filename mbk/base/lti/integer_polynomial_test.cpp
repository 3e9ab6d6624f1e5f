#include "mbk/base/lti/integer_polynomial.h"

#include <gtest/gtest.h>

#include "mbk/base/lti/test_polynomials.h"

namespace mbk::lti {
namespace {

using numeric::Random;

Polynomial as_rational(const IntegerPolynomial& p) {
  return Polynomial(std::vector<Rational>(p.begin(), p.end()));
}

/// Every other coefficient zero, so that degrees drop by more than one.
Polynomial sparse(Random& random, int degree) {
  std::vector<Rational> coefficients(static_cast<std::size_t>(degree) + 1);
  for (std::size_t i = 0; i < coefficients.size(); i += 3) coefficients[i] = random_rational(random);
  coefficients.back() = random_rational(random) - 20;
  return Polynomial(coefficients);
}

TEST(SignedRemainders, AreThoseOfDivisionUpToPositiveFactors) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const int degree = 3 + trial % 6;
    const Polynomial shared = trial % 4 == 0 ? random_polynomial(random, 2) : Polynomial{-1};
    const Polynomial a = shared * sparse(random, degree);
    const Polynomial b = shared * (trial % 2 == 0 ? sparse(random, degree - trial % 3) : random_polynomial(random, 2));
    std::vector<Polynomial> expected{a, b};
    for (;;) {
      const Polynomial next = -divide(expected[expected.size() - 2], expected.back()).remainder;
      if (next.is_zero()) break;
      expected.push_back(next);
    }
    const auto found = signed_remainders(a, b);
    ASSERT_EQ(found.size(), expected.size()) << "trial " << trial;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(monic(as_rational(found[k])), monic(expected[k])) << "trial " << trial << ", " << k;
      EXPECT_EQ(found[k].back().sign(), expected[k].leading().sign()) << "trial " << trial << ", " << k;
    }
  }
}

TEST(GreatestCommonDivisor, IsFoundWhereThePrimeHidesIt) {
  // 2³¹ − 1 divides the leading coefficient of the root that both share
  const Polynomial shared{1, 2147483647};
  EXPECT_EQ(gcd(shared * Polynomial{1, 1}, shared * Polynomial{2, 1}), monic(shared));
}

TEST(GreatestCommonDivisor, IsTheLastOfTheSignedRemainders) {
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Polynomial shared = trial % 5 == 0 ? Polynomial{1} : random_polynomial(random, trial % 5);
    const Polynomial a = shared * random_polynomial(random, 6), b = shared * random_polynomial(random, 1 + trial % 4);
    const IntegerPolynomial found = greatest_common_divisor(primitive(a), primitive(b));
    EXPECT_EQ(monic(as_rational(found)), monic(as_rational(signed_remainders(a, b).back()))) << "trial " << trial;
    EXPECT_TRUE(exact_quotient(primitive(a), found)) << "trial " << trial;
    EXPECT_GT(found.back(), 0) << "trial " << trial;
  }
}

TEST(GreatestCommonDivisor, HasLongerCoefficientsThanAPrime) {
  const Polynomial shared = with_roots({Rational(123456789012345678), Rational(-98765432109876543, 7)});
  const IntegerPolynomial found =
      greatest_common_divisor(primitive(shared * Polynomial{1, 3}), primitive(shared * Polynomial{2, 0, 5}));
  EXPECT_EQ(found, primitive(shared));
}

TEST(ExactQuotient, IsNoneWhereARemainderIsLeft) {
  EXPECT_EQ(exact_quotient({-1, 0, 1}, {1, 1}), (IntegerPolynomial{-1, 1}));
  EXPECT_FALSE(exact_quotient({1, 0, 1}, {1, 1}));
  EXPECT_FALSE(exact_quotient({1, 1}, {2, 2}));
  EXPECT_FALSE(exact_quotient({1}, {1, 1}));
}

TEST(SignAt, IsThatOfTheValue) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Polynomial p = random_polynomial(random, trial % 5);
    const Rational x = random_rational(random);
    EXPECT_EQ(sign_at(primitive(p), x), p(x).sign());
  }
}

}  // namespace
}  // namespace mbk::lti
