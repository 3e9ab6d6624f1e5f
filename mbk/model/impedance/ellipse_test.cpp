#include "mbk/model/impedance/ellipse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mbk/base/numeric/dense.h"

namespace mbk::impedance {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

Matrix symmetric(double xx, double yy, double s) {
  return (Matrix(2, 2) << xx, s, s, yy).finished();
}

TEST(Ellipse, HasThePublishedNumbersOfParticipantP1) {
  // Symmetric parts rebuilt from table 3.3 of Dyck 2013; the printed values are rounded to the last digit shown.
  const Ellipse inertia = ellipse(symmetric(1.326, 1.883, -0.935));
  EXPECT_NEAR(inertia.area, 5.1, 0.06);
  EXPECT_NEAR(inertia.shape, 4.1, 0.06);
  EXPECT_NEAR(kDegrees * inertia.orientation, 126.7, 0.15);
  const Ellipse stiffness = ellipse(symmetric(42.4, 125.3, -28.6));
  EXPECT_NEAR(stiffness.area, 14139.5, 60.0);
  EXPECT_NEAR(stiffness.shape, 4.0, 0.06);
  EXPECT_NEAR(kDegrees * stiffness.orientation, 107.3, 0.15);
}

TEST(Ellipse, HasAnOrientationWhereTheFormulaOfTheSourceHasNone) {
  EXPECT_DOUBLE_EQ(ellipse(symmetric(3.0, 1.0, 0.0)).orientation, 0.0);
  EXPECT_DOUBLE_EQ(kDegrees * ellipse(symmetric(1.0, 3.0, 0.0)).orientation, 90.0);
}

TEST(Ellipse, KeepsItsOrientationBelowPi) {
  EXPECT_EQ(ellipse(symmetric(3.0, 1.0, -1e-20)).orientation, 0.0);
}

TEST(Ellipse, AgreesWithTheEigenvectors) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    Matrix Z(2, 2);
    for (double& z : Z.reshaped()) z = static_cast<double>(random()) / 4294967296.0 - 0.5;
    const Ellipse e = ellipse(Z);
    const auto [values, vectors] = numeric::symmetric_eigen(symmetric_part(Z));
    EXPECT_NEAR(e.lambda_min, values[0], 1e-14);
    EXPECT_NEAR(e.lambda_max, values[1], 1e-14);
    const Vector major = (Vector(2) << std::cos(e.orientation), std::sin(e.orientation)).finished();
    EXPECT_NEAR(std::abs(major.dot(vectors.col(1))), 1.0, 1e-12);
    EXPECT_GE(e.orientation, 0.0);
    EXPECT_LT(e.orientation, std::numbers::pi);
    EXPECT_EQ(std::isnan(e.area), e.lambda_min <= 0.0);
  }
}

TEST(Ellipse, GradientAgreesWithFiniteDifferences) {
  const Matrix Z = (Matrix(2, 2) << 6.0, -3.0, -2.0, 12.0).finished();
  const EllipseGradient gradient = ellipse_gradient(Z);
  constexpr double kStep = 1e-6;
  for (Index k = 0; k < 4; ++k) {
    Matrix up = Z, down = Z;
    up(k / 2, k % 2) += kStep;
    down(k / 2, k % 2) -= kStep;
    const Ellipse a = ellipse(up), b = ellipse(down);
    // Central differences: h² for the truncation and eps·|value|/h for the rounding.
    EXPECT_NEAR(gradient.area[k], (a.area - b.area) / (2.0 * kStep), 1e-6);
    EXPECT_NEAR(gradient.shape[k], (a.shape - b.shape) / (2.0 * kStep), 1e-8);
    EXPECT_NEAR(gradient.orientation[k], (a.orientation - b.orientation) / (2.0 * kStep), 1e-8);
    EXPECT_NEAR(gradient.lambda_min[k], (a.lambda_min - b.lambda_min) / (2.0 * kStep), 1e-8);
    EXPECT_NEAR(gradient.lambda_max[k], (a.lambda_max - b.lambda_max) / (2.0 * kStep), 1e-8);
  }
}

TEST(Ellipse, MeasuresAntisymmetryAsPublished) {
  // P1: |k_a| = 7.72 N/m is 11.5 % of the geometric mean of the eigenvalues.
  Matrix K = symmetric(42.4, 125.3, -28.6);
  K(0, 1) += 7.72;
  K(1, 0) -= 7.72;
  EXPECT_NEAR(antisymmetric_part(K), 7.72, 1e-12);
  EXPECT_NEAR(antisymmetry_percent(K), 11.5, 0.05);
  EXPECT_TRUE(std::isnan(antisymmetry_percent(symmetric(1.0, -1.0, 0.0))));
}

}  // namespace
}  // namespace mbk::impedance
