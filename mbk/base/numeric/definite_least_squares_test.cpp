#include "mbk/base/numeric/definite_least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/test_cones.h"

namespace mbk::numeric {
namespace definite_least_squares_test {

using testing_support::random_cone_program;

DefiniteSolution solved(const DefiniteProgram& program) {
  auto solution = solve_definite_program(program);
  EXPECT_TRUE(solution) << solution.error().line();
  return solution ? *solution : DefiniteSolution{};
}

DefiniteProgram program_of(Index variables, Index seen) {
  DefiniteProgram program;
  program.seen = seen;
  program.linear = program.tether = program.start = Vector::Zero(variables);
  return program;
}

/// ½ x² with x above `bound`.
DefiniteProgram above(double bound, double start) {
  DefiniteProgram program = program_of(1, 1);
  program.start[0] = start;
  program.conditions.push_back({Matrix::Ones(1, 1), Vector::Constant(1, -bound), Matrix::Ones(1, 1)});
  return program;
}

TEST(DefiniteLeastSquares, StopsAtTheEdgeOfWhatIsDefinite) {
  const DefiniteSolution edge = solved(above(3.0, 10.0));
  EXPECT_GT(edge.x[0], 3.0);
  EXPECT_NEAR(edge.value, 4.5, 2e-4);  // about the gap
  EXPECT_NEAR(edge.matrices[0](0, 0), edge.x[0] - 3.0, 1e-15);
  EXPECT_NEAR(edge.pressure[0], 3.0, 1e-2);  // what x² / 2 falls where the bound does
  const DefiniteSolution free = solved(above(-2.0, 10.0));
  EXPECT_NEAR(free.x[0], 0.0, 1e-2);  // within the gap of 0
  EXPECT_LT(free.value, 1e-4);
  EXPECT_LT(free.pressure[0], 1e-3);
}

TEST(DefiniteLeastSquares, HasTheMinimumOfTheConeProgram) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const ConeProgram cone = random_cone_program(random, 6, {3, 2, 1, 4});
    const auto expected = solve_cone_program(cone);
    ASSERT_TRUE(expected) << expected.error().line();
    // ½ xᵀP x + qᵀx = ½ |y|² − ½ |y₀|² with y = U x + y₀, P = UᵀU, y₀ = U⁻ᵀq
    const Matrix U = Cholesky(cone.P).upper(), inverse = Lu(U).solve(Matrix::Identity(6, 6));
    const Vector shift = inverse.transpose() * cone.q;
    DefiniteProgram program = program_of(6, 6);
    program.start = shift;
    for (const SemidefiniteCone& one : cone.cones) {
      const auto n = std::llround(std::sqrt(static_cast<double>(one.b.size())));
      program.conditions.push_back({one.A * inverse, one.b - one.A * (inverse * shift), Matrix::Identity(n, n)});
    }
    const DefiniteSolution found = solved(program);
    const double value = found.value - 0.5 * shift.squaredNorm();
    EXPECT_GE(value, expected->value - 1e-8) << seed;  // the two solvers' rounding
    EXPECT_LE(value, expected->value + 2e-4) << seed;  // the gap
    for (const Matrix& S : found.matrices) EXPECT_GT(symmetric_eigenvalues(S)[0], 0.0);
  }
}

TEST(DefiniteLeastSquares, DecidesWhatTheSumDoesNotSeeByTheDivergence) {
  // [2 + x₀, x₁; x₁, 5]: x₀ is seen, and free; x₁ is where tr(P⁻¹S) − log det S is least.
  DefiniteProgram program = program_of(2, 1);
  Matrix A = Matrix::Zero(4, 2), P(2, 2);
  A(0, 0) = A(1, 1) = A(2, 1) = 1.0;
  P << 1.0, 0.4, 0.4, 2.0;
  program.conditions.push_back({A, Eigen::Vector4d(2.0, 0.0, 0.0, 5.0), P});
  program.start << 7.0, -1.0;
  program.gap = 1e-10;
  const DefiniteSolution found = solved(program);
  EXPECT_NEAR(found.x[0], 0.0, 1e-5);
  // d/dx₁: 2 (P⁻¹)₁₂ + 2 x₁/(10 − x₁²) = 0
  const double p = -0.4 / (2.0 - 0.16), expected = (1.0 - std::sqrt(1.0 + 4.0 * p * p * 10.0)) / (2.0 * p);
  EXPECT_NEAR(found.x[1], expected, 1e-4);
}

TEST(DefiniteLeastSquares, KeepsWhatNothingHoldsWhereItStarted) {
  DefiniteProgram program = above(3.0, 10.0);
  for (Vector* one : {&program.linear, &program.tether, &program.start}) one->conservativeResizeLike(Vector::Zero(2));
  program.conditions[0].A.conservativeResizeLike(Matrix::Zero(1, 2));
  program.tether[1] = 0.01;
  program.start[1] = -4.0;
  EXPECT_NEAR(solved(program).x[1], -4.0, 1e-9);
}

TEST(DefiniteLeastSquares, StopsWhereItIsEnough) {
  DefiniteProgram program = above(-100.0, 50.0);
  program.seen = 0;
  program.linear[0] = 1.0;  // down to −100
  program.enough = -1.0;
  const DefiniteSolution found = solved(program);
  EXPECT_LT(found.value, -1.0);
  EXPECT_GT(found.value, -99.9);
}

TEST(DefiniteLeastSquares, SaysWhatItCannotSolve) {
  EXPECT_FALSE(solve_definite_program(above(3.0, 2.0)));  // starts outside
  DefiniteProgram program = above(3.0, 10.0);
  program.conditions[0].reference(0, 0) = -1.0;
  EXPECT_FALSE(solve_definite_program(program));
  program = above(3.0, 10.0);
  program.conditions[0].A(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_definite_program(program));
  program = above(3.0, 10.0);
  program.linear = Vector::Zero(2);
  EXPECT_FALSE(solve_definite_program(program));
  // A direction that nothing decides has no minimum.
  program = above(3.0, 10.0);
  for (Vector* one : {&program.linear, &program.tether, &program.start}) one->conservativeResizeLike(Vector::Zero(2));
  program.conditions[0].A.conservativeResizeLike(Matrix::Zero(1, 2));
  const auto undecided = solve_definite_program(program);
  ASSERT_FALSE(undecided);
  EXPECT_EQ(undecided.error().kind, ErrorKind::not_usable);
}

}  // namespace definite_least_squares_test
}  // namespace mbk::numeric
