#pragma once

#include <complex>

#include "mbk/base/lti/polynomial.h"

namespace mbk::lti {

/// A polynomial of a real variable with complex coefficients: re + j im.
struct ComplexPolynomial {
  Polynomial re, im;

  [[nodiscard]] bool is_zero() const { return re.is_zero() && im.is_zero(); }
  friend ComplexPolynomial operator+(const ComplexPolynomial& a, const ComplexPolynomial& b) {
    return {a.re + b.re, a.im + b.im};
  }
  friend ComplexPolynomial operator-(const ComplexPolynomial& a, const ComplexPolynomial& b) {
    return {a.re - b.re, a.im - b.im};
  }
  friend ComplexPolynomial operator*(const ComplexPolynomial& a, const ComplexPolynomial& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend bool operator==(const ComplexPolynomial&, const ComplexPolynomial&) = default;
};

[[nodiscard]] inline ComplexPolynomial conjugate(const ComplexPolynomial& a) {
  return {a.re, -a.im};
}

/// p(jω) as a polynomial in ω.
[[nodiscard]] ComplexPolynomial on_axis(const Polynomial& p);

/// q(X) with q(ω²) = p(ω). p must be even.
[[nodiscard]] Polynomial in_square(const Polynomial& p);

/// p(q(x)).
[[nodiscard]] Polynomial compose(const Polynomial& p, const Polynomial& q);

/// p(s) in double.
[[nodiscard]] std::complex<double> evaluate(const Polynomial& p, std::complex<double> s);

}  // namespace mbk::lti
