#include "mbk/base/lti/real_roots.h"

#include <algorithm>
#include <utility>

#include "mbk/base/lti/integer_polynomial.h"

namespace mbk::lti {
namespace {

IntegerPolynomial once(const Polynomial& p) {
  return primitive(square_free(p));
}

/// p(x + 1)
void shift_by_one(IntegerPolynomial& p) {
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    for (std::size_t k = p.size() - 1; k-- > i;) p[k] += p[k + 1];
  }
}

/// A positive multiple of p(low + (high − low) x).
IntegerPolynomial on_unit_interval(const IntegerPolynomial& p, const Rational& low, const Rational& high) {
  const Rational width = high - low;
  const Integer common = lcm(Integer(denominator(low)), Integer(denominator(width)));
  const Integer start = numerator(low) * (common / denominator(low));
  const Integer step = numerator(width) * (common / denominator(width));
  // Horner for commonⁿ p((start + step x)/common)
  IntegerPolynomial result;
  Integer power = 1;
  for (std::size_t i = p.size(); i-- > 0;) {
    result.insert(result.begin(), Integer(0));
    for (std::size_t k = 0; k + 1 < result.size(); ++k) result[k] = result[k + 1] * start + result[k] * step;
    result.back() *= step;
    result.front() += p[i] * power;
    power *= common;
  }
  return result;
}

/// At least as many as p has roots in (0, 1), and as many up to an even number (Descartes, by x → 1/(1 + x)); more
/// than one is said as two.
int descartes_bound(const IntegerPolynomial& p) {
  IntegerPolynomial turned(p.rbegin(), p.rend());
  shift_by_one(turned);
  int count = 0, before = 0;
  for (const Integer& c : turned) {
    const int now = c.sign();
    if (now * before < 0 && ++count > 1) break;
    if (now != 0) before = now;
  }
  return count;
}

/// Surely no root in (low, high); false says nothing.
bool is_surely_rootless(const IntegerPolynomial& p, const RootBracket& range) {
  return descartes_bound(on_unit_interval(p, range.low, range.high)) == 0;
}

Integer value_at_one(const IntegerPolynomial& p) {
  Integer sum = 0;
  for (const Integer& c : p) sum += c;
  return sum;
}

/// Isolates the roots of a square-free polynomial by halving until Descartes' rule counts none or one (Collins and
/// Akritas 1976).
void isolate(const IntegerPolynomial& p, const RootBracket& range, std::vector<RootBracket>& found) {
  const int count = descartes_bound(p);
  if (count == 0) return;
  if (count == 1 && !p.front().is_zero() && !value_at_one(p).is_zero()) {
    found.push_back(range);
    return;
  }
  IntegerPolynomial half = p;  // 2ⁿ p(x/2)
  for (std::size_t i = 0; i < half.size(); ++i) half[i] <<= half.size() - 1 - i;
  const Rational middle = (range.low + range.high) / 2;
  isolate(half, {range.low, middle}, found);
  shift_by_one(half);
  if (half.front().is_zero()) found.push_back({middle, middle});
  isolate(half, {middle, range.high}, found);
}

/// Every root lies in (−bound, bound): 2 max |cₙ₋ₖ/cₙ|^(1/k) (Fujiwara 1916), up to a power of two.
Rational root_bound(const IntegerPolynomial& p) {
  const auto bits = [](const Integer& c) { return static_cast<int>(msb(Integer(abs(c)))); };
  int exponent = 0;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    if (p[i].is_zero()) continue;
    const int k = static_cast<int>(p.size() - 1 - i), ratio = bits(p[i]) - bits(p.back()) + 1;
    exponent = std::max(exponent, ratio / k + 1);
  }
  return Rational(Integer(1) << static_cast<unsigned>(exponent + 1));
}

/// Every root of a square-free polynomial in the interval, ascending.
std::vector<RootBracket> isolate_once(const IntegerPolynomial& p, const Interval& interval) {
  std::vector<RootBracket> found;
  if (p.size() < 2) return found;
  const Rational bound = root_bound(p);
  const Rational low = interval.low ? std::max<Rational>(*interval.low, -bound) : -bound;
  const Rational high = interval.high ? std::min<Rational>(*interval.high, bound) : bound;
  const auto within = [&](const Rational& from, const Rational& to) {
    if (from < to) isolate(on_unit_interval(p, from, to), {from, to}, found);
  };
  within(low, std::min<Rational>(high, 0));
  if (low < 0 && high > 0 && p.front().is_zero()) found.push_back({0, 0});
  within(std::max<Rational>(low, 0), high);
  return found;
}

/// Halves the bracket once. `p` changes its sign at the root.
void halve(const IntegerPolynomial& p, RootBracket& bracket) {
  const Rational middle = (bracket.low + bracket.high) / 2;
  const int sign = sign_at(p, middle);
  if (sign == 0) {
    bracket = {middle, middle};
  } else if (sign == sign_at(p, bracket.low)) {
    bracket.low = middle;
  } else {
    bracket.high = middle;
  }
}

}  // namespace

int distinct_roots(const Polynomial& p, const Interval& interval) {
  return static_cast<int>(isolate_roots(p, interval).size());
}

std::vector<RootBracket> isolate_roots(const Polynomial& p, const Interval& interval) {
  return isolate_once(once(p), interval);
}

RootBracket refine(const Polynomial& p, const RootBracket& bracket, int bits) {
  if (bracket.low == bracket.high) return bracket;
  const IntegerPolynomial simple = once(p);
  const Rational share(Integer(1), Integer(1) << static_cast<unsigned>(bits));
  RootBracket finer = bracket;
  while (finer.high - finer.low > share * std::min<Rational>(abs(finer.low), abs(finer.high))) halve(simple, finer);
  return finer;
}

double approximate(const Polynomial& p, const RootBracket& bracket) {
  const RootBracket finer = refine(p, bracket);
  return to_double((finer.low + finer.high) / 2);
}

int sign_at_root(const Polynomial& q, const Polynomial& p, const RootBracket& bracket) {
  if (q.is_zero()) return 0;
  if (bracket.low == bracket.high) return q(bracket.low).sign();
  const Polynomial common = gcd(p, q);
  if (common.degree() > 0 && distinct_roots(common, {bracket.low, bracket.high}) > 0) return 0;
  const IntegerPolynomial simple = once(p), other = primitive(q);
  RootBracket finer = bracket;
  while (finer.low != finer.high && !is_surely_rootless(other, finer)) halve(simple, finer);
  return q((finer.low + finer.high) / 2).sign();
}

std::vector<PositiveInterval> negative_intervals(std::span<const Polynomial> polynomials) {
  const auto any_negative = [&](const auto& sign) {
    return std::any_of(polynomials.begin(), polynomials.end(), [&](const Polynomial& p) { return sign(p) < 0; });
  };
  Polynomial all{1};  // each root of any of them, once
  for (const Polynomial& p : polynomials) {
    if (p.is_zero()) continue;
    const Polynomial simple = square_free(p);
    all = all * divide(simple, gcd(all, simple)).quotient;
  }
  std::vector<RootBracket> ends{{0, 0}};
  for (const RootBracket& root : isolate_roots(all, {Rational(0), {}})) ends.push_back(refine(all, root));

  std::vector<PositiveInterval> found;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const bool last = i + 1 == ends.size();
    const Rational& begin = ends[i].high;
    const Rational witness = !last ? (begin + ends[i + 1].low) / 2 : begin.is_zero() ? Rational(1) : 2 * begin;
    if (!any_negative([&](const Polynomial& p) { return p(witness).sign(); })) continue;
    const auto high = last ? std::nullopt : std::optional(ends[i + 1]);
    const bool joins = i > 0 && !found.empty() && found.back().high && found.back().high->low == ends[i].low &&
                       any_negative([&](const Polynomial& p) { return sign_at_root(p, all, ends[i]); });
    if (joins) {
      found.back().high = high;
    } else {
      found.push_back({ends[i], high, witness});
    }
  }
  return found;
}

std::vector<PositiveInterval> negative_intervals(const Polynomial& p) {
  return negative_intervals(std::span(&p, 1));
}

bool is_nonnegative(const Polynomial& p) {
  if (p.is_zero()) return true;
  if (p.leading().sign() < 0) return false;
  const std::vector<Polynomial> factors = square_free_factors(p);
  for (std::size_t k = 0; k < factors.size(); k += 2) {  // of odd multiplicity: there p changes its sign
    if (!isolate_once(primitive(factors[k]), {Rational(0), {}}).empty()) return false;
  }
  return true;
}

}  // namespace mbk::lti
