#include "mbk/lti/integer_polynomial.h"

#include <utility>

namespace mbk::lti {
namespace {

void trim(IntegerPolynomial& p) {
  while (!p.empty() && p.back().is_zero()) p.pop_back();
}

void divide_by_content(IntegerPolynomial& p) {
  Integer content = 0;
  for (const Integer& c : p) {
    content = gcd(content, c);
    if (content == 1) return;
  }
  if (content.is_zero()) return;
  for (Integer& c : p) c /= content;
}

}  // namespace

IntegerPolynomial primitive(const Polynomial& p) {
  Integer common = 1;
  for (const Rational& c : p.coefficients()) common = lcm(common, Integer(denominator(c)));
  IntegerPolynomial result;
  result.reserve(p.coefficients().size());
  for (const Rational& c : p.coefficients()) {
    result.push_back(Integer(numerator(c)) * (common / Integer(denominator(c))));
  }
  divide_by_content(result);
  return result;
}

IntegerPolynomial primitive_remainder(IntegerPolynomial a, const IntegerPolynomial& b) {
  const Integer scale = abs(b.back());
  while (a.size() >= b.size()) {
    const Integer factor = b.back().sign() * a.back();
    const std::size_t shift = a.size() - b.size();
    for (Integer& c : a) c *= scale;
    for (std::size_t i = 0; i < b.size(); ++i) a[shift + i] -= factor * b[i];
    trim(a);
  }
  divide_by_content(a);
  return a;
}

int sign_at(const IntegerPolynomial& p, const Rational& x) {
  // Horner for dⁿ p(n/d), d > 0
  const Integer n(numerator(x)), d(denominator(x));
  Integer value = 0, power = 1;
  for (std::size_t i = p.size(); i-- > 0;) {
    value = value * n + p[i] * power;
    power *= d;
  }
  return value.sign();
}

std::vector<IntegerPolynomial> signed_remainders(const Polynomial& a, const Polynomial& b) {
  std::vector<IntegerPolynomial> sequence{primitive(a)};
  IntegerPolynomial next = primitive(b);
  while (!next.empty()) {
    sequence.push_back(std::move(next));
    next = primitive_remainder(sequence[sequence.size() - 2], sequence.back());
    for (Integer& c : next) c = -c;
  }
  return sequence;
}

}  // namespace mbk::lti
