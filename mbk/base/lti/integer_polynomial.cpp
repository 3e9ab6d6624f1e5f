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

using Residues = std::vector<std::uint64_t>;  // of a polynomial modulo a prime, ascending, the last one not zero

std::uint64_t power_modulo(std::uint64_t base, std::uint64_t exponent, std::uint64_t prime) {
  std::uint64_t result = 1;
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 != 0) result = result * base % prime;
    base = base * base % prime;
  }
  return result;
}

std::uint64_t inverse_modulo(std::uint64_t value, std::uint64_t prime) {
  return power_modulo(value, prime - 2, prime);
}

std::uint64_t modulo(const Integer& value, std::uint64_t prime) {
  const auto rest = Integer(abs(value) % prime).convert_to<std::uint64_t>();
  return value.sign() < 0 && rest != 0 ? prime - rest : rest;
}

Residues modulo(const IntegerPolynomial& p, std::uint64_t prime) {
  Residues result;
  for (const Integer& c : p) result.push_back(modulo(c, prime));
  return result;
}

/// Their greatest common divisor modulo the prime, up to a factor.
Residues gcd_modulo(Residues a, Residues b, std::uint64_t prime) {
  if (a.size() < b.size()) std::swap(a, b);
  while (b.size() > 1) {
    const std::uint64_t inverse = inverse_modulo(b.back(), prime);
    while (a.size() >= b.size()) {
      const std::uint64_t factor = a.back() * inverse % prime;
      const std::size_t shift = a.size() - b.size();
      for (std::size_t i = 0; i < b.size(); ++i) a[shift + i] = (a[shift + i] + prime - factor * b[i] % prime) % prime;
      while (!a.empty() && a.back() == 0) a.pop_back();
    }
    std::swap(a, b);
  }
  return b.empty() ? a : b;
}

/// For an odd number between 61 and 2³², with the Miller–Rabin test, which is exact there with bases 2, 7 and 61
/// (Jaeschke 1993).
bool is_prime(std::uint64_t odd) {
  std::uint64_t odd_part = odd - 1;
  while (odd_part % 2 == 0) odd_part /= 2;
  const auto passes = [odd, odd_part](std::uint64_t base) {
    std::uint64_t power = power_modulo(base, odd_part, odd);
    if (power == 1) return true;
    for (std::uint64_t exponent = odd_part; exponent < odd - 1; exponent *= 2) {
      if (power == odd - 1) return true;
      power = power * power % odd;
    }
    return false;
  };
  return passes(2) && passes(7) && passes(61);
}

/// A polynomial known modulo the product of some primes, by its remainders between −modulus/2 and modulus/2.
struct Lifted {
  IntegerPolynomial value;
  Integer modulus = 1;

  /// Takes up the remainders modulo another prime (the Chinese remainder theorem). @returns whether the value changed
  bool take(const Residues& residues, std::uint64_t prime) {
    const std::uint64_t inverse = inverse_modulo(modulo(modulus, prime), prime);
    const Integer product = modulus * prime;
    value.resize(residues.size());
    bool changed = false;
    for (std::size_t i = 0; i < residues.size(); ++i) {
      const std::uint64_t step = (residues[i] + prime - modulo(value[i], prime)) % prime * inverse % prime;
      if (step == 0) continue;
      changed = true;
      value[i] += modulus * step;
      if (2 * value[i] > product) value[i] -= product;
    }
    modulus = product;
    return changed;
  }
};

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

std::optional<IntegerPolynomial> exact_quotient(IntegerPolynomial a, const IntegerPolynomial& b) {
  if (a.size() < b.size()) return a.empty() ? std::optional(a) : std::nullopt;
  IntegerPolynomial quotient(a.size() - b.size() + 1);
  for (std::size_t shift = quotient.size(); shift-- > 0;) {
    Integer rest;
    divide_qr(a[shift + b.size() - 1], b.back(), quotient[shift], rest);
    if (!rest.is_zero()) return std::nullopt;
    for (std::size_t i = 0; i < b.size(); ++i) a[shift + i] -= quotient[shift] * b[i];
  }
  trim(a);
  return a.empty() ? std::optional(std::move(quotient)) : std::nullopt;
}

IntegerPolynomial greatest_common_divisor(const IntegerPolynomial& first, const IntegerPolynomial& second) {
  IntegerPolynomial a = first, b = second;
  divide_by_content(a);
  divide_by_content(b);
  const Integer leading = gcd(a.back(), b.back());  // a multiple of that of the divisor
  Lifted lifted;
  for (std::uint64_t prime = kPrime;; prime -= 2) {
    if (!is_prime(prime)) continue;
    const Residues a_rest = modulo(a, prime), b_rest = modulo(b, prime);
    if (a_rest.back() == 0 || b_rest.back() == 0) continue;
    Residues common = gcd_modulo(a_rest, b_rest, prime);
    if (common.size() == 1) return {1};
    // a prime that divides a resultant gives too high a degree, never too low a one
    if (!lifted.value.empty() && common.size() > lifted.value.size()) continue;
    if (common.size() < lifted.value.size()) lifted = {};
    const std::uint64_t factor = modulo(leading, prime) * inverse_modulo(common.back(), prime) % prime;
    for (std::uint64_t& c : common) c = c * factor % prime;
    if (lifted.take(common, prime)) continue;
    IntegerPolynomial divisor = lifted.value;
    divide_by_content(divisor);
    if (divisor.back().sign() < 0) {
      for (Integer& c : divisor) c = -c;
    }
    if (exact_quotient(a, divisor) && exact_quotient(b, divisor)) return divisor;
  }
}

IntegerPolynomial derivative(const IntegerPolynomial& p) {
  IntegerPolynomial result;
  for (std::size_t i = 1; i < p.size(); ++i) result.push_back(p[i] * i);
  return result;
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
