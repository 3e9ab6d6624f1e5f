#include "mbk/measure/identify/consistent_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/test_cones.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/identify/regression.h"
#include "mbk/measure/identify/test_trials.h"

namespace mbk::identify {
namespace {

using numeric::Random;
using numeric::testing_support::random_matrix;

constexpr double kRounding = 1e-11;  // of coefficients near 1 with a weight of a condition up to 1e4
constexpr double kAgreed = 1e-8;     // two methods, each of which stops at about 1e-10

Matrix symmetric(const Matrix& X) {
  return 0.5 * (X + X.transpose());
}

Matrix clipped(const Matrix& X) {
  const auto [values, vectors] = numeric::symmetric_eigen(symmetric(X));
  return vectors * values.cwiseMax(0.0).asDiagonal() * vectors.transpose();
}

double smallest(const Matrix& X) {
  return numeric::symmetric_eigenvalues(symmetric(X))[0];
}

/// M, B or K of two axes.
Matrix part_of(const Matrix& coefficients, Index part) {
  return coefficients.middleRows(2 * part, 2).transpose();
}

Matrix random_gram(Random& random, Index p) {
  const Matrix root = random_matrix(random, p, p);
  return root.transpose() * root + 0.05 * Matrix::Identity(p, p);
}

double distance(const Matrix& difference, const Matrix& gram) {
  return (difference.transpose() * gram * difference).trace();
}

TEST(NearestConsistent, ClipsTheSymmetricPartsWhereAllCoefficientsWeighAlike) {
  // Higham 1988: in the Frobenius norm the nearest semidefinite matrix is the clipped symmetric part.
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix free = random_matrix(random, 7, 2);
    const auto found = nearest_consistent(free, 3.0 * Matrix::Identity(7, 7), Structure::full, 0.0);
    ASSERT_TRUE(found) << trial;
    const Matrix& theta = found->coefficients;
    EXPECT_LT((part_of(theta, 0) - clipped(part_of(free, 0))).norm(), kRounding) << trial;
    const Matrix B = part_of(free, 1);
    EXPECT_LT((part_of(theta, 1) - clipped(B) - (B - symmetric(B))).norm(), kRounding) << trial;
    EXPECT_LT((part_of(theta, 2) - clipped(part_of(free, 2))).norm(), kRounding) << trial;
    EXPECT_LT((theta.row(6) - free.row(6)).norm(), kRounding) << trial;
  }
}

TEST(NearestConsistent, KeepsWhatIsConsistentAlready) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    Matrix free = random_matrix(random, 7, 2);
    for (const Index part : {0, 1, 2}) {
      const Matrix root = random_matrix(random, 2, 2);
      Matrix X = root * root.transpose() + 0.01 * Matrix::Identity(2, 2);
      if (part == 1) X += Matrix{{0.0, 1.5}, {-1.5, 0.0}};
      free.middleRows(2 * part, 2) = X.transpose();
    }
    const auto found = nearest_consistent(free, random_gram(random, 7), Structure::full, 0.0);
    ASSERT_TRUE(found) << trial;
    EXPECT_LT((found->coefficients - free).norm(), kRounding) << trial;
  }
}

/// The same program written down again: variables m_xx m_xy m_yy b_xx b_xy b_yx b_yy k_xx k_xy k_yy c_x c_y, from a
/// point strictly inside, by the barrier method.
Matrix twin(const Matrix& free, const Matrix& gram, double handle_mass) {
  Matrix T = Matrix::Zero(14, 12);  // θ = T φ, θ = columns x and y of the coefficients under each other
  constexpr std::array kPlaces = {std::array{0, -1}, std::array{1, 7},   std::array{8, -1},  std::array{2, -1},
                                  std::array{3, -1}, std::array{9, -1},  std::array{10, -1}, std::array{4, -1},
                                  std::array{5, 11}, std::array{12, -1}, std::array{6, -1},  std::array{13, -1}};
  for (Index column = 0; column < 12; ++column) {
    for (const int row : kPlaces[static_cast<std::size_t>(column)]) {
      if (row >= 0) T(row, column) = 1.0;
    }
  }
  Matrix W = Matrix::Zero(14, 14);
  W.topLeftCorner(7, 7) = W.bottomRightCorner(7, 7) = gram;
  numeric::ConeProgram program{T.transpose() * W * T, -T.transpose() * W * free.reshaped(), {}};
  const auto add = [&](std::array<int, 4> entries, double less) {
    numeric::SemidefiniteCone cone{Matrix::Zero(4, 12), Vector{{-less, 0.0, 0.0, -less}}};
    for (Index i = 0; i < 4; ++i) cone.A(i, entries[static_cast<std::size_t>(i)]) = 1.0;
    program.cones.push_back(cone);
  };
  add({0, 1, 1, 2}, handle_mass);
  add({3, 5, 4, 6}, 0.0);
  add({7, 8, 8, 9}, 0.0);
  const Vector inside{{2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0}};
  return (T * numeric::testing_support::minimum_by_barrier(program, inside)).reshaped(7, 2);
}

TEST(NearestConsistent, AgreesWithTheBarrierMethod) {
  Random random(3);
  int active = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix free = random_matrix(random, 7, 2), gram = random_gram(random, 7);
    const double handle_mass = trial % 2 == 0 ? 0.0 : 0.4;
    const auto found = nearest_consistent(free, gram, Structure::full, handle_mass);
    ASSERT_TRUE(found) << trial;
    const Matrix slow = twin(free, gram, handle_mass);
    EXPECT_LT((found->coefficients - slow).norm(), kAgreed * (1.0 + slow.norm())) << trial;
    const double lost = distance(found->coefficients - free, gram);
    EXPECT_NEAR(lost, distance(slow - free, gram), kAgreed * (1.0 + lost)) << trial;
    for (const Matrix& S : found->certificate.slack) active += smallest(S) < 1e-12 ? 1 : 0;
  }
  EXPECT_GT(active, 200);
}

TEST(NearestConsistent, SeesEveryOtherConsistentModelAtAnObtuseAngle) {
  // (θ₀ − θ)ᵀ W (ψ − θ) ≤ 0 for all ψ in the cones is what makes θ the nearest point of a convex set.
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const Matrix free = random_matrix(random, 7, 2), gram = random_gram(random, 7);
    const auto found = nearest_consistent(free, gram, Structure::full, 0.0);
    ASSERT_TRUE(found) << trial;
    Matrix other = random_matrix(random, 7, 2);
    for (const Index part : {0, 1, 2}) {
      Matrix X = clipped(part_of(other, part));
      if (part == 1) X += random.normal() * Matrix{{0.0, 1.0}, {-1.0, 0.0}};
      other.middleRows(2 * part, 2) = X.transpose();
    }
    const double angle = ((free - found->coefficients).transpose() * gram * (other - found->coefficients)).trace();
    EXPECT_LT(angle, 1e-9 * (1.0 + gram.norm())) << trial;
  }
}

TEST(NearestConsistent, ChangesNothingTheSecondTime) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix gram = random_gram(random, 7);
    const auto once = nearest_consistent(random_matrix(random, 7, 2), gram, Structure::full, 0.2);
    ASSERT_TRUE(once) << trial;
    const auto twice = nearest_consistent(once->coefficients, gram, Structure::full, 0.2);
    ASSERT_TRUE(twice) << trial;
    EXPECT_LT((twice->coefficients - once->coefficients).norm(), kAgreed) << trial;
  }
}

TEST(NearestConsistent, FindsModelsWithoutAnyInertiaDampingAndStiffness) {
  Matrix free = Matrix::Zero(7, 2);
  for (const Index part : {0, 1, 2}) free.middleRows(2 * part, 2) = -Matrix::Identity(2, 2);
  free.row(6) << 0.3, -0.4;
  const auto found = nearest_consistent(free, Matrix::Identity(7, 7), Structure::full, 0.0);
  ASSERT_TRUE(found);
  EXPECT_LT(found->coefficients.topRows(6).norm(), kRounding);
  EXPECT_LT((found->coefficients.row(6) - free.row(6)).norm(), kRounding);
}

TEST(NearestConsistent, KeepsAPayloadOnSpringsOne) {
  Matrix free = Matrix::Zero(7, 2);
  free(0, 0) = -0.4;
  free(1, 1) = -0.2;  // one mass: −0.3, that is none
  free.middleRows(4, 2) << 300.0, -20.0, -40.0, 200.0;
  const auto found = nearest_consistent(free, Matrix::Identity(7, 7), Structure::mass_spring, 0.0);
  ASSERT_TRUE(found);
  EXPECT_LT(found->coefficients.topRows(4).norm(), 1e-9);
  EXPECT_LT((part_of(found->coefficients, 2) - Matrix{{300.0, -30.0}, {-30.0, 200.0}}).norm(), 1e-9);
}

TEST(NearestConsistent, RefusesWhatHasNoNearestPoint) {
  const Matrix good = Matrix::Zero(7, 2), weight = Matrix::Identity(7, 7);
  EXPECT_FALSE(nearest_consistent(Matrix::Zero(6, 2), weight, Structure::full, 0.0));
  EXPECT_FALSE(nearest_consistent(good, Matrix::Identity(6, 6), Structure::full, 0.0));
  EXPECT_FALSE(nearest_consistent(good, weight, Structure::full, std::numeric_limits<double>::infinity()));
  Matrix blind = weight;
  blind(3, 3) = 0.0;
  const auto refused = nearest_consistent(good, blind, Structure::full, 0.0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::not_usable);
}

TEST(ConsistentModel, OfALimbThatIsConsistentIsTheFreeOne) {
  impedance::Model arm = testing_support::arm();
  arm.M = symmetric(arm.M);
  arm.K = symmetric(arm.K);
  const std::vector trials = {testing_support::trial(arm)};
  const auto free = identify_impedance(trials, {});
  ASSERT_TRUE(free);
  const auto found = consistent_model(trials, *free);
  ASSERT_TRUE(found);
  EXPECT_TRUE(impedance::stacked(found->model).isApprox(impedance::stacked(free->model), 1e-9));
  EXPECT_FALSE(found->inertia.active || found->damping.active || found->stiffness.active);
  EXPECT_LT(found->force_change, 1e-9);
  EXPECT_NEAR(found->fit.vaf[0], free->fit.vaf[0], 1e-9);
}

TEST(ConsistentModel, WithoutStiffnessOnOneAxisIsTheRegressionWithoutPosition) {
  impedance::Model arm = testing_support::arm(1);
  arm.K(0, 0) = -20.0;
  arm.x0[0] = 0.02;
  const std::vector trials = {testing_support::trial(arm, {.axes = 1, .noise = 0.2})};
  const auto free = identify_impedance(trials, {});
  ASSERT_TRUE(free);
  ASSERT_LT(free->model.K(0, 0), 0.0);
  const auto found = consistent_model(trials, *free);
  ASSERT_TRUE(found);
  const Regression r = stack(trials);
  const Matrix Z = rows_of(r.Z, r.identification), Y = rows_of(r.Y, r.identification);
  Matrix rest(Z.rows(), 3);
  rest << Z.leftCols(2), Z.rightCols(1);
  const Vector slow = numeric::PivotedQr(rest).solve(Y.col(0));
  EXPECT_NEAR(found->model.M(0, 0), slow[0], 1e-9);
  EXPECT_NEAR(found->model.B(0, 0), slow[1], 1e-9);
  EXPECT_NEAR(found->model.K(0, 0), 0.0, 1e-9);
  EXPECT_NEAR(found->force_at_centre[0], slow[2], 1e-9);
  EXPECT_TRUE(std::isnan(found->model.x0[0]));
  EXPECT_TRUE(found->stiffness.active);
  EXPECT_FALSE(found->inertia.active || found->damping.active);
  EXPECT_NEAR(found->residual_power, (Y - rest * slow).squaredNorm() / static_cast<double>(Y.rows()), 1e-12);
}

/// A limb that one data set makes look as if its stiffness and damping had a negative direction.
impedance::Model impossible_arm() {
  impedance::Model arm = testing_support::arm();
  arm.B = (Matrix(2, 2) << 1.0, 4.0, 5.0, 8.0).finished();
  arm.K = (Matrix(2, 2) << 20.0, -110.0, -90.0, 200.0).finished();
  return arm;
}

TEST(ConsistentModel, SaysWhichConditionsAreActiveAndWhatTheyCost) {
  const std::vector trials = {testing_support::trial(impossible_arm(), {.noise = 0.3})};
  const auto free = identify_impedance(trials, {});
  ASSERT_TRUE(free);
  const auto found = consistent_model(trials, *free);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->inertia.active);
  EXPECT_TRUE(found->damping.active);
  EXPECT_TRUE(found->stiffness.active);
  EXPECT_LT(found->stiffness.free_smallest, -10.0);
  EXPECT_NEAR(found->stiffness.smallest, 0.0, 1e-8);
  EXPECT_NEAR(found->model.K(0, 1), found->model.K(1, 0), 1e-12);
  EXPECT_GE(found->residual_power_tied, found->residual_power_free);
  EXPECT_GT(found->residual_power, found->residual_power_tied);
  EXPECT_GT(found->increase_percent(), 0.0);
  // Least squares: what the residual gains is what the force moved.
  EXPECT_NEAR(found->residual_power - found->residual_power_free, std::pow(found->force_change, 2),
              1e-9 * found->residual_power);
  EXPECT_LT(found->fit.vaf_in_sample.minCoeff(), free->fit.vaf_in_sample.minCoeff());
  EXPECT_GT(found->largest_change_errors, 3.0);
  EXPECT_EQ(found->largest_change[0] == 'm', false) << found->largest_change;
  EXPECT_LT(found->duality_gap, 1e-10);
}

TEST(ConsistentModel, HoldsTheInertiaWithoutTheHandle) {
  impedance::Model arm = testing_support::arm();
  arm.M = (Matrix(2, 2) << 0.9, -0.3, -0.3, 1.4).finished();
  const std::vector trials = {testing_support::trial(arm, {.noise = 0.1})};
  Options options;
  options.handle_mass = 0.85;  // heavier than what is there along the smaller axis
  const auto free = identify_impedance(trials, options);
  ASSERT_TRUE(free);
  const auto found = consistent_model(trials, *free);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->inertia.active);
  EXPECT_LT(found->inertia.free_smallest, -0.02);
  EXPECT_NEAR(smallest(found->model.M), 0.0, 1e-9);
  options.handle_mass = 0.0;
  EXPECT_FALSE(consistent_model(trials, *identify_impedance(trials, options))->inertia.active);
}

TEST(ConsistentModel, IsJudgedOnHeldOutDataWithParametersFromTheRest) {
  const std::vector trials = {testing_support::trial(impossible_arm(), {.noise = 0.3, .validation = 0.5})};
  Options options;
  options.parameters_from = ParametersFrom::all;
  const auto all = identify_impedance(trials, options);
  options.parameters_from = ParametersFrom::identification;
  const auto part = identify_impedance(trials, options);
  ASSERT_TRUE(all && part);
  const auto from_all = consistent_model(trials, *all), from_part = consistent_model(trials, *part);
  ASSERT_TRUE(from_all && from_part);
  EXPECT_FALSE(from_all->model.K.isApprox(from_part->model.K, 1e-6));
  EXPECT_TRUE(from_all->judged.K.isApprox(from_part->model.K, 1e-9));
  EXPECT_NEAR(from_all->fit.vaf[0], from_part->fit.vaf[0], 1e-9);
}

TEST(ConsistentModel, RefusesOtherTrialsAndModelsWithoutNumbers) {
  const std::vector trials = {testing_support::trial(testing_support::arm())};
  auto free = identify_impedance(trials, {});
  ASSERT_TRUE(free);
  const std::vector shorter = {testing_support::trial(testing_support::arm(), {.samples = 20000})};
  EXPECT_EQ(consistent_model(shorter, *free).error().kind, ErrorKind::usage);
  EXPECT_EQ(consistent_model({}, *free).error().kind, ErrorKind::usage);
  free->model.x0[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(consistent_model(trials, *free).error().kind, ErrorKind::not_usable);
}

}  // namespace
}  // namespace mbk::identify
