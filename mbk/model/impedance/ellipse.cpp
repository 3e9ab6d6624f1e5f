#include "mbk/model/impedance/ellipse.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace mbk::impedance {

Matrix symmetric_part(const Matrix& Z) {
  return 0.5 * (Z + Z.transpose());
}

double antisymmetric_part(const Matrix& Z) {
  return 0.5 * (Z(0, 1) - Z(1, 0));
}

Eigen::Vector3d antisymmetric_vector(const Matrix& Z) {
  return 0.5 * Eigen::Vector3d(Z(2, 1) - Z(1, 2), Z(0, 2) - Z(2, 0), Z(1, 0) - Z(0, 1));
}

Eigen::Matrix<double, 3, 9> antisymmetric_vector_gradient() {
  Eigen::Matrix<double, 3, 9> gradient = Eigen::Matrix<double, 3, 9>::Zero();
  for (Index k = 0; k < 3; ++k) {
    const Index i = (k + 1) % 3, j = (k + 2) % 3;  // (z_ji − z_ij)/2
    gradient(k, 3 * j + i) = 0.5;
    gradient(k, 3 * i + j) = -0.5;
  }
  return gradient;
}

double antisymmetry_percent(const Matrix& Z) {
  const Ellipse e = ellipse(Z);
  if (!(e.lambda_min > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * std::abs(antisymmetric_part(Z)) / std::sqrt(e.lambda_max * e.lambda_min);
}

Ellipse ellipse(const Matrix& Z) {
  const double zs = 0.5 * (Z(0, 1) + Z(1, 0));
  const double mean = 0.5 * (Z(0, 0) + Z(1, 1));
  const double radius = std::hypot(0.5 * (Z(0, 0) - Z(1, 1)), zs);
  Ellipse e;
  e.lambda_max = mean + radius;
  e.lambda_min = mean - radius;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  e.area = e.lambda_min > 0.0 ? std::numbers::pi * e.lambda_max * e.lambda_min : nan;
  e.shape = e.lambda_min > 0.0 ? e.lambda_max / e.lambda_min : nan;
  e.orientation = 0.5 * std::atan2(2.0 * zs, Z(0, 0) - Z(1, 1));
  if (e.orientation < 0.0) e.orientation += std::numbers::pi;
  if (e.orientation >= std::numbers::pi) e.orientation = 0.0;  // a tiny negative angle rounds to π
  return e;
}

EllipseGradient ellipse_gradient(const Matrix& Z) {
  const Ellipse e = ellipse(Z);
  const double c = std::cos(e.orientation), s = std::sin(e.orientation);
  const double zs = 0.5 * (Z(0, 1) + Z(1, 0)), difference = Z(0, 0) - Z(1, 1);
  EllipseGradient g;
  g.lambda_max << c * c, c * s, c * s, s * s;
  g.lambda_min << s * s, -c * s, -c * s, c * c;
  g.area = std::numbers::pi * (e.lambda_max * g.lambda_min + e.lambda_min * g.lambda_max);
  g.shape = (g.lambda_max - e.shape * g.lambda_min) / e.lambda_min;
  g.orientation << -zs, 0.5 * difference, 0.5 * difference, zs;
  g.orientation /= difference * difference + 4.0 * zs * zs;
  return g;
}

}  // namespace mbk::impedance
