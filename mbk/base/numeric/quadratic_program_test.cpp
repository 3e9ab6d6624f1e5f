#include "mbk/base/numeric/quadratic_program.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"

namespace mbk::numeric {
namespace {

constexpr double kMet = 1e-8;  // the solver meets each condition to 1e-10 of numbers near 10

Matrix random_matrix(Random& random, Index rows, Index columns) {
  Matrix matrix(rows, columns);
  for (double& value : matrix.reshaped()) value = random.normal();
  return matrix;
}

/// A program whose point z = 0 is strictly inside G z ≤ h and on C z = b + 0.
QuadraticProgram random_program(Random& random, Index n, Index p, Index m, Index rank) {
  const Matrix root = random_matrix(random, rank, n);
  QuadraticProgram program{root.transpose() * root, random_matrix(random, n, 1), random_matrix(random, p, n),
                           Vector::Zero(p),         random_matrix(random, m, n), Vector(m)};
  for (double& value : program.h) value = random.uniform(0.1, 1.0);
  // a box keeps the minimum finite where H is flat
  program.G.conservativeResize(m + 2 * n, n);
  program.h.conservativeResize(m + 2 * n);
  program.G.middleRows(m, n).setIdentity();
  program.G.bottomRows(n) = -Matrix::Identity(n, n);
  program.h.tail(2 * n).setConstant(2.0);
  return program;
}

/// The slow way: every set of active inequalities, each a linear system; the lowest point that is allowed.
double lowest_by_active_sets(const QuadraticProgram& q) {
  const Index n = q.g.size(), p = q.b.size(), m = q.h.size();
  double best = std::numeric_limits<double>::infinity();
  for (unsigned set = 0; set < (1u << static_cast<unsigned>(m)); ++set) {
    std::vector<Index> active;
    for (Index i = 0; i < m; ++i) {
      if ((set >> static_cast<unsigned>(i)) & 1u) active.push_back(i);
    }
    const auto a = static_cast<Index>(active.size());
    if (a + p > n) continue;
    Matrix kkt = Matrix::Zero(n + p + a, n + p + a);
    Vector right(n + p + a);
    kkt.topLeftCorner(n, n) = q.H;
    kkt.block(0, n, n, p) = q.C.transpose();
    kkt.block(n, 0, p, n) = q.C;
    right << -q.g, q.b, Vector::Zero(a);
    for (Index i = 0; i < a; ++i) {
      kkt.block(0, n + p + i, n, 1) = q.G.row(active[static_cast<std::size_t>(i)]).transpose();
      kkt.block(n + p + i, 0, 1, n) = q.G.row(active[static_cast<std::size_t>(i)]);
      right[n + p + i] = q.h[active[static_cast<std::size_t>(i)]];
    }
    const Vector z = CompleteOrthogonal(kkt).solve(right).head(n);
    const bool allowed = (q.G * z - q.h).maxCoeff() < 1e-9 && (q.C * z - q.b).norm() < 1e-9;
    if (allowed) best = std::min(best, 0.5 * z.dot(q.H * z) + q.g.dot(z));
  }
  return best;
}

TEST(QuadraticProgram, HasTheClosedFormOfAProjectionOntoABox) {
  const QuadraticProgram program{
      Matrix::Identity(2, 2), Vector{{-3.0, 0.5}}, Matrix(0, 2), Vector(0), Matrix{{1, 0}, {0, 1}, {-1, 0}, {0, -1}},
      Vector{{1, 1, 1, 1}}};
  const auto solution = solve_quadratic_program(program);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->z - Vector{{1.0, -0.5}}).norm(), kMet);
  EXPECT_NEAR(solution->lambda[0], 2.0, kMet);
  EXPECT_NEAR(solution->value, -2.5 - 0.125, kMet);
}

TEST(QuadraticProgram, MeetsTheConditionsOfKarushKuhnAndTucker) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const QuadraticProgram q = random_program(random, 10, 3, 8, trial % 2 == 0 ? 10 : 4);
    const auto s = solve_quadratic_program(q);
    ASSERT_TRUE(s) << trial;
    EXPECT_LT((q.H * s->z + q.g + q.C.transpose() * s->y + q.G.transpose() * s->lambda).norm(), kMet) << trial;
    EXPECT_LT((q.C * s->z - q.b).norm(), kMet) << trial;
    const Vector room = q.h - q.G * s->z;
    EXPECT_GT(room.minCoeff(), -kMet) << trial;
    EXPECT_GE(s->lambda.minCoeff(), 0.0) << trial;
    EXPECT_LT(room.cwiseProduct(s->lambda).lpNorm<Eigen::Infinity>(), 1e-6) << trial;
  }
}

TEST(QuadraticProgram, AgreesWithTryingEveryActiveSet) {
  Random random(2);
  for (int trial = 0; trial < 30; ++trial) {
    const QuadraticProgram q = random_program(random, 3, 1, 4, 3);
    const auto solution = solve_quadratic_program(q);
    ASSERT_TRUE(solution) << trial;
    EXPECT_NEAR(solution->value, lowest_by_active_sets(q), 1e-7) << trial;
  }
}

TEST(QuadraticProgram, SaysWhereConditionsContradictEachOther) {
  const QuadraticProgram program{Matrix::Identity(1, 1), Vector::Zero(1),       Matrix::Identity(1, 1),
                                 Vector{{2.0}},          Matrix{{1.0}, {-1.0}}, Vector{{1.0, 1.0}}};
  const auto solution = solve_quadratic_program(program);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().kind, ErrorKind::not_usable);
}

TEST(QuadraticProgram, RefusesShapesThatDoNotFit) {
  const QuadraticProgram program{Matrix::Identity(2, 2), Vector::Zero(1), Matrix(0, 1), Vector(0),
                                 Matrix{{1.0}},          Vector{{1.0}}};
  EXPECT_EQ(solve_quadratic_program(program).error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace mbk::numeric
