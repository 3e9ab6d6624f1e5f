// Closed forms for M s + B + K/s against the exact decisions for any rational matrix.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mbk/base/lti/positive_real.h"
#include "mbk/base/lti/rational_passivity_index.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/analyse/judge_passivity.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::pipeline {
namespace {

/// Entries are multiples of 1/8, so that singular matrices are common and exact.
Matrix symmetric(numeric::Random& random) {
  const auto eighths = [&](double low, double high) { return std::round(8.0 * random.uniform(low, high)) / 8.0; };
  const double off = eighths(-1.0, 1.0);
  return Matrix{{eighths(-0.2, 1.5), off}, {off, eighths(-0.2, 1.5)}};
}

TEST(SymmetricModels, ArePositiveRealWhereTheCorrectedTheoremSaysSo) {
  numeric::Random random(1);
  int passive = 0, edge = 0;
  for (int i = 0; i < 400; ++i) {
    const impedance::Model model{symmetric(random), symmetric(random), symmetric(random), Vector::Zero(2)};
    bool corrected = true, marginal = false;
    for (int k = 0; k < 3; ++k) {
      // Trace and determinant are exact for such entries.
      const Matrix& Z = k == 0 ? model.M : k == 1 ? model.B : model.K;
      const double determinant = Z(0, 0) * Z(1, 1) - Z(0, 1) * Z(1, 0);
      corrected = corrected && Z.trace() >= 0.0 && determinant >= 0.0;
      marginal = marginal || determinant == 0.0;
    }
    const auto exact = lti::positive_real(lti::RationalMatrix::impedance(model.M, model.B, model.K).value());
    ASSERT_TRUE(exact);
    EXPECT_EQ(exact->holds(), corrected) << model.M << "\n" << model.B << "\n" << model.K;
    passive += exact->holds() ? 1 : 0;
    edge += exact->holds() && marginal ? 1 : 0;
  }
  EXPECT_GT(passive, 20);
  EXPECT_GT(edge, 1);
}

// (3.19) and (3.20) hold, and K is not positive semidefinite.
TEST(SymmetricModels, OfTheTheoremsBoundaryAreNotPassive) {
  impedance::Model model{Matrix::Identity(2, 2), Matrix::Identity(2, 2), Matrix{{0.0, 0.0}, {0.0, -1.0}},
                         Vector::Zero(2)};
  EXPECT_GE(model.K(0, 0), 0.0);
  EXPECT_GE(model.K.determinant(), 0.0);
  EXPECT_FALSE(lti::positive_real(lti::RationalMatrix::impedance(model.M, model.B, model.K).value())->holds());
  EXPECT_EQ(impedance::smallest_eigenvalue(model, 2).value, -1.0);
  EXPECT_FALSE(impedance::excess_of_passivity(model).has_value());
}

TEST(ExcessOfPassivity, IsTheInputPassivityIndexOfTheRationalMatrix) {
  numeric::Random random(2);
  int compared = 0;
  for (int i = 0; i < 200 && compared < 25; ++i) {
    const impedance::Model model{symmetric(random), symmetric(random), symmetric(random), Vector::Zero(2)};
    const auto excess = impedance::excess_of_passivity(model);
    if (!excess) continue;
    const auto index = lti::input_passivity_index(lti::RationalMatrix::impedance(model.M, model.B, model.K).value());
    // At the boundary rounding decides on one side, and nothing on the other.
    const bool inside = model.M.determinant() > 0.0 && model.K.determinant() > 0.0;
    if (!inside) continue;
    ASSERT_TRUE(index) << index.error().line();
    EXPECT_NEAR(excess->value, index->value, 1e-9);
    ++compared;
  }
  EXPECT_EQ(compared, 25);
}

TEST(AntisymmetricStiffness, LeavesNoIndexOverAllFrequencies) {
  const Matrix K{{42.4, -20.9}, {-36.3, 125.3}};
  const Matrix M{{1.326, -0.935}, {-0.935, 1.883}}, B{{5.76, -2.14}, {-2.14, 10.56}};
  EXPECT_FALSE(lti::positive_real(lti::RationalMatrix::impedance(M, B, K).value())->holds());
  EXPECT_FALSE(lti::input_passivity_index(lti::RationalMatrix::impedance(M, B, K).value()));
}

}  // namespace
}  // namespace mbk::pipeline
