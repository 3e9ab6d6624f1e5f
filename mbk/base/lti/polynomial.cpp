#include "mbk/base/lti/polynomial.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "mbk/base/lti/integer_polynomial.h"

namespace mbk::lti {

namespace {

Polynomial from_integers(const IntegerPolynomial& p) {
  return Polynomial(std::vector<Rational>(p.begin(), p.end()));
}

}  // namespace

Result<Rational> exact(double value) {
  if (!std::isfinite(value)) return bad_data("a coefficient is not finite");
  // the shortest form: -d.ddde-XX
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::scientific).ptr;
  const std::string_view text(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
  const std::size_t e = text.find('e');
  Integer digits = 0;
  int exponent = 0;
  bool after_point = false;
  for (const char c : text.substr(0, e)) {
    if (c == '.') after_point = true;
    if (c < '0' || c > '9') continue;
    digits = 10 * digits + (c - '0');
    if (after_point) --exponent;
  }
  int power = 0;
  const std::size_t number = text[e + 1] == '+' ? e + 2 : e + 1;
  std::from_chars(text.data() + number, text.data() + text.size(), power);
  exponent += power;
  if (text.front() == '-') digits = -digits;
  const Integer scale = pow(Integer(10), static_cast<unsigned>(std::abs(exponent)));
  return exponent < 0 ? Rational(digits, scale) : Rational(digits * scale);
}

double to_double(const Rational& value) {
  return value.convert_to<double>();
}

Rational simplest_between(const Rational& low, const Rational& high) {
  if (low.sign() <= 0 && high.sign() >= 0) return 0;
  if (high.sign() < 0) return -simplest_between(-high, -low);
  const Rational whole = Rational(numerator(low) / denominator(low));
  if (whole == low) return whole;
  if (whole + 1 <= high) return whole + 1;
  return whole + 1 / simplest_between(1 / (high - whole), 1 / (low - whole));
}

Polynomial::Polynomial(std::initializer_list<Rational> ascending) : coefficients_(ascending) {
  trim();
}

Polynomial::Polynomial(std::vector<Rational> ascending) : coefficients_(std::move(ascending)) {
  trim();
}

void Polynomial::trim() {
  while (!coefficients_.empty() && coefficients_.back().is_zero()) coefficients_.pop_back();
}

Result<Polynomial> Polynomial::from_decimals(std::span<const double> ascending) {
  std::vector<Rational> coefficients;
  for (const double value : ascending) {
    auto coefficient = MBK_TRY(exact(value));
    coefficients.push_back(std::move(coefficient));
  }
  return Polynomial(std::move(coefficients));
}

Rational Polynomial::coefficient(int power) const {
  return power < 0 || power > degree() ? Rational(0) : coefficients_[static_cast<std::size_t>(power)];
}

Rational Polynomial::operator()(const Rational& x) const {
  Rational value = 0;
  for (std::size_t i = coefficients_.size(); i-- > 0;) value = value * x + coefficients_[i];
  return value;
}

Polynomial Polynomial::derivative() const {
  std::vector<Rational> result;
  for (std::size_t i = 1; i < coefficients_.size(); ++i) result.push_back(coefficients_[i] * i);
  return Polynomial(std::move(result));
}

Polynomial& Polynomial::operator+=(const Polynomial& other) {
  coefficients_.resize(std::max(coefficients_.size(), other.coefficients_.size()));
  for (std::size_t i = 0; i < other.coefficients_.size(); ++i) coefficients_[i] += other.coefficients_[i];
  trim();
  return *this;
}

Polynomial& Polynomial::operator-=(const Polynomial& other) {
  coefficients_.resize(std::max(coefficients_.size(), other.coefficients_.size()));
  for (std::size_t i = 0; i < other.coefficients_.size(); ++i) coefficients_[i] -= other.coefficients_[i];
  trim();
  return *this;
}

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.is_zero() || b.is_zero()) return {};
  std::vector<Rational> product(a.coefficients_.size() + b.coefficients_.size() - 1);
  for (std::size_t i = 0; i < a.coefficients_.size(); ++i) {
    for (std::size_t j = 0; j < b.coefficients_.size(); ++j) product[i + j] += a.coefficients_[i] * b.coefficients_[j];
  }
  return Polynomial(std::move(product));
}

Division divide(const Polynomial& a, const Polynomial& b) {
  assert(!b.is_zero());
  if (a.degree() < b.degree()) return {Polynomial(), a};
  std::vector<Rational> rest = a.coefficients();
  const std::size_t n = b.coefficients().size();
  std::vector<Rational> quotient(rest.size() - n + 1);
  for (std::size_t k = quotient.size(); k-- > 0;) {
    quotient[k] = rest[k + n - 1] / b.leading();
    for (std::size_t i = 0; i < n; ++i) rest[k + i] -= quotient[k] * b.coefficients()[i];
  }
  return {Polynomial(std::move(quotient)), Polynomial(std::move(rest))};
}

Polynomial monic(const Polynomial& p) {
  return p.is_zero() ? p : p * Polynomial{1 / p.leading()};
}

Polynomial gcd(const Polynomial& a, const Polynomial& b) {
  if (a.is_zero() || b.is_zero()) return monic(a.is_zero() ? b : a);
  return monic(from_integers(greatest_common_divisor(primitive(a), primitive(b))));
}

Polynomial square_free(const Polynomial& p) {
  const IntegerPolynomial whole = primitive(p);
  if (whole.size() < 2) return Polynomial{1};
  const IntegerPolynomial repeated = greatest_common_divisor(whole, derivative(whole));
  return monic(repeated.size() == 1 ? p : from_integers(exact_quotient(whole, repeated).value()));
}

std::vector<Polynomial> square_free_factors(const Polynomial& p) {
  std::vector<Polynomial> factors;
  const Polynomial common = gcd(p, p.derivative());
  Polynomial b = divide(p, common).quotient;
  Polynomial d = divide(p.derivative(), common).quotient - b.derivative();
  while (b.degree() > 0) {
    factors.push_back(gcd(b, d));
    b = divide(b, factors.back()).quotient;
    d = divide(d, factors.back()).quotient - b.derivative();
  }
  return factors;
}

}  // namespace mbk::lti
