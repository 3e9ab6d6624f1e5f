#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <utility>

#include "mbk/base/numeric/cone_program.h"
#include "mbk/base/numeric/random.h"

namespace mbk::numeric::testing_support {

inline Matrix random_matrix(Random& random, Index rows, Index columns) {
  Matrix matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = random.normal();
  return matrix;
}

/// Strongly convex; x = 0 is strictly inside every cone, the free minimum is outside most of them.
inline ConeProgram random_cone_program(Random& random, Index variables, const std::vector<Index>& sizes) {
  const Matrix root = random_matrix(random, variables, variables);
  ConeProgram program;
  program.P = root.transpose() * root + 0.1 * Matrix::Identity(variables, variables);
  program.q = 4.0 * random_matrix(random, variables, 1);
  for (const Index n : sizes) {
    const Matrix inner = random_matrix(random, n, n);
    const Matrix b = inner * inner.transpose() + 0.1 * Matrix::Identity(n, n);
    program.cones.push_back({random_matrix(random, n * n, variables), b.reshaped()});
  }
  return program;
}

inline Matrix symmetric_matrix(const SemidefiniteCone& cone, const Vector& x) {
  const auto n = std::llround(std::sqrt(static_cast<double>(cone.b.size())));
  const Matrix S = (cone.A * x + cone.b).reshaped(n, n);
  return 0.5 * (S + S.transpose());
}

/// The slow plain twin, which shares nothing with the solver but the statement: the barrier method
///   minimise ½ xᵀP x + qᵀx − μ Σ log det S_k(x),   μ → 0,
/// in 64-bit mantissas, from a point strictly inside. The minimum lies at most μ Σ n_k lower.
inline Vector minimum_by_barrier(const ConeProgram& program, const Vector& inside) {
  using Real = long double;
  using Matrix_ = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector_ = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const Index v = inside.size();
  const Matrix_ P = program.P.cast<Real>();
  const Vector_ q = program.q.cast<Real>();
  std::vector<std::vector<Matrix_>> parts;  // of each cone: S = parts[0] + Σ x_i parts[i + 1]
  for (const SemidefiniteCone& cone : program.cones) {
    const auto n = std::llround(std::sqrt(static_cast<double>(cone.b.size())));
    std::vector<Matrix_> part;
    const auto add = [&](const Vector& column) {
      const Matrix_ S = Matrix(column.reshaped(n, n)).cast<Real>();
      part.push_back(Real(0.5) * (S + S.transpose()));
    };
    add(cone.b);
    for (Index i = 0; i < v; ++i) add(cone.A.col(i));
    parts.push_back(part);
  }
  Vector_ x = inside.cast<Real>();
  const auto at = [&](const std::vector<Matrix_>& part, const Vector_& y) {
    Matrix_ S = part[0];
    for (Index i = 0; i < v; ++i) S += y[i] * part[static_cast<std::size_t>(i) + 1];
    return S;
  };
  const auto barrier = [&](const Vector_& y, Real mu, bool& allowed) {
    Real value = Real(0.5) * y.dot(P * y) + q.dot(y);
    allowed = true;
    for (const auto& part : parts) {
      const Eigen::LLT<Matrix_> factor(at(part, y));
      if (factor.info() != Eigen::Success) {
        allowed = false;
        return value;
      }
      const Matrix_ L = factor.matrixL();
      value -= 2 * mu * L.diagonal().array().log().sum();
    }
    return value;
  };
  for (Real mu = 10; mu > Real(1e-15); mu *= Real(0.4)) {
    for (int step = 0; step < 100; ++step) {
      Vector_ gradient = P * x + q;
      Matrix_ hessian = P;
      for (const auto& part : parts) {
        const Matrix_ inverse = at(part, x).inverse();
        std::vector<Matrix_> SA;
        for (Index i = 0; i < v; ++i) SA.push_back(inverse * part[static_cast<std::size_t>(i) + 1]);
        for (Index i = 0; i < v; ++i) {
          const auto& a = SA[static_cast<std::size_t>(i)];
          gradient[i] -= mu * a.trace();
          for (Index j = 0; j < v; ++j) {
            hessian(i, j) += mu * (a.transpose().cwiseProduct(SA[static_cast<std::size_t>(j)])).sum();
          }
        }
      }
      const Vector_ direction = -hessian.ldlt().solve(gradient);
      const Real decrement = -gradient.dot(direction);
      if (decrement < Real(1e-8) * mu) break;
      bool allowed = false;
      const Real now = barrier(x, mu, allowed);
      Real length = 1;
      for (int halving = 0; halving < 60; ++halving, length *= Real(0.5)) {
        const Real next = barrier(x + length * direction, mu, allowed);
        if (allowed && next <= now) break;
      }
      x += length * direction;
    }
  }
  return x.cast<double>();
}

}  // namespace mbk::numeric::testing_support
