#include "mbk/teleop/parametric.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mbk::teleop {
namespace {

Polynomial power(const Polynomial& p, int exponent) {
  Polynomial result{1};
  for (int i = 0; i < exponent; ++i) result = result * p;
  return result;
}

ParametricPolynomial scaled(const ParametricPolynomial& p, const Polynomial& factor) {
  std::vector<Polynomial> coefficients;
  for (const Polynomial& c : p.coefficients()) coefficients.push_back(c * factor);
  return ParametricPolynomial(std::move(coefficients));
}

/// Every coefficient over `divisor`, which divides it.
ParametricPolynomial divided(const ParametricPolynomial& p, const Polynomial& divisor) {
  std::vector<Polynomial> coefficients;
  for (const Polynomial& c : p.coefficients()) coefficients.push_back(lti::divide(c, divisor).quotient);
  return ParametricPolynomial(std::move(coefficients));
}

ParametricPolynomial shifted(const ParametricPolynomial& p, int powers) {
  std::vector<Polynomial> coefficients(static_cast<std::size_t>(powers));
  coefficients.insert(coefficients.end(), p.coefficients().begin(), p.coefficients().end());
  return ParametricPolynomial(std::move(coefficients));
}

/// The remainder of lc(b)^(deg a − deg b + 1) a by b.
ParametricPolynomial pseudo_remainder(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  ParametricPolynomial rest = a;
  int left = a.degree() - b.degree() + 1;
  while (!rest.is_zero() && rest.degree() >= b.degree()) {
    const ParametricPolynomial term = shifted(ParametricPolynomial({rest.leading()}), rest.degree() - b.degree());
    rest = scaled(rest, b.leading()) - term * b;
    --left;
  }
  return scaled(rest, power(b.leading(), left));
}

ParametricPolynomial part(const ParametricPolynomial& p) {
  return split_content(p).part;
}

}  // namespace

ParametricPolynomial::ParametricPolynomial(std::vector<Polynomial> ascending) : coefficients_(std::move(ascending)) {
  trim();
}

ParametricPolynomial ParametricPolynomial::of(const Polynomial& p) {
  std::vector<Polynomial> coefficients;
  for (const Rational& c : p.coefficients()) coefficients.push_back(Polynomial{c});
  return ParametricPolynomial(std::move(coefficients));
}

void ParametricPolynomial::trim() {
  while (!coefficients_.empty() && coefficients_.back().is_zero()) coefficients_.pop_back();
}

Polynomial ParametricPolynomial::at(const Rational& k) const {
  std::vector<Rational> values;
  for (const Polynomial& c : coefficients_) values.push_back(c(k));
  return Polynomial(std::move(values));
}

ParametricPolynomial ParametricPolynomial::derivative() const {
  std::vector<Polynomial> coefficients;
  for (std::size_t i = 1; i < coefficients_.size(); ++i) {
    coefficients.push_back(coefficients_[i] * Polynomial{Rational(i)});
  }
  return ParametricPolynomial(std::move(coefficients));
}

ParametricPolynomial operator+(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  std::vector<Polynomial> sum(std::max(a.coefficients_.size(), b.coefficients_.size()));
  for (std::size_t i = 0; i < a.coefficients_.size(); ++i) sum[i] += a.coefficients_[i];
  for (std::size_t i = 0; i < b.coefficients_.size(); ++i) sum[i] += b.coefficients_[i];
  return ParametricPolynomial(std::move(sum));
}

ParametricPolynomial operator-(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  return a + scaled(b, Polynomial{-1});
}

ParametricPolynomial operator*(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  if (a.is_zero() || b.is_zero()) return {};
  std::vector<Polynomial> product(a.coefficients_.size() + b.coefficients_.size() - 1);
  for (std::size_t i = 0; i < a.coefficients_.size(); ++i) {
    for (std::size_t j = 0; j < b.coefficients_.size(); ++j) {
      product[i + j] += a.coefficients_[i] * b.coefficients_[j];
    }
  }
  return ParametricPolynomial(std::move(product));
}

ContentAndPart split_content(const ParametricPolynomial& p) {
  using boost::multiprecision::denominator;
  using boost::multiprecision::numerator;
  using Integer = std::decay_t<decltype(numerator(Rational()))>;
  Polynomial content;
  for (const Polynomial& c : p.coefficients()) content = lti::gcd(content, c);
  const ParametricPolynomial rest = content.degree() == 0 ? p : divided(p, content);
  Integer numerators = 0, denominators = 1;
  for (const Polynomial& c : rest.coefficients()) {
    for (const Rational& value : c.coefficients()) {
      numerators = gcd(numerators, Integer(numerator(value)));
      denominators = lcm(denominators, Integer(denominator(value)));
    }
  }
  return {content, scaled(rest, Polynomial{Rational(denominators, numerators)})};
}

namespace {

constexpr double kGrowth = 3.5;  // of a step's cost with its number: degree squared, and digits

/// Cost of the first `steps` of an elimination of n steps, up to a factor.
double cost_of_steps(int steps, int n) {
  double cost = 0.0;
  for (int i = 1; i <= steps; ++i) cost += (n - i + 1) * std::pow(i, kGrowth);
  return cost;
}

}  // namespace

double elimination_cost(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  const int n = std::min(a.degree(), b.degree());
  int largest = 1;
  for (const ParametricPolynomial* const p : {&a, &b}) {
    for (const Polynomial& c : p->coefficients()) largest = std::max(largest, c.degree());
  }
  return cost_of_steps(n, n) * std::pow(largest, kGrowth);
}

Elimination eliminate(const ParametricPolynomial& first, const ParametricPolynomial& second,
                      const std::function<void(double)>& progress) {
  const bool swap = first.degree() < second.degree();
  const auto [content_a, part_a] = split_content(swap ? second : first);
  const auto [content_b, part_b] = split_content(swap ? first : second);
  ParametricPolynomial a = part_a, b = part_b;
  // the resultant of a product with a content is the content to the other's degree
  const Polynomial contents = power(content_a, b.degree()) * power(content_b, a.degree());
  Polynomial g{1}, h{1};
  const int steps = b.degree();
  while (b.degree() > 0) {
    const int step = a.degree() - b.degree();
    const ParametricPolynomial remainder = pseudo_remainder(a, b);
    const Polynomial divisor = g * power(h, step);
    a = std::exchange(b, divided(remainder, divisor));
    g = a.leading();
    if (step > 0) h = lti::divide(power(g, step), power(h, step - 1)).quotient;
    if (b.is_zero()) return {part(a), {}};
    if (progress) progress(cost_of_steps(steps - b.degree(), steps) / cost_of_steps(steps, steps));
  }
  const Polynomial resultant =
      a.degree() == 0 ? Polynomial{1} : lti::divide(power(b.leading(), a.degree()), power(h, a.degree() - 1)).quotient;
  return {ParametricPolynomial::of(Polynomial{1}), resultant * contents};
}

ParametricPolynomial quotient(const ParametricPolynomial& a, const ParametricPolynomial& b) {
  ParametricPolynomial rest = a, result;
  while (!rest.is_zero()) {
    const ParametricPolynomial term =
        shifted(ParametricPolynomial({lti::divide(rest.leading(), b.leading()).quotient}), rest.degree() - b.degree());
    result = result + term;
    rest = rest - term * b;
  }
  return result;
}

AxisParts axis_parts(const ParametricPolynomial& p) {
  std::vector<Polynomial> even, odd;
  for (std::size_t i = 0; i < p.coefficients().size(); ++i) {
    const Polynomial& c = p.coefficients()[i];
    (i % 2 == 0 ? even : odd).push_back(i % 4 < 2 ? c : -c);
  }
  return {ParametricPolynomial(std::move(even)), ParametricPolynomial(std::move(odd))};
}

}  // namespace mbk::teleop
