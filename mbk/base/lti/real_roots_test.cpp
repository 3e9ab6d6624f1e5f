#include "mbk/base/lti/real_roots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mbk/base/lti/integer_polynomial.h"
#include "mbk/base/lti/test_polynomials.h"

namespace mbk::lti {
namespace real_roots_test {

using numeric::Random;

constexpr double kRounding = 4.5e-16;  // two units in the last place

TEST(DistinctRoots, CountsOpenAndHalfInfiniteIntervals) {
  const Polynomial p = Polynomial{-2} * with_roots({-3, 0, 0, 1, 1, 1, 4}) * Polynomial{1, 0, 1};
  EXPECT_EQ(distinct_roots(p), 4);
  EXPECT_EQ(distinct_roots(p, {Rational(0), {}}), 2);
  EXPECT_EQ(distinct_roots(p, {{}, Rational(0)}), 1);
  EXPECT_EQ(distinct_roots(p, {Rational(-3), Rational(4)}), 2);
  EXPECT_EQ(distinct_roots(p, {Rational(1), Rational(4)}), 0);
  EXPECT_EQ(distinct_roots(p, {Rational(5), Rational(2)}), 0);
  EXPECT_EQ(distinct_roots(Polynomial{5}), 0);
}

TEST(DistinctRoots, AgreesWithTheRootsThatMadeThePolynomial) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Rational> roots;
    for (int i = 0; i < 1 + trial % 6; ++i) roots.push_back(random_rational(random));
    const Polynomial p = with_roots(roots) * Polynomial{2, 1, 1};
    Rational low = random_rational(random), high = random_rational(random);
    if (low > high) std::swap(low, high);
    const std::set<Rational> distinct(roots.begin(), roots.end());
    const auto inside = std::count_if(distinct.begin(), distinct.end(),
                                      [&](const Rational& root) { return root > low && root < high; });
    EXPECT_EQ(distinct_roots(p, {low, high}), inside) << "trial " << trial;
  }
}

/// Different roots in (low, high), neither of which is one, by Sturm's theorem (1829).
int roots_by_sturm(const Polynomial& p, const Rational& low, const Rational& high) {
  const Polynomial simple = square_free(p);
  const auto sequence = signed_remainders(simple, simple.derivative());
  const auto variations = [&](const Rational& x) {
    int count = 0, before = 0;
    for (const IntegerPolynomial& f : sequence) {
      const int now = sign_at(f, x);
      if (now * before < 0) ++count;
      if (now != 0) before = now;
    }
    return count;
  };
  return variations(low) - variations(high);
}

TEST(IsolateRoots, FindsAsManyAsSturm) {
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    Polynomial p = random_polynomial(random, 1 + trial % 9);
    if (trial % 3 == 0) p = p * p * random_polynomial(random, 2);
    if (trial % 4 == 0) p = p * p + Polynomial{Rational(trial % 8 - 4, 1000000)};  // pairs that almost touch
    const Rational low = random_rational(random) - Rational(1, 97), high = low + abs(random_rational(random));
    if (p(low).is_zero() || p(high).is_zero() || low == high) continue;
    const auto brackets = isolate_roots(p, {low, high});
    EXPECT_EQ(static_cast<int>(brackets.size()), roots_by_sturm(p, low, high)) << "trial " << trial;
    for (const RootBracket& root : brackets) {
      if (root.low == root.high) {
        EXPECT_EQ(p(root.low), 0) << "trial " << trial;
      } else {
        EXPECT_EQ(roots_by_sturm(p, root.low, root.high), 1) << "trial " << trial;
      }
    }
  }
}

TEST(IsolateRoots, BracketsEachRootOnceInOrder) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Rational> roots;
    for (int i = 0; i < 1 + trial % 7; ++i) roots.push_back(random_rational(random));
    const Polynomial p = with_roots(roots) * Polynomial{3, 1, 1};
    const std::set<Rational> distinct(roots.begin(), roots.end());
    const auto brackets = isolate_roots(p);
    ASSERT_EQ(brackets.size(), distinct.size());
    auto root = distinct.begin();
    for (const RootBracket& bracket : brackets) {
      EXPECT_TRUE(bracket.low == bracket.high ? *root == bracket.low : bracket.low < *root && *root < bracket.high);
      EXPECT_NEAR(approximate(p, bracket), to_double(*root), kRounding * std::abs(to_double(*root)));
      ++root;
    }
  }
}

TEST(IsolateRoots, SeparatesRootsThatNoDoubleDoes) {
  const Rational apart(Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 40));
  const auto brackets = isolate_roots(with_roots({1, 1 + apart, *exact(1e-300), *exact(-1e300)}));
  ASSERT_EQ(brackets.size(), 4u);
  const Polynomial two = with_roots({1, 1 + apart});
  EXPECT_EQ(isolate_roots(two, {Rational(1), {}}).size(), 1u);
}

TEST(Approximate, HasTheRootsOfIrrationalNumbers) {
  const Polynomial p{-2, 0, 1};
  const auto brackets = isolate_roots(p);
  ASSERT_EQ(brackets.size(), 2u);
  EXPECT_NEAR(approximate(p, brackets[0]), -std::sqrt(2.0), kRounding * 2);
  EXPECT_NEAR(approximate(p, brackets[1]), std::sqrt(2.0), kRounding * 2);
  const Polynomial tiny{*exact(-2e-200), 0, 1};
  EXPECT_NEAR(approximate(tiny, isolate_roots(tiny, {Rational(0), {}})[0]) * 1e100, std::sqrt(2.0), kRounding * 2);
}

TEST(SignAtRoot, IsExactWhereADoubleSeesZero) {
  const Polynomial p{-2, 0, 1};
  const RootBracket root = isolate_roots(p, {Rational(0), {}})[0];
  EXPECT_EQ(sign_at_root(p * Polynomial{1, 5}, p, root), 0);
  EXPECT_EQ(sign_at_root(Polynomial(), p, root), 0);
  const Rational tiny = Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 60);
  EXPECT_EQ(sign_at_root(p + Polynomial{tiny}, p, root), 1);
  EXPECT_EQ(sign_at_root(p - Polynomial{tiny}, p, root), -1);
  EXPECT_EQ(sign_at_root(Polynomial{-3, 2}, p, root), -1);  // 2√2 < 3
  EXPECT_EQ(sign_at_root(Polynomial{-1, 1}, with_roots({1, 2}), {1, 1}), 0);
}

TEST(IsNonnegative, AllowsRootsThatOnlyTouch) {
  EXPECT_TRUE(is_nonnegative(with_roots({2, 2, 5, 5, 5, 5})));
  EXPECT_FALSE(is_nonnegative(with_roots({2, 2, 5, 5, 5})));
  EXPECT_TRUE(is_nonnegative(with_roots({-1, -3, 0})));
  EXPECT_TRUE(is_nonnegative(Polynomial()));
  EXPECT_FALSE(is_nonnegative(Polynomial{-1}));
  EXPECT_TRUE(is_nonnegative(Polynomial{2, -2, 1}));
  EXPECT_FALSE(is_nonnegative(Polynomial{1, 0, -1}));
}

TEST(IsNonnegative, SeesADipThatNoDoubleSees) {
  const Rational tiny = Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 50);
  const Polynomial touching = with_roots({3, 3});
  EXPECT_TRUE(is_nonnegative(touching));
  EXPECT_FALSE(is_nonnegative(touching - Polynomial{tiny}));
  const auto dip = negative_intervals(touching - Polynomial{tiny});
  ASSERT_EQ(dip.size(), 1u);
  EXPECT_LT((touching - Polynomial{tiny})(dip[0].witness), 0);
}

TEST(NegativeIntervals, AreWhereThePolynomialIsNegative) {
  const auto pieces = negative_intervals(with_roots({-2, 1, 3, 3, 6}));  // negative on (1, 3) and (3, 6)
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(to_double(pieces[0].low.low), 1.0);
  EXPECT_NEAR(to_double(pieces[0].high->low), 3.0, 3 * kRounding);
  EXPECT_NEAR(to_double(pieces[1].high->low), 6.0, 6 * kRounding);
  const auto ends = negative_intervals(Polynomial{-1} * with_roots({2, 5}));
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[0].low.high, 0);
  EXPECT_FALSE(ends[1].high);
}

TEST(NegativeIntervals, OfSeveralPolynomialsAreTheUnion) {
  // (1, 3) and (2, 5) overlap; (5, 7) only meets them, in a point where nothing is negative
  const Polynomial overlap[] = {with_roots({1, 3}), with_roots({2, 5})};
  const auto joined = negative_intervals(overlap);
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(to_double(joined[0].low.high), 1.0);
  EXPECT_EQ(to_double(joined[0].high->low), 5.0);
  const Polynomial meeting[] = {with_roots({1, 3}), with_roots({2, 5}), with_roots({5, 7})};
  EXPECT_EQ(negative_intervals(meeting).size(), 2u);
}

TEST(NegativeIntervals, AgreeWithADenseGrid) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Polynomial p = random_polynomial(random, 5) - random_polynomial(random, trial % 5);
    const auto pieces = negative_intervals(p);
    for (const PositiveInterval& piece : pieces) EXPECT_LT(p(piece.witness), 0);
    for (int i = 1; i < 200; ++i) {
      const Rational x(i * i, 300);
      const bool listed = std::any_of(pieces.begin(), pieces.end(), [&](const PositiveInterval& piece) {
        return x > piece.low.high && (!piece.high || x < piece.high->low);
      });
      EXPECT_EQ(listed, p(x) < 0) << "trial " << trial << ", x " << to_double(x);
    }
  }
}

}  // namespace real_roots_test
}  // namespace mbk::lti
