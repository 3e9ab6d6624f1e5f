#include "mbk/base/numeric/polynomial_roots.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Eigen::VectorXcd polynomial_roots(const Vector& ascending) {
  Index degree = ascending.size() - 1;
  while (degree > 0 && ascending[degree] == 0.0) --degree;
  if (degree <= 0) return {};
  Index zeros = 0;  // roots at 0
  while (zeros < degree && ascending[zeros] == 0.0) ++zeros;
  const Index n = degree - zeros;
  Eigen::VectorXcd roots = Eigen::VectorXcd::Zero(degree);
  if (n > 0) {
    const double leading = ascending[degree];
    const double scale = std::exp(std::log(std::abs(ascending[zeros] / leading)) / static_cast<double>(n));
    Matrix companion = Matrix::Zero(n, n);
    companion.diagonal(1).setOnes();
    for (Index k = 0; k < n; ++k) {
      companion(n - 1, k) = -ascending[zeros + k] / leading / std::pow(scale, static_cast<double>(n - k));
    }
    roots.tail(n) = scale * eigenvalues(companion);
  }
  // Rounding does not part a pair: its moduli are equal to the last digit.
  std::sort(roots.begin(), roots.end(), [](const std::complex<double>& a, const std::complex<double>& b) {
    return std::tuple(std::abs(a), a.real(), -a.imag()) < std::tuple(std::abs(b), b.real(), -b.imag());
  });
  return roots;
}

Vector monic_from_roots(const Eigen::VectorXcd& roots) {
  Eigen::VectorXcd c = Eigen::VectorXcd::Zero(roots.size() + 1);
  c[0] = 1.0;
  for (Index k = 0; k < roots.size(); ++k) {
    for (Index i = k + 1; i > 0; --i) c[i] = c[i - 1] - roots[k] * c[i];
    c[0] *= -roots[k];
  }
  return c.head(roots.size()).real();
}

std::complex<double> polynomial_at(const Vector& ascending, std::complex<double> x) {
  std::complex<double> value = 0.0;
  for (Index k = ascending.size(); k-- > 0;) value = value * x + ascending[k];
  return value;
}

}  // namespace mbk::numeric
