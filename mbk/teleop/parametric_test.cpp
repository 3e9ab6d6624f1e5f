#include "mbk/teleop/parametric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "mbk/base/numeric/random.h"

namespace mbk::teleop {
namespace {

ParametricPolynomial random_parametric(numeric::Random& random, int degree) {
  std::vector<Polynomial> coefficients;
  for (int i = 0; i <= degree; ++i) {
    coefficients.push_back(Polynomial{static_cast<int>(random.below(11)) - 5, static_cast<int>(random.below(5)) + 1});
  }
  return ParametricPolynomial(std::move(coefficients));
}

TEST(Eliminate, GivesTheDiscriminantOfAQuadratic) {
  const ParametricPolynomial p({Polynomial{0, 1}, Polynomial{3}, Polynomial{1}});  // x² + 3x + k
  const Elimination e = eliminate(p, p.derivative());
  EXPECT_EQ(lti::monic(e.resultant), lti::monic(Polynomial{9, -4}));
}

TEST(Eliminate, ResultantIsZeroExactlyWhereARootIsShared) {
  numeric::Random random(5);
  for (int trial = 0; trial < 10; ++trial) {
    const ParametricPolynomial a = random_parametric(random, 4), b = random_parametric(random, 3);
    const Elimination e = eliminate(a, b);
    // at k = 2 one root is made common: a(x) − a(1) and b(x) − b(1) share x = 1
    const auto shifted = [](const ParametricPolynomial& p) {
      return p - ParametricPolynomial({Polynomial{p.at(2)(1)}});
    };
    EXPECT_EQ(e.resultant.is_zero(), e.common.degree() > 0);
    EXPECT_TRUE(eliminate(shifted(a), shifted(b)).resultant(2).is_zero()) << trial;
    const int k = static_cast<int>(random.below(50)) + 100;
    EXPECT_EQ(e.resultant(k).is_zero(), lti::gcd(a.at(k), b.at(k)).degree() > 0) << trial;
  }
}

TEST(Eliminate, SaysHowFarItIs) {
  numeric::Random random(7);
  const ParametricPolynomial p = random_parametric(random, 6);
  std::vector<double> shares;
  std::ignore = eliminate(p, p.derivative(), [&](double share) { shares.push_back(share); });
  ASSERT_EQ(shares.size(), 5u);
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_GT(shares.front(), 0.0);
  EXPECT_LT(shares.front(), 0.1);  // the last steps cost most
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(Eliminate, FindsTheCommonFactor) {
  numeric::Random random(6);
  for (int trial = 0; trial < 10; ++trial) {
    const ParametricPolynomial shared = split_content(random_parametric(random, 2)).part;
    const ParametricPolynomial a = shared * random_parametric(random, 3), b = shared * random_parametric(random, 2);
    const Elimination e = eliminate(a, b);
    EXPECT_TRUE(e.resultant.is_zero());
    EXPECT_GE(e.common.degree(), 2);
    EXPECT_EQ(quotient(a, e.common) * e.common, a);
  }
}

TEST(AxisParts, AreThoseOfTheValueOnTheAxis) {
  const ParametricPolynomial p = ParametricPolynomial::of({1, 2, 3, 4, 5});  // of s = 2j: 1 − 12 + 80 + 2j (2 − 16)
  EXPECT_EQ(axis_parts(p).even.at(0)(4), 69);
  EXPECT_EQ(axis_parts(p).odd.at(0)(4), -14);
}

}  // namespace
}  // namespace mbk::teleop
