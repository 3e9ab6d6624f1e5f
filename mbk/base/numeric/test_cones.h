#pragma once

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

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

using Real = long double;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// L of L Lᵀ = A; absent where A is not positive definite.
inline std::optional<RealMatrix> lower_factor(RealMatrix A) {
  for (Index j = 0; j < A.rows(); ++j) {
    const Index below = A.rows() - j;
    for (Index k = 0; k < j; ++k) A.col(j).tail(below) -= A(j, k) * A.col(k).tail(below);
    if (!(A(j, j) > 0)) return std::nullopt;
    A.col(j).tail(below) /= std::sqrt(A(j, j));
    A.col(j).head(j).setZero();
  }
  return A;
}

/// X of L Lᵀ X = B.
inline RealMatrix solved(const RealMatrix& L, RealMatrix B) {
  const Index n = L.rows();
  const Real* const l = L.data();  // plain loops, for tests are optimised little
  for (Index column = 0; column < B.cols(); ++column) {
    Real* const x = B.data() + column * n;
    for (Index i = 0; i < n; ++i) {
      for (Index k = 0; k < i; ++k) x[i] -= l[i + k * n] * x[k];
      x[i] /= l[i + i * n];
    }
    for (Index i = n; i-- > 0;) {
      for (Index k = i + 1; k < n; ++k) x[i] -= l[k + i * n] * x[k];
      x[i] /= l[i + i * n];
    }
  }
  return B;
}

/// Adds a multiple of `count` numbers.
inline void add_times(Real factor, const Real* numbers, Index count, Real* to) {
  for (Index i = 0; i < count; ++i) to[i] += factor * numbers[i];
}

/// A x
inline RealVector product_of(const RealMatrix& A, const RealVector& x) {
  RealVector product = RealVector::Zero(A.rows());
  for (Index j = 0; j < A.cols(); ++j) add_times(x[j], A.data() + j * A.rows(), A.rows(), product.data());
  return product;
}

/// tr(A B) of which Aᵀ is given.
inline Real trace_of_product(const RealMatrix& A_transposed, const RealMatrix& B) {
  Real sum = 0;
  const Real *const a = A_transposed.data(), *const b = B.data();
  for (Index i = 0; i < B.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The slow plain twin, which shares nothing with the solver but the statement: the barrier method
///   minimise ½ xᵀP x + qᵀx − μ Σ log det S_k(x),   μ → 0,
/// in 64-bit mantissas, from a point strictly inside. The minimum lies at most μ Σ n_k lower.
inline Vector minimum_by_barrier(const ConeProgram& program, const Vector& inside) {
  const Index v = inside.size();
  const RealMatrix P = program.P.cast<Real>();
  const RealVector q = program.q.cast<Real>();
  std::vector<std::vector<RealMatrix>> parts;  // of each cone: S = parts[0] + Σ x_i parts[i + 1]
  for (const SemidefiniteCone& cone : program.cones) {
    const auto n = std::llround(std::sqrt(static_cast<double>(cone.b.size())));
    std::vector<RealMatrix> part;
    const auto add = [&](const Vector& column) {
      const RealMatrix S = Matrix(column.reshaped(n, n)).cast<Real>();
      part.push_back(Real(0.5) * (S + S.transpose()));
    };
    add(cone.b);
    for (Index i = 0; i < v; ++i) add(cone.A.col(i));
    parts.push_back(part);
  }
  RealVector x = inside.cast<Real>();
  const auto at = [&](const std::vector<RealMatrix>& part, const RealVector& y) {
    RealMatrix S = part[0];
    for (Index i = 0; i < v; ++i) add_times(y[i], part[static_cast<std::size_t>(i) + 1].data(), S.size(), S.data());
    return S;
  };
  const auto barrier = [&](const RealVector& y, Real mu, bool& allowed) {
    Real value = Real(0.5) * y.dot(product_of(P, y)) + q.dot(y);
    allowed = true;
    for (const auto& part : parts) {
      const std::optional<RealMatrix> L = lower_factor(at(part, y));
      if (!L) {
        allowed = false;
        return value;
      }
      for (const Real pivot : L->diagonal()) value -= 2 * mu * std::log(pivot);
    }
    return value;
  };
  for (Real mu = 10; mu > Real(1e-15); mu *= Real(0.4)) {
    for (int step = 0; step < 100; ++step) {
      RealVector gradient = product_of(P, x) + q;
      RealMatrix hessian = P;
      for (const auto& part : parts) {
        const RealMatrix L = lower_factor(at(part, x)).value();
        std::vector<RealMatrix> SA;
        for (Index i = 0; i < v; ++i) SA.push_back(solved(L, part[static_cast<std::size_t>(i) + 1]));
        for (Index i = 0; i < v; ++i) {
          const RealMatrix& a = SA[static_cast<std::size_t>(i)];
          gradient[i] -= mu * a.trace();
          const RealMatrix transposed = a.transpose();
          for (Index j = 0; j <= i; ++j) {
            const Real second = mu * trace_of_product(transposed, SA[static_cast<std::size_t>(j)]);
            hessian(i, j) += second;
            if (j < i) hessian(j, i) += second;
          }
        }
      }
      const RealVector direction = -solved(lower_factor(hessian).value(), gradient);
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
