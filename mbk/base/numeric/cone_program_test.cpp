#include "mbk/base/numeric/cone_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/test_cones.h"

namespace mbk::numeric {
namespace {

using namespace testing_support;

constexpr double kExact = 1e-12;  // of numbers near 1, after a Newton step that converged
constexpr double kAgreed = 1e-8;  // two methods, each of which stops at about 1e-10

double value_at(const ConeProgram& program, const Vector& x) {
  return 0.5 * x.dot(program.P * x) + program.q.dot(x);
}

/// min ½‖X − X₀‖² over X ⪰ 0 of size n, X in full (its antisymmetric part is free).
ConeProgram projection(const Matrix& X0) {
  const Index m = X0.size();
  return {Matrix::Identity(m, m), -X0.reshaped(), {{Matrix::Identity(m, m), Vector::Zero(m)}}};
}

TEST(ConeProgram, ProjectsADiagonalMatrixByClippingIt) {
  const Matrix X0 = Vector{{3.0, -2.0, 0.5}}.asDiagonal();
  const auto found = solve_cone_program(projection(X0));
  ASSERT_TRUE(found);
  EXPECT_LT((found->x.reshaped(3, 3) - Matrix(Vector{{3.0, 0.0, 0.5}}.asDiagonal())).norm(), kExact);
  EXPECT_LT((found->multiplier[0] - Matrix(Vector{{0.0, 2.0, 0.0}}.asDiagonal())).norm(), kExact);
  EXPECT_NEAR(found->value, 0.5 * 4.0 - 0.5 * X0.squaredNorm(), kExact);
}

TEST(ConeProgram, ProjectsASquareMatrixByClippingItsSymmetricPartAndKeepingTheRest) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix X0 = random_matrix(random, 4, 4), symmetric = 0.5 * (X0 + X0.transpose());
    const auto [values, vectors] = symmetric_eigen(symmetric);
    const Matrix clipped = vectors * values.cwiseMax(0.0).asDiagonal() * vectors.transpose();
    const auto found = solve_cone_program(projection(X0));
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((Matrix(found->x.reshaped(4, 4)) - (X0 - symmetric + clipped)).norm(), kExact) << trial;
  }
}

TEST(ConeProgram, OfOneNumberIsAHalfLine) {
  // min (x − 3)² over x ≤ 1: the multiplier is the slope there.
  const ConeProgram program{
      Matrix::Constant(1, 1, 2.0), Vector{{-6.0}}, {{Matrix::Constant(1, 1, -1.0), Vector{{1.0}}}}};
  const auto found = solve_cone_program(program);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x[0], 1.0, kExact);
  EXPECT_NEAR(found->multiplier[0](0, 0), 4.0, kExact);
}

TEST(ConeProgram, LeavesAFreeMinimumInsideTheConesWhereItIs) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    ConeProgram program = random_cone_program(random, 6, {3, 2, 1});
    const Vector x = 0.01 * random_matrix(random, 6, 1);
    program.q = -program.P * x;
    const auto found = solve_cone_program(program);
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->x - x).norm(), kExact) << trial;
  }
}

TEST(ConeProgram, MeetsTheConditionsOfKarushKuhnAndTucker) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    ConeProgram program = random_cone_program(random, 8, {3, 2, 2, 1, 1});
    if (trial % 3 == 0) {  // P of rank 4, and x in a box that keeps the minimum finite
      const Matrix root = random_matrix(random, 4, 8);
      program.P = root.transpose() * root;
      for (Index i = 0; i < 8; ++i) {
        program.cones.push_back({Vector::Unit(8, i).transpose(), Vector{{2.0}}});
        program.cones.push_back({-Vector::Unit(8, i).transpose(), Vector{{2.0}}});
      }
    }
    const auto found = solve_cone_program(program);
    ASSERT_TRUE(found) << trial;
    Vector slope = program.P * found->x + program.q;
    const double size = 1.0 + slope.norm();
    for (std::size_t k = 0; k < program.cones.size(); ++k) {
      const Matrix &S = found->slack[k], &Y = found->multiplier[k];
      EXPECT_LT((S - symmetric_matrix(program.cones[k], found->x)).norm(), 1e-9 * size) << trial;
      EXPECT_GT(symmetric_eigenvalues(S).minCoeff(), -kExact * size) << trial;
      EXPECT_GT(symmetric_eigenvalues(Y).minCoeff(), -kExact * size) << trial;
      EXPECT_LT((S * Y).norm(), 1e-10 * size) << trial;
      slope -= program.cones[k].A.transpose() * Y.reshaped();
    }
    EXPECT_LT(slope.norm(), 1e-9 * size) << trial;
    EXPECT_NEAR(found->value, found->dual_value, 1e-9 * (1.0 + std::abs(found->value))) << trial;
  }
}

TEST(ConeProgram, AgreesWithTheBarrierMethod) {
  Random random(4);
  int pressed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const ConeProgram program = random_cone_program(random, 6, {2, 2, 2});
    const auto found = solve_cone_program(program);
    ASSERT_TRUE(found) << trial;
    const Vector twin = minimum_by_barrier(program, Vector::Zero(6));
    EXPECT_LT((found->x - twin).norm(), kAgreed * (1.0 + twin.norm())) << trial;
    EXPECT_NEAR(found->value, value_at(program, twin), kAgreed * (1.0 + std::abs(found->value))) << trial;
    for (const Matrix& Y : found->multiplier) pressed += Y.norm() > 1e-6 ? 1 : 0;
  }
  EXPECT_GT(pressed, 200);  // the cones were in the way
}

TEST(ConeProgram, FindsACornerWhereAWholeMatrixIsZero) {
  // Both eigenvalues want to be negative: X = 0, and the multiplier is its target.
  const Matrix X0{{-1.0, 0.3}, {0.3, -2.0}};
  const auto found = solve_cone_program(projection(X0));
  ASSERT_TRUE(found);
  EXPECT_LT(found->x.norm(), kExact);
  EXPECT_LT((found->multiplier[0] + X0).norm(), kExact);
}

TEST(ConeProgram, TouchesAConeThatDoesNotPress) {
  // The free minimum is on the border: the eigenvalue and its multiplier are both zero.
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector direction = random_matrix(random, 2, 1);
    const Matrix X0 = direction * direction.transpose(), root = random_matrix(random, 4, 4);
    ConeProgram program = projection(X0);
    program.P = root.transpose() * root + 0.1 * Matrix::Identity(4, 4);
    program.q = -program.P * X0.reshaped();
    const auto found = solve_cone_program(program);
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->x - X0.reshaped()).norm(), kAgreed) << trial;
  }
}

TEST(ConeProgram, IsNotDisturbedByAConditionThatStandsThereTwice) {
  Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    ConeProgram program = random_cone_program(random, 5, {2, 2});
    const auto once = solve_cone_program(program);
    program.cones.push_back(program.cones.front());
    const auto twice = solve_cone_program(program);
    ASSERT_TRUE(once && twice) << trial;
    EXPECT_LT((once->x - twice->x).norm(), kAgreed) << trial;
  }
}

TEST(ConeProgram, DoesNotDependOnUnits) {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const ConeProgram program = random_cone_program(random, 6, {2, 2, 1});
    Vector unit(6);
    for (double& value : unit) value = std::pow(10.0, random.uniform(-4.0, 4.0));
    constexpr double kForce = 1e3, kCone = 1e-5;
    ConeProgram other{kForce * unit.asDiagonal() * program.P * unit.asDiagonal(), kForce * unit.cwiseProduct(program.q),
                      program.cones};
    for (SemidefiniteCone& cone : other.cones) {
      cone.A = kCone * cone.A * unit.asDiagonal();
      cone.b *= kCone;
    }
    const auto one = solve_cone_program(program), two = solve_cone_program(other);
    ASSERT_TRUE(one && two) << trial;
    EXPECT_LT((one->x - unit.cwiseProduct(two->x)).norm(), kAgreed * (1.0 + one->x.norm())) << trial;
    EXPECT_NEAR(kForce * one->value, two->value, kAgreed * kForce * (1.0 + std::abs(one->value))) << trial;
  }
}

TEST(ConeProgram, SaysWhereConditionsContradictEachOther) {
  const ConeProgram program{Matrix::Identity(1, 1),
                            Vector::Zero(1),
                            {{Matrix::Identity(1, 1), Vector{{-1.0}}}, {-Matrix::Identity(1, 1), Vector{{-1.0}}}}};
  const auto found = solve_cone_program(program);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::not_usable);
}

TEST(ConeProgram, SaysWhereThereIsNoMinimum) {
  const ConeProgram program{Matrix::Zero(1, 1), Vector{{-1.0}}, {{Matrix::Identity(1, 1), Vector{{0.0}}}}};
  const auto found = solve_cone_program(program);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::not_usable);
}

TEST(ConeProgram, RefusesWhatIsNotOne) {
  const ConeProgram good = projection(Matrix::Identity(2, 2));
  const auto refused = [](ConeProgram program) {
    const auto found = solve_cone_program(program);
    return !found && found.error().kind == ErrorKind::usage;
  };
  ConeProgram bad = good;
  bad.q = Vector::Zero(3);
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.cones[0].b = Vector::Zero(3);  // no square
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.P(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.cones.clear();
  EXPECT_TRUE(refused(bad));
  EXPECT_TRUE(refused({Matrix::Zero(2, 2), Vector::Zero(2), {{Matrix{{1.0, 0.0}}, Vector{{0.0}}}}}));
  EXPECT_TRUE(refused({}));
}

}  // namespace
}  // namespace mbk::numeric
