#include "mbk/model/impedance/passivity_index.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <numbers>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/rotation.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::impedance {
namespace {

Eigen::RowVectorXd no_gradient(const Model& model) {
  const Index n = model.axes();
  return Eigen::RowVectorXd::Zero(3 * n * n + n);
}

/// `which`-th eigenvalue of a symmetric part, from below.
Sensitive eigenvalue(const Model& model, int matrix, Index which) {
  const Index n = model.axes();
  const auto [values, vectors] = numeric::symmetric_eigen(symmetric_part(matrix_of(model, matrix)));
  const Vector v = vectors.col(which);
  Sensitive result{values[which], no_gradient(model)};
  result.gradient.segment(matrix * n * n, n * n) = Vector((v * v.transpose()).reshaped()).transpose();
  return result;
}

/// a(ω) = ω m_a − k_a/ω of two axes.
Sensitive antisymmetry(const Model& model, double omega) {
  Sensitive a{omega * antisymmetric_part(model.M) - antisymmetric_part(model.K) / omega, no_gradient(model)};
  a.gradient[1] = omega / 2.0;
  a.gradient[2] = -omega / 2.0;
  a.gradient[9] = -0.5 / omega;
  a.gradient[10] = 0.5 / omega;
  return a;
}

/// a(ω) = ω m_a − k_a/ω of three axes, and ∂a/∂(model), 3×(27 + 3).
struct Circulation {
  Eigen::Vector3d a;
  Eigen::Matrix<double, 3, Eigen::Dynamic> gradient;

  Circulation(const Model& model, double omega)
      : a(omega * antisymmetric_vector(model.M) - antisymmetric_vector(model.K) / omega),
        gradient(Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, no_gradient(model).size())) {
    constexpr Index kM = 0, kK = 18;
    const auto of_matrix = antisymmetric_vector_gradient();
    gradient.middleCols<9>(kM) = omega * of_matrix;
    gradient.middleCols<9>(kK) = -of_matrix / omega;
  }
};

constexpr Index kDampingInSpace = 9;  ///< of b_xx in the stacked model of three axes

/// The smallest eigenvalue of B_s + j [a]×.
Sensitive index_in_space(const Model& model, double omega) {
  const Circulation circulation(model, omega);
  Eigen::Matrix3cd H = symmetric_part(model.B).cast<std::complex<double>>();
  H.imag() = numeric::cross_matrix(circulation.a);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3cd> eigen(H);
  const Eigen::Vector3cd v = eigen.eigenvectors().col(0);
  Sensitive index{eigen.eigenvalues()[0], no_gradient(model)};
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) index.gradient[kDampingInSpace + 3 * i + j] = (std::conj(v[i]) * v[j]).real();
  }
  // vᴴ j [da]× v = 2 da · (Re v × Im v)
  const Eigen::Vector3d re = v.real(), im = v.imag();
  index.gradient -= 2.0 * im.cross(re).transpose() * circulation.gradient;
  return index;
}

/// √(det B_s/(uᵀ B_s u)) − |a|, a = |a| u.
Sensitive margin_in_space(const Model& model, double omega) {
  const Circulation circulation(model, omega);
  const Eigen::Matrix3d B = symmetric_part(model.B);
  const double determinant = B.determinant();
  if (!(determinant > 0.0)) return {kNaN, Eigen::RowVectorXd::Constant(no_gradient(model).size(), kNaN)};
  const double size = circulation.a.norm();
  const Eigen::Vector3d u = size > 0.0 ? Eigen::Vector3d(circulation.a / size)
                                       : Eigen::Vector3d(numeric::symmetric_eigen(Matrix(B)).vectors.col(2));
  const Eigen::Vector3d Bu = B * u;
  const double s = u.dot(Bu), root = std::sqrt(determinant / s);
  Sensitive margin{root - size, no_gradient(model)};
  const Eigen::Matrix3d by_damping = 0.5 * root * (Eigen::Matrix3d(B.inverse()) - u * u.transpose() / s);
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) margin.gradient[kDampingInSpace + 3 * i + j] = by_damping(i, j);
  }
  if (size > 0.0) {
    const Eigen::RowVector3d by_direction = -(root / (s * size)) * (Bu - s * u).transpose();
    margin.gradient += (by_direction - u.transpose()) * circulation.gradient;
  }
  return margin;
}

/// aᵀ B_s a = alpha ω² − 2 beta + gamma/ω².
struct CirculationPower {
  double alpha, beta, gamma, determinant;

  explicit CirculationPower(const Model& model) {
    const Eigen::Matrix3d B = symmetric_part(model.B);
    const Eigen::Vector3d m = antisymmetric_vector(model.M), k = antisymmetric_vector(model.K);
    alpha = m.dot(B * m);
    beta = m.dot(B * k);
    gamma = k.dot(B * k);
    determinant = B.determinant();
  }
};

bool is_damped(const Model& model) {
  return smallest_eigenvalue(model, 1).value > 0.0;
}

}  // namespace

double standard_error(const Sensitive& quantity, const Matrix& covariance) {
  const double variance = (quantity.gradient * covariance * quantity.gradient.transpose()).value();
  return variance < 0.0 ? 0.0 : std::sqrt(variance);
}

const Matrix& matrix_of(const Model& model, int matrix) {
  return matrix == 0 ? model.M : (matrix == 1 ? model.B : model.K);
}

Sensitive smallest_eigenvalue(const Model& model, int matrix) {
  return eigenvalue(model, matrix, 0);
}

Sensitive passivity_index(const Model& model, double omega) {
  if (model.axes() == 1) return eigenvalue(model, 1, 0);
  if (model.axes() == 3) return index_in_space(model, omega);
  const Sensitive a = antisymmetry(model, omega);
  const Matrix B = symmetric_part(model.B);
  const double half = (B(0, 0) - B(1, 1)) / 2.0, radius = std::hypot(half, B(0, 1), a.value);
  Sensitive index{B.trace() / 2.0 - radius, no_gradient(model)};
  index.gradient[4] = index.gradient[7] = 0.5;
  if (radius > 0.0) {  // at 0 it has a kink; the trace alone moves it then
    index.gradient -= a.gradient * (a.value / radius);
    index.gradient[4] -= 0.5 * half / radius;
    index.gradient[7] += 0.5 * half / radius;
    index.gradient[5] -= 0.5 * B(0, 1) / radius;
    index.gradient[6] -= 0.5 * B(0, 1) / radius;
  }
  return index;
}

Sensitive antisymmetry_margin(const Model& model, double omega, int sign) {
  if (model.axes() == 1) return eigenvalue(model, 1, 0);
  if (model.axes() == 3) return margin_in_space(model, omega);
  const Matrix B = symmetric_part(model.B);
  const double determinant = numeric::determinant(B);
  const Sensitive a = antisymmetry(model, omega);
  if (!(determinant > 0.0)) {
    return {kNaN, Eigen::RowVectorXd::Constant(a.gradient.size(), kNaN)};
  }
  const double root = std::sqrt(determinant);
  Sensitive margin{root - sign * a.value, -sign * a.gradient};
  margin.gradient[4] += 0.5 * B(1, 1) / root;
  margin.gradient[7] += 0.5 * B(0, 0) / root;
  margin.gradient[5] -= 0.5 * B(0, 1) / root;
  margin.gradient[6] -= 0.5 * B(0, 1) / root;
  return margin;
}

std::optional<double> nonpassive_below(const Model& model) {
  if (model.axes() == 1) return model.B(0, 0) > 0.0 ? std::optional(0.0) : std::nullopt;
  if (model.axes() == 3) {
    const CirculationPower power(model);
    if (!is_damped(model)) return std::nullopt;
    return std::sqrt(power.gamma / power.determinant) / (2.0 * std::numbers::pi);
  }
  const Matrix B = symmetric_part(model.B);
  const double determinant = numeric::determinant(B);
  if (!(determinant > 0.0 && B.trace() > 0.0)) return std::nullopt;
  return std::abs(antisymmetric_part(model.K)) / (2.0 * std::numbers::pi * std::sqrt(determinant));
}

std::optional<std::pair<double, double>> absorbing_in_circles(const Model& model) {
  if (model.axes() == 1) return std::nullopt;
  if (model.axes() == 3) {
    const CirculationPower power(model);
    const double middle = power.determinant + 2.0 * power.beta;
    const double discriminant = middle * middle - 4.0 * power.alpha * power.gamma;
    if (!(is_damped(model) && middle > 0.0 && discriminant > 0.0)) return std::nullopt;
    const double sum = middle + std::sqrt(discriminant);
    return std::pair{std::sqrt(2.0 * power.gamma / sum), std::sqrt(sum / (2.0 * power.alpha))};  // ∞ if m_a = 0
  }
  const Matrix B = symmetric_part(model.B);
  const double m_a = antisymmetric_part(model.M), k_a = antisymmetric_part(model.K);
  const double determinant = numeric::determinant(B), discriminant = determinant + 4.0 * m_a * k_a;
  if (!(determinant > 0.0 && B.trace() > 0.0 && discriminant > 0.0)) return std::nullopt;
  const double sum = std::sqrt(determinant) + std::sqrt(discriminant);
  const double high = m_a != 0.0 ? sum / (2.0 * std::abs(m_a)) : std::numeric_limits<double>::infinity();
  return std::pair{2.0 * std::abs(k_a) / sum, high};
}

std::optional<Sensitive> excess_of_passivity(const Model& model) {
  if (!(smallest_eigenvalue(model, 0).value >= 0.0 && smallest_eigenvalue(model, 2).value >= 0.0)) return std::nullopt;
  return smallest_eigenvalue(model, 1);
}

Sensitive published_excess_of_passivity(const Model& model) {
  Sensitive excess = eigenvalue(model, 1, model.axes() - 1);
  excess.value /= 2.0;
  excess.gradient /= 2.0;
  return excess;
}

}  // namespace mbk::impedance
