#include "mbk/base/lti/half_planes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/lti/integer_polynomial.h"
#include "mbk/base/lti/on_axis.h"
#include "mbk/base/lti/real_roots.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::lti {
namespace {

/// Jumps of b/a from −∞ to ∞ less those from ∞ to −∞, over the whole line: the variations of sign that a sequence of
/// signed remainders loses from −∞ to ∞.
int cauchy_index(const Polynomial& a, const Polynomial& b) {
  int lost = 0, left = 0, right = 0;
  for (const IntegerPolynomial& p : signed_remainders(a, b)) {
    const int at_plus = p.back().sign();
    const int at_minus = p.size() % 2 == 0 ? -at_plus : at_plus;
    if (left * at_minus < 0) ++lost;
    if (right * at_plus < 0) --lost;
    left = at_minus;
    right = at_plus;
  }
  return lost;
}

/// The power of two near the geometric mean of the roots of a monic polynomial; 1 where a root is zero.
Rational typical_root(const Polynomial& p) {
  const Rational product = abs(p.coefficient(0));
  if (product.is_zero()) return 1;
  const int digits =
      static_cast<int>(msb(Integer(numerator(product)))) - static_cast<int>(msb(Integer(denominator(product))));
  const int exponent = digits / p.degree();
  const Integer power = Integer(1) << static_cast<unsigned>(std::abs(exponent));
  return exponent < 0 ? Rational(Integer(1), power) : Rational(power);
}

}  // namespace

HalfPlaneCount count_half_planes(const Polynomial& p) {
  const Polynomial once = square_free(p);
  if (once.degree() == 0) return {};
  const ComplexPolynomial parts = on_axis(once);
  const bool odd = once.degree() % 2 != 0;
  const int difference = odd ? cauchy_index(parts.im, parts.re) : -cauchy_index(parts.re, parts.im);
  HalfPlaneCount count;
  count.axis = distinct_roots(gcd(parts.re, parts.im));
  count.left = (once.degree() - count.axis + difference) / 2;
  count.right = once.degree() - count.axis - count.left;
  return count;
}

Polynomial axis_roots(const Polynomial& p) {
  const ComplexPolynomial parts = on_axis(p);
  return gcd(parts.re, parts.im);
}

std::vector<std::complex<double>> complex_roots(const Polynomial& p) {
  const Polynomial once = square_free(p);
  const Index n = once.degree();
  if (n == 0) return {};
  // s = scale·z makes the roots about 1 large; scale is a power of two
  const Rational scale = typical_root(once);
  const Polynomial scaled = monic(compose(once, Polynomial{0, scale}));
  Matrix companion = Matrix::Zero(n, n);
  companion.diagonal(-1).setOnes();
  for (Index i = 0; i < n; ++i) companion(i, n - 1) = -to_double(scaled.coefficient(static_cast<int>(i)));
  if (!companion.allFinite()) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    return std::vector<std::complex<double>>(static_cast<std::size_t>(n), {none, none});
  }
  std::vector<std::complex<double>> roots;
  const Polynomial slope = scaled.derivative();
  for (std::complex<double> z : numeric::eigenvalues(companion)) {
    for (int step = 0; step < 3; ++step) {
      const std::complex<double> move = evaluate(scaled, z) / evaluate(slope, z);
      if (std::isfinite(std::abs(move)) && std::abs(move) < 1e-3 * std::abs(z)) z -= move;
    }
    roots.push_back(to_double(scale) * z);
  }
  std::sort(roots.begin(), roots.end(), [](const auto& a, const auto& b) {
    return std::pair(-a.real(), a.imag()) < std::pair(-b.real(), b.imag());
  });
  return roots;
}

}  // namespace mbk::lti
