#include "mbk/base/lti/integer_polynomial.h"

#include <cassert>
#include <cstdint>
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

/// lc(b)^(deg a − deg b + 1) times the remainder of a divided by b.
IntegerPolynomial pseudo_remainder(IntegerPolynomial a, const IntegerPolynomial& b) {
  for (std::size_t shift = a.size() - b.size() + 1; shift-- > 0;) {
    const Integer factor = a[shift + b.size() - 1];
    for (Integer& c : a) c *= b.back();
    for (std::size_t i = 0; i < b.size(); ++i) a[shift + i] -= factor * b[i];
    a.pop_back();
  }
  trim(a);
  return a;
}

constexpr std::uint64_t kPrime = 2147483647;  // 2³¹ − 1, so that products fit in 64 bits

std::uint64_t power_modulo(std::uint64_t base, std::uint64_t exponent) {
  std::uint64_t result = 1;
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 != 0) result = result * base % kPrime;
    base = base * base % kPrime;
  }
  return result;
}

std::vector<std::uint64_t> modulo(const IntegerPolynomial& p) {
  std::vector<std::uint64_t> result;
  for (const Integer& c : p) {
    const auto rest = Integer(abs(c) % kPrime).convert_to<std::uint64_t>();
    result.push_back(c.sign() < 0 && rest != 0 ? kPrime - rest : rest);
  }
  return result;
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

bool are_surely_coprime(const IntegerPolynomial& first, const IntegerPolynomial& second) {
  if (first.empty() || second.empty()) return false;
  std::vector<std::uint64_t> a = modulo(first), b = modulo(second);
  // a common divisor keeps its degree only where the leading coefficients stay
  if (a.back() == 0 || b.back() == 0) return false;
  if (a.size() < b.size()) std::swap(a, b);
  while (b.size() > 1) {
    const std::uint64_t inverse = power_modulo(b.back(), kPrime - 2);
    while (a.size() >= b.size()) {
      const std::uint64_t factor = a.back() * inverse % kPrime;
      const std::size_t shift = a.size() - b.size();
      for (std::size_t i = 0; i < b.size(); ++i)
        a[shift + i] = (a[shift + i] + kPrime - factor * b[i] % kPrime) % kPrime;
      while (!a.empty() && a.back() == 0) a.pop_back();
    }
    std::swap(a, b);
  }
  return !b.empty();
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
  assert(a.degree() >= b.degree());
  // r₀, r₁, … with β r_{k+1} = the pseudo-remainder of r_{k−1} by r_k; signs[k] r_k is what is wanted
  std::vector<IntegerPolynomial> r{primitive(a)};
  std::vector<int> signs{1};
  IntegerPolynomial next = primitive(b);
  Integer psi = -1, beta = (a.degree() - b.degree()) % 2 == 0 ? -1 : 1;
  int next_sign = 1;
  while (!next.empty()) {
    r.push_back(std::move(next));
    signs.push_back(next_sign);
    const IntegerPolynomial &before = r[r.size() - 2], &last = r.back();
    const auto drop = static_cast<unsigned>(before.size() - last.size());
    if (r.size() > 2) {
      const auto drop_before = static_cast<unsigned>(r[r.size() - 3].size() - before.size());
      const Integer head = pow(Integer(-before.back()), drop_before);
      // ψ = (−lc)^d / ψ^(d−1), a whole number
      psi = drop_before == 0 ? Integer(head * psi) : Integer(head / pow(psi, drop_before - 1));
      beta = -before.back() * pow(psi, drop);
    }
    next = pseudo_remainder(before, last);
    for (Integer& c : next) c /= beta;
    const int heads = last.back().sign() < 0 && drop % 2 == 0 ? -1 : 1;  // sign of lc^(drop + 1)
    next_sign = -signs[signs.size() - 2] * beta.sign() * heads;
  }
  for (std::size_t k = 0; k < r.size(); ++k) {
    if (signs[k] > 0) continue;
    for (Integer& c : r[k]) c = -c;
  }
  return r;
}

}  // namespace mbk::lti
