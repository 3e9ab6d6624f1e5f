#include "mbk/teleop/conditions.h"

#include <type_traits>

#include "mbk/base/lti/on_axis.h"

namespace mbk::teleop {
namespace {

using lti::ComplexPolynomial;

/// n and d of a function, times what makes the coefficients of both whole.
struct WholeFraction {
  Polynomial numerator, denominator;
};

WholeFraction whole(const lti::RationalFunction& f) {
  using boost::multiprecision::denominator;
  using Integer = std::decay_t<decltype(denominator(Rational()))>;
  Integer common = 1;
  for (const Polynomial* p : {&f.numerator(), &f.denominator()}) {
    for (const Rational& c : p->coefficients()) common = lcm(common, Integer(denominator(c)));
  }
  const Polynomial factor{Rational(common)};
  return {f.numerator() * factor, f.denominator() * factor};
}

Polynomial real_part(const ComplexPolynomial& value) {
  return lti::in_square(value.re);
}

/// Im f(jω)/ω
Polynomial imaginary_part(const ComplexPolynomial& value) {
  return lti::in_square(lti::divide(value.im, Polynomial{0, 1}).quotient);
}

Polynomial squared_modulus(const Polynomial& d) {
  const ComplexPolynomial value = lti::on_axis(d);
  return real_part(value * lti::conjugate(value));
}

}  // namespace

ConditionsOnAxis ConditionsOnAxis::of(const lti::RationalMatrix& m) {
  ConditionsOnAxis result;
  const std::array<WholeFraction, 2> own = {whole(m(0, 0)), whole(m(1, 1))};
  for (const std::size_t i : {0, 1}) {
    const auto& [n, d] = own[i];
    result.resistance[i] = real_part(lti::on_axis(n) * lti::conjugate(lti::on_axis(d)));
    result.modulus[i] = squared_modulus(d);
  }
  const WholeFraction forward = whole(m(0, 1)), back = whole(m(1, 0));
  const Polynomial owns = own[0].denominator * own[1].denominator, cross = forward.denominator * back.denominator;
  // owns = g u, cross = g v, with u and v coprime: the scale is |g u v|²
  const Polynomial g = whole(lti::RationalFunction(lti::gcd(owns, cross))).numerator;
  const Polynomial u = squared_modulus(lti::divide(owns, g).quotient);
  const ComplexPolynomial p = lti::on_axis(forward.numerator * back.numerator) * lti::conjugate(lti::on_axis(cross));
  result.share = squared_modulus(lti::divide(cross, g).quotient);
  result.p_re = real_part(p) * u;
  result.p_im = imaginary_part(p) * u;
  result.scale = squared_modulus(cross) * u;
  return result;
}

ConditionsOnAxis ConditionsOnAxis::with_shortage(std::size_t i, const Rational& a) const {
  ConditionsOnAxis result = *this;
  const Polynomial above{Rational(numerator(a))}, below{Rational(denominator(a))};
  result.resistance[i] = resistance[i] * below - modulus[i] * above;
  for (Polynomial* p : {&result.modulus[i], &result.p_re, &result.p_im, &result.scale}) *p = *p * below;
  return result;
}

Polynomial ConditionsOnAxis::resistances() const {
  return resistance[0] * resistance[1] * share;
}

Polynomial ConditionsOnAxis::product() const {
  return Polynomial{2} * resistances() - p_re;
}

Polynomial ConditionsOnAxis::squares() const {
  const Polynomial r = resistances();
  return Polynomial{4} * r * (r - p_re) - Polynomial{0, 1} * p_im * p_im;
}

}  // namespace mbk::teleop
