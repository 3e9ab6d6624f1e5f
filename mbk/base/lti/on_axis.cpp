#include "mbk/base/lti/on_axis.h"

#include <cassert>
#include <utility>
#include <vector>

namespace mbk::lti {

ComplexPolynomial on_axis(const Polynomial& p) {
  // j⁰, j¹, j², j³: + to the real part, + to the imaginary, − to the real, − to the imaginary
  std::vector<Rational> re(p.coefficients().size()), im(p.coefficients().size());
  for (std::size_t i = 0; i < re.size(); ++i) {
    (i % 2 == 0 ? re : im)[i] = i % 4 < 2 ? p.coefficients()[i] : -p.coefficients()[i];
  }
  return {Polynomial(std::move(re)), Polynomial(std::move(im))};
}

Polynomial in_square(const Polynomial& p) {
  std::vector<Rational> even;
  for (std::size_t i = 0; i < p.coefficients().size(); ++i) {
    assert(i % 2 == 0 || p.coefficients()[i].is_zero());
    if (i % 2 == 0) even.push_back(p.coefficients()[i]);
  }
  return Polynomial(std::move(even));
}

Polynomial compose(const Polynomial& p, const Polynomial& q) {
  Polynomial result;
  for (int i = p.degree(); i >= 0; --i) result = result * q + Polynomial{p.coefficient(i)};
  return result;
}

std::complex<double> evaluate(const Polynomial& p, std::complex<double> s) {
  std::complex<double> value = 0.0;
  for (int i = p.degree(); i >= 0; --i) value = value * s + to_double(p.coefficient(i));
  return value;
}

}  // namespace mbk::lti
