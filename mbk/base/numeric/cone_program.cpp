#include "mbk/base/numeric/cone_program.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {
namespace {

constexpr double kHalfRoot = std::numbers::sqrt2 / 2.0;  // √½

// Symmetric matrices are columns of n(n+1)/2 numbers, those off the diagonal times √2, so that the inner product of two
// columns is that of the matrices.
constexpr Index packed_size(Index n) {
  return n * (n + 1) / 2;
}

/// The symmetric part of a matrix given column by column, packed: P with P vec X = pack(sym X).
Matrix packing(Index n) {
  Matrix map = Matrix::Zero(packed_size(n), n * n);
  Index row = 0;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) {
      if (i == j) {
        map(row, i * n + i) = 1.0;
      } else {
        map(row, i * n + j) = map(row, j * n + i) = kHalfRoot;
      }
    }
  }
  return map;
}

Matrix unpacked(const Eigen::Ref<const Vector>& packed, Index n) {
  Matrix X(n, n);
  Index row = 0;
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) X(i, j) = X(j, i) = i == j ? packed[row] : kHalfRoot * packed[row];
  }
  return X;
}

Vector packed(const Matrix& X) {
  Vector column(packed_size(X.rows()));
  Index row = 0;
  for (Index j = 0; j < X.cols(); ++j) {
    for (Index i = 0; i <= j; ++i, ++row) column[row] = i == j ? X(i, j) : std::numbers::sqrt2 * X(i, j);
  }
  return column;
}

double largest(const Vector& values) {
  return values.size() == 0 ? 0.0 : values.lpNorm<Eigen::Infinity>();
}

/// minimise ½ xᵀP x + qᵀx  subject to  A x + b = s, every part of s semidefinite; x in units in which P has a unit
/// diagonal, each cone in units in which it is about as wide as the minimum is uncertain, all numbers about 1.
struct Scaled {
  Matrix P, A;
  Vector q, b;
  std::vector<Index> size;  ///< n of each cone
  Vector x_unit;            ///< x = x_unit ∘ x_scaled · number_unit
  Vector cone_unit;         ///< of each cone, likewise
  double number_unit = 1;

  [[nodiscard]] Index rows() const { return b.size(); }
  template <class Function>
  void for_each_cone(Function&& function) const {
    Index row = 0;
    for (std::size_t k = 0; k < size.size(); ++k) {
      function(k, row, size[k]);
      row += packed_size(size[k]);
    }
  }
};

Index side_of(const SemidefiniteCone& cone) {
  return std::llround(std::sqrt(static_cast<double>(cone.b.size())));
}

bool well_formed(const ConeProgram& program) {
  const Index v = program.q.size();
  if (v == 0 || program.P.rows() != v || program.P.cols() != v || program.cones.empty()) return false;
  if (!program.P.allFinite() || !program.q.allFinite()) return false;
  return std::ranges::all_of(program.cones, [v](const SemidefiniteCone& cone) {
    const Index n = side_of(cone);
    return n > 0 && n * n == cone.b.size() && cone.A.rows() == n * n && cone.A.cols() == v && cone.A.allFinite() &&
           cone.b.allFinite();
  });
}

/// Nothing where P + AᵀA is singular.
std::optional<Scaled> scaled(const ConeProgram& program) {
  const Index v = program.q.size();
  Scaled s;
  Index rows = 0;
  for (const SemidefiniteCone& cone : program.cones) {
    s.size.push_back(side_of(cone));
    rows += packed_size(s.size.back());
  }
  s.A.resize(rows, v);
  s.b.resize(rows);
  s.for_each_cone([&](std::size_t k, Index row, Index n) {
    const Matrix pack = packing(n);
    s.A.middleRows(row, pack.rows()) = pack * program.cones[k].A;
    s.b.segment(row, pack.rows()) = pack * program.cones[k].b;
  });
  s.x_unit.resize(v);
  for (Index j = 0; j < v; ++j) {
    const double curvature = program.P(j, j), length = s.A.col(j).norm();
    s.x_unit[j] = curvature > 0.0 ? 1.0 / std::sqrt(curvature) : length > 0.0 ? 1.0 / length : 1.0;
  }
  s.P = s.x_unit.asDiagonal() * program.P * s.x_unit.asDiagonal();
  s.P = (0.5 * (s.P + s.P.transpose())).eval();
  s.q = s.x_unit.cwiseProduct(program.q);
  s.A = s.A * s.x_unit.asDiagonal();
  s.cone_unit.resize(static_cast<Index>(s.size.size()));
  const auto rescale = [&](auto&& unit_of) {
    s.for_each_cone([&](std::size_t k, Index row, Index n) {
      auto A = s.A.middleRows(row, packed_size(n));
      const double length = unit_of(A), unit = length > 0.0 ? length : 1.0;
      A /= unit;
      s.b.segment(row, packed_size(n)) /= unit;
      s.cone_unit[static_cast<Index>(k)] *= unit;
    });
  };
  s.cone_unit.setOnes();
  rescale([](const auto& A) { return A.norm(); });
  const PivotedCholesky curvature(s.P + s.A.transpose() * s.A);
  constexpr double kSeen = 1e-14;
  const Vector pivots = curvature.pivots();
  if (!curvature.positive() || !(pivots.minCoeff() > kSeen * pivots.maxCoeff())) return std::nullopt;
  rescale([&](const auto& A) {
    return std::sqrt(A.cwiseProduct(curvature.solve(A.transpose()).transpose()).sum() / static_cast<double>(A.rows()));
  });
  const double number = std::max(largest(s.q), largest(s.b));
  s.number_unit = number > 0.0 ? number : 1.0;
  s.q /= s.number_unit;
  s.b /= s.number_unit;
  return s;
}

/// Π(z) and, where it is asked for, its derivative D: Π(z + h) ≈ Π(z) + D h.
Vector clipped(const Scaled& program, const Vector& z, Matrix* derivative = nullptr) {
  Vector positive(z.size());
  if (derivative) derivative->setZero(z.size(), z.size());
  program.for_each_cone([&](std::size_t, Index row, Index n) {
    const Index m = packed_size(n);
    const auto [lambda, V] = symmetric_eigen(unpacked(z.segment(row, m), n));
    positive.segment(row, m) = packed(V * lambda.cwiseMax(0.0).asDiagonal() * V.transpose());
    if (!derivative) return;
    Matrix share(n, n);  // divided differences of max(λ, 0)
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const double a = std::max(lambda[i], 0.0), b = std::max(lambda[j], 0.0);
        const bool same_side = (lambda[i] > 0.0) == (lambda[j] > 0.0);
        share(i, j) = same_side ? (lambda[i] > 0.0 ? 1.0 : 0.0) : (a - b) / (lambda[i] - lambda[j]);
      }
    }
    for (Index k = 0; k < m; ++k) {
      const Matrix H = V.transpose() * unpacked(Vector::Unit(m, k), n) * V;
      derivative->block(row, row + k, m, 1) = packed(V * share.cwiseProduct(H) * V.transpose());
    }
  });
  return positive;
}

/// x and z; S = Π(z), Y = weight · (Π(z) − z).
struct Point {
  Vector x, z;
  double weight = 1;
};

/// How far the two equations are from being met, one under the other.
Vector error_of(const Scaled& p, const Point& at, const Vector& positive) {
  Vector error(p.q.size() + p.rows());
  error << p.P * at.x + p.q - at.weight * (p.A.transpose() * (positive - at.z)), p.A * at.x + p.b - positive;
  return error;
}

/// Newton's method with the derivative of Π, for as long as it gets nearer.
int polish(const Scaled& p, Point& at) {
  constexpr int kMaxSteps = 30, kMaxHalvings = 6;
  const Index v = p.q.size(), m = p.rows();
  Matrix D, J(v + m, v + m);
  Vector positive = clipped(p, at.z, &D);
  Vector error = error_of(p, at, positive);
  int steps = 0;
  for (; steps < kMaxSteps && error.norm() > 0.0; ++steps) {
    J << p.P, -at.weight * (p.A.transpose() * (D - Matrix::Identity(m, m))), p.A, -D;
    const Vector step = CompleteOrthogonal(J).solve(-error);
    bool nearer = false;
    double length = 1.0;
    for (int halving = 0; halving < kMaxHalvings && !nearer; ++halving, length *= 0.5) {
      const Point next{at.x + length * step.head(v), at.z + length * step.tail(m), at.weight};
      if (!next.x.allFinite() || !next.z.allFinite()) return steps;
      positive = clipped(p, next.z);
      const Vector next_error = error_of(p, next, positive);
      if (next_error.norm() < 0.9 * error.norm()) {
        at = next;
        error = next_error;
        nearer = true;
      }
    }
    if (!nearer) return steps;
    (void)clipped(p, at.z, &D);
  }
  return steps;
}

ConeSolution solution_of(const ConeProgram& program, const Scaled& p, const Point& at) {
  const Vector S = clipped(p, at.z), Y = at.weight * (S - at.z);
  const Vector Px = p.P * at.x, pull = p.A.transpose() * Y;
  ConeSolution found;
  const double size = std::max({1.0, largest(at.x), largest(S), largest(Y)});
  found.primal_residual = largest(p.A * at.x + p.b - S) / size;
  found.dual_residual = largest(Px + p.q - pull) / size;
  const double half = 0.5 * at.x.dot(Px), primal = half + p.q.dot(at.x), dual = -half - p.b.dot(Y);
  found.gap = std::abs(primal - dual) / (1.0 + std::abs(primal) + std::abs(dual));
  found.x = p.number_unit * p.x_unit.cwiseProduct(at.x);
  found.value = 0.5 * found.x.dot(program.P * found.x) + program.q.dot(found.x);
  found.dual_value = dual * p.number_unit * p.number_unit;
  p.for_each_cone([&](std::size_t k, Index row, Index n) {
    const double unit = p.cone_unit[static_cast<Index>(k)];
    found.slack.push_back(p.number_unit * unit * unpacked(S.segment(row, packed_size(n)), n));
    found.multiplier.push_back(p.number_unit / unit * unpacked(Y.segment(row, packed_size(n)), n));
  });
  return found;
}

}  // namespace

Result<ConeSolution> solve_cone_program(const ConeProgram& program) {
  constexpr int kMaxIterations = 20000, kBetweenPolishes = 25;
  constexpr double kMet = 1e-10, kRelaxation = 1.6, kUnbalanced = 5.0;
  if (!well_formed(program)) return bad_usage("a cone program has inconsistent sizes or a non-finite number");
  const std::optional<Scaled> p = scaled(program);
  if (!p) return bad_usage("a cone program has a direction that neither its objective nor a cone depends on");

  Point at{Vector::Zero(p->q.size()), p->b, 1.0};
  const auto factored = [&] { return Cholesky(p->P + at.weight * (p->A.transpose() * p->A)); };
  Cholesky factor = factored();
  Vector s = clipped(*p, at.z), u = at.z - s;
  int wait = kBetweenPolishes;
  for (int iteration = 1; iteration <= kMaxIterations; ++iteration) {
    at.x = factor.solve(-p->q + at.weight * (p->A.transpose() * (s - p->b - u)));
    const Vector affine = p->A * at.x + p->b, previous = s;
    at.z = kRelaxation * affine + (1.0 - kRelaxation) * s + u;
    s = clipped(*p, at.z);
    u = at.z - s;
    if (iteration % kBetweenPolishes != 0) continue;
    if (iteration >= wait) {
      Point polished = at;
      const int steps = polish(*p, polished);
      ConeSolution found = solution_of(program, *p, polished);
      if (std::max({found.primal_residual, found.dual_residual, found.gap}) <= kMet) {
        found.iterations = iteration;
        found.newton_steps = steps;
        return found;
      }
      wait = 2 * iteration;
    }
    // Both kinds of error should fall alike; the weight says which the steps look at.
    const double primal = (affine - s).norm(), dual = at.weight * (p->A.transpose() * (s - previous)).norm();
    const double ratio = std::sqrt(primal / std::max(dual, 1e-300));
    if (ratio > kUnbalanced || ratio < 1.0 / kUnbalanced) {
      const double change = std::clamp(ratio, 0.1, 10.0);
      at.weight *= change;
      u /= change;
      factor = factored();
    }
  }
  return fail(ErrorKind::not_usable, "no point was found that satisfies every condition of a cone program");
}

}  // namespace mbk::numeric
