#include "mbk/measure/analyse/ellipses.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::analyse {
namespace ellipses_test {

constexpr double kZ95 = 1.959963984540054;

Identification identification() {
  Identification id;
  id.model.M = (Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  id.model.B = (Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  id.model.K = (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished();
  id.model.x0 = Vector::Zero(2);
  // Errors of 2 % of the largest element, correlated between neighbours.
  id.covariance = Matrix::Zero(14, 14);
  const double scales[] = {1.883, 10.56, 125.3};
  for (Index part = 0; part < 3; ++part) {
    for (Index i = 0; i < 4; ++i) {
      for (Index j = 0; j < 4; ++j) {
        id.covariance(4 * part + i, 4 * part + j) =
            std::pow(0.02 * scales[part], 2) * std::pow(0.4, std::abs(static_cast<double>(i - j)));
      }
    }
  }
  return id;
}

/// Standard deviations of what ellipses are made of, over draws of the parameters.
struct Spread {
  double log_area = 0, log_shape = 0, orientation = 0, antisymmetric = 0;
};

Spread monte_carlo(const Matrix& Z, const Matrix& covariance) {
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const Matrix root = numeric::Cholesky(covariance).upper().transpose();
  constexpr int kDraws = 20000;
  Matrix values(kDraws, 4);
  for (int draw = 0; draw < kDraws; ++draw) {
    Vector normal(4);
    for (double& value : normal) {
      value = -6.0;
      for (int k = 0; k < 12; ++k) value += uniform();
    }
    const Vector change = root * normal;
    Matrix drawn = Z;
    drawn(0, 0) += change[0];
    drawn(0, 1) += change[1];
    drawn(1, 0) += change[2];
    drawn(1, 1) += change[3];
    const impedance::Ellipse e = impedance::ellipse(drawn);
    values.row(draw) << std::log(e.area), std::log(e.shape), e.orientation, impedance::antisymmetric_part(drawn);
  }
  const Matrix centred = values.rowwise() - values.colwise().mean();
  const Vector deviation = (centred.cwiseAbs2().colwise().mean()).cwiseSqrt().transpose();
  return {deviation[0], deviation[1], deviation[2], deviation[3]};
}

TEST(AnalyseEllipses, IntervalsAreThoseOfAMonteCarlo) {
  const Identification id = identification();
  const Findings findings = analyse_ellipses(id).value();
  const Matrix* matrices[] = {&id.model.M, &id.model.B, &id.model.K};
  // 20,000 draws give a deviation to 0.5 %; the second order of the delta method is about (6 % error)/2.
  const double kSecondOrder = 0.05;
  for (Index k = 0; k < 3; ++k) {
    const EllipseFinding& finding = findings.ellipses[static_cast<std::size_t>(k)];
    const Spread spread = monte_carlo(*matrices[k], id.covariance.block(4 * k, 4 * k, 4, 4));
    const double area = std::log(finding.area95.second / finding.area95.first) / (2.0 * kZ95);
    const double shape = std::log(finding.shape95.second / finding.shape95.first) / (2.0 * kZ95);
    const double orientation = (finding.orientation95.second - finding.orientation95.first) / (2.0 * kZ95);
    EXPECT_NEAR(area / spread.log_area, 1.0, kSecondOrder) << kMatrixNames[static_cast<std::size_t>(k)];
    EXPECT_NEAR(shape / spread.log_shape, 1.0, kSecondOrder) << kMatrixNames[static_cast<std::size_t>(k)];
    EXPECT_NEAR(orientation / spread.orientation, 1.0, kSecondOrder) << kMatrixNames[static_cast<std::size_t>(k)];
  }
  const Spread stiffness = monte_carlo(id.model.K, id.covariance.block(8, 8, 4, 4));
  const Interval antisymmetric = findings.antisymmetry[1].value95;
  EXPECT_NEAR((antisymmetric.second - antisymmetric.first) / (2.0 * kZ95) / stiffness.antisymmetric, 1.0, 0.02);
}

TEST(AnalyseEllipses, EveryIntervalHoldsItsValue) {
  const Findings findings = analyse_ellipses(identification()).value();
  for (const EllipseFinding& finding : findings.ellipses) {
    EXPECT_LT(finding.area95.first, finding.ellipse.area);
    EXPECT_GT(finding.area95.second, finding.ellipse.area);
    EXPECT_GT(finding.shape95.first, 0.0);
    EXPECT_LT(finding.orientation95.first, finding.ellipse.orientation);
  }
}

TEST(AnalyseEllipses, AntisymmetryIsSignedAndItsShareIsNot) {
  const Findings findings = analyse_ellipses(identification()).value();
  const AntisymmetryFinding& stiffness = findings.antisymmetry[1];
  EXPECT_NEAR(stiffness.value, 7.7, 1e-12);  // participant 1, with the published share of 11.5 %
  EXPECT_NEAR(stiffness.zmean_percent, 11.5, 0.05);
  EXPECT_LT(stiffness.zmean95.first, stiffness.zmean_percent);
  EXPECT_GT(stiffness.zmean95.second, stiffness.zmean_percent);
  Identification turned = identification();
  turned.model.K.transposeInPlace();
  EXPECT_NEAR(analyse_ellipses(turned)->antisymmetry[1].value, -7.7, 1e-12);
  EXPECT_NEAR(analyse_ellipses(turned)->antisymmetry[1].zmean_percent, stiffness.zmean_percent, 1e-9);
  EXPECT_NEAR(analyse_ellipses(turned)->antisymmetry[1].zmean95.first, stiffness.zmean95.first, 1e-9);
}

TEST(AnalyseEllipses, AShareWhoseIntervalHoldsZeroBeginsAtZero) {
  EXPECT_EQ(analyse_ellipses(identification())->antisymmetry[0].zmean95.first, 0.0);  // M is symmetric
}

TEST(AnalyseEllipses, AnIndefiniteMatrixHasNoEllipse) {
  for (const double diagonal : {-5.0, 1.0}) {
    Identification id = identification();
    id.model.K = (Matrix(2, 2) << diagonal, 3.0, 1.0, diagonal).finished();
    const Findings findings = analyse_ellipses(id).value();
    const EllipseFinding& finding = findings.ellipses[2];
    for (const double value : {finding.ellipse.area, finding.ellipse.shape, finding.area95.first, finding.area95.second,
                               finding.shape95.first, finding.shape95.second, findings.antisymmetry[1].zmean_percent,
                               findings.antisymmetry[1].zmean95.first, findings.antisymmetry[1].zmean95.second}) {
      EXPECT_TRUE(std::isnan(value)) << value << " for a diagonal of " << diagonal;
    }
    EXPECT_EQ(findings.antisymmetry[1].value, 1.0);
  }
}

TEST(AnalyseEllipses, WithoutACovarianceThereAreNoIntervals) {
  Identification id = identification();
  id.covariance.setConstant(std::nan(""));
  const Findings findings = analyse_ellipses(id).value();
  EXPECT_GT(findings.ellipses[0].ellipse.area, 0.0);
  EXPECT_TRUE(std::isnan(findings.ellipses[0].area95.first)) << findings.ellipses[0].area95.first;
  EXPECT_TRUE(std::isnan(findings.ellipses[0].orientation95.second));
  EXPECT_TRUE(std::isnan(findings.antisymmetry[1].value95.first));
  EXPECT_TRUE(std::isnan(findings.antisymmetry[1].zmean95.first));
}

TEST(AnalyseEllipses, RefusesOneAxis) {
  Identification id;
  id.axes = 1;
  EXPECT_FALSE(analyse_ellipses(id));
}

/// How often the set of orientations holds the truth, and how often it holds all angles, over draws of K.
std::pair<double, double> orientations(const Eigen::Matrix2d& truth, const Eigen::Matrix4d& covariance) {
  constexpr int kDraws = 2000;
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  const Eigen::Matrix4d root = covariance.llt().matrixL();
  const double angle = impedance::ellipse(truth).orientation;
  double held = 0, all = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::Vector4d error;
    for (double& one : error) one = normal(engine);
    error = root * error;
    const Matrix Z = truth + (Eigen::Matrix2d() << error[0], error[1], error[2], error[3]).finished();
    const EllipseFinding finding = ellipse_finding(Z, covariance);
    const auto [low, high] = finding.orientation95;
    const double at = angle + std::numbers::pi * std::ceil((low - angle) / std::numbers::pi);
    held += at <= high ? 1.0 : 0.0;
    all += finding.round ? 1.0 : 0.0;
    EXPECT_EQ(finding.round, high - low > 0.999 * std::numbers::pi);
  }
  return {held / kDraws, all / kDraws};
}

TEST(EllipseFinding, HoldsEveryAngleWhereTheEllipseMayBeRound) {
  Eigen::Matrix4d covariance = identification().covariance.block<4, 4>(8, 8);
  covariance *= 4.0;
  const auto [held, all] = orientations(100.0 * Eigen::Matrix2d::Identity(), covariance);
  EXPECT_GT(held, 0.94);
  EXPECT_NEAR(all, 0.95, 0.015);
}

TEST(EllipseFinding, HoldsTheOrientationOfAnyEllipse) {
  const Eigen::Matrix4d covariance = identification().covariance.block<4, 4>(8, 8);
  for (const double difference : {2.0, 5.0, 10.0, 20.0, 80.0}) {
    const Eigen::Rotation2Dd turn(0.4);
    const Eigen::Matrix2d truth = turn * Eigen::Vector2d(100.0 + difference, 100.0).asDiagonal() * turn.inverse();
    EXPECT_GT(orientations(truth, covariance).first, 0.935) << difference;
  }
  EXPECT_LT(orientations(Eigen::Vector2d(180.0, 100.0).asDiagonal(), covariance).second, 0.01);
}

TEST(EllipseFinding, GivesTheEigenvaluesTheirIntervals) {
  const Findings findings = *analyse_ellipses(identification());
  const EllipseFinding& stiffness = findings.ellipses[2];
  EXPECT_LT(stiffness.lambda_max95.first, stiffness.ellipse.lambda_max);
  EXPECT_GT(stiffness.lambda_max95.second, stiffness.ellipse.lambda_max);
  EXPECT_LT(stiffness.lambda_min95.first, stiffness.ellipse.lambda_min);
  EXPECT_GT(stiffness.lambda_min95.second, stiffness.ellipse.lambda_min);
  EXPECT_FALSE(stiffness.round);
}

/// Of a matrix in space, with errors of `relative` of its norm.
EllipsoidFinding ellipsoid(const Matrix& Z, double relative) {
  return ellipsoid_finding(Z, std::pow(relative * Z.norm(), 2) * Matrix::Identity(9, 9));
}

const Matrix kInSpace = (Matrix(3, 3) << 90.0, -30.0, 20.0, -40.0, 200.0, 10.0, 30.0, -20.0, 150.0).finished();

TEST(Ellipsoids, PrincipalValuesAndAxesAreThoseOfTheSymmetricPart) {
  const EllipsoidFinding found = ellipsoid(kInSpace, 1e-3);
  Matrix sum = Matrix::Zero(3, 3);
  for (const PrincipalDirection& one : found.principal) {
    EXPECT_NEAR(one.direction.norm(), 1.0, 1e-14);
    sum += one.value * one.direction * one.direction.transpose();
  }
  EXPECT_LE((sum - found.symmetric).norm(), 1e-11);
  EXPECT_GT(found.principal[0].value, found.principal[1].value);
  EXPECT_TRUE(found.closed);
  EXPECT_NEAR(found.volume, 4.0 / 3.0 * std::numbers::pi * numeric::determinant(found.symmetric), 1e-6);
}

TEST(Ellipsoids, TurnWithTheFrame) {
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();
  const EllipsoidFinding here = ellipsoid(kInSpace, 0.01), there = ellipsoid(R * kInSpace * R.transpose(), 0.01);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(there.principal[k].value, here.principal[k].value, 1e-9);
    EXPECT_NEAR(there.principal[k].value95.first, here.principal[k].value95.first, 1e-9);
    EXPECT_NEAR(there.principal[k].half_angle95, here.principal[k].half_angle95, 1e-9);
    EXPECT_NEAR(std::abs(there.principal[k].direction.dot(R * here.principal[k].direction)), 1.0, 1e-9);
  }
  EXPECT_NEAR(there.volume95.first, here.volume95.first, 1e-6 * here.volume);
  const CirculationFinding one = circulation_finding(kInSpace, Matrix::Identity(9, 9)),
                           other = circulation_finding(R * kInSpace * R.transpose(), Matrix::Identity(9, 9));
  EXPECT_LE((other.vector - R * one.vector).norm(), 1e-9);
  EXPECT_NEAR(other.size95.first, one.size95.first, 1e-9);
}

TEST(Ellipsoids, ConesAndIntervalsContainTheTruthAsOftenAsTheySay) {
  const Matrix symmetric = impedance::symmetric_part(kInSpace);
  const EllipsoidFinding truth = ellipsoid(symmetric, 1e-6);
  numeric::Random random(6);
  constexpr int kDraws = 2000;
  constexpr double kRelative = 0.01;
  std::array<int, 3> in_cone{}, in_interval{};
  int in_volume = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Matrix Z = symmetric;
    for (double& value : Z.reshaped()) value += kRelative * symmetric.norm() * random.normal();
    const EllipsoidFinding found =
        ellipsoid_finding(Z, std::pow(kRelative * symmetric.norm(), 2) * Matrix::Identity(9, 9));
    for (std::size_t k = 0; k < 3; ++k) {
      const PrincipalDirection &one = found.principal[k], &real = truth.principal[k];
      const double away = std::acos(std::min(1.0, std::abs(one.direction.dot(real.direction))));
      in_cone[k] += away <= one.half_angle95 ? 1 : 0;
      in_interval[k] += real.value >= one.value95.first && real.value <= one.value95.second ? 1 : 0;
    }
    in_volume += truth.volume >= found.volume95.first && truth.volume <= found.volume95.second ? 1 : 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GE(in_cone[k], 0.94 * kDraws);  // a cone is as wide as its widest side
    EXPECT_NEAR(in_interval[k], 0.95 * kDraws, 0.02 * kDraws);
  }
  EXPECT_NEAR(in_volume, 0.95 * kDraws, 0.02 * kDraws);
}

TEST(Ellipsoids, WhereTwoValuesMayBeEqualTheirAxesHaveNoDirection) {
  const Matrix Z = Eigen::Vector3d(100.0, 101.0, 200.0).asDiagonal();
  const EllipsoidFinding found = ellipsoid(Z, 0.02);
  EXPECT_LT(found.principal[0].half_angle95, 0.3);
  EXPECT_EQ(found.principal[1].half_angle95, 0.5 * std::numbers::pi);
  EXPECT_EQ(found.principal[2].half_angle95, 0.5 * std::numbers::pi);
  EXPECT_LE(found.principal[1].value95.first, 100.5);
  EXPECT_GE(found.principal[2].value95.second, 100.5);
}

TEST(Ellipsoids, IntervalsOfEqualValuesContainThemToo) {
  numeric::Random random(7);
  constexpr int kDraws = 2000;
  constexpr double kError = 2.0;
  for (const Eigen::Vector3d& truth : {Eigen::Vector3d(100.0, 100.0, 100.0), Eigen::Vector3d(200.0, 100.0, 100.0),
                                       Eigen::Vector3d(200.0, 200.0, 100.0)}) {
    std::array<int, 3> held{};
    int shape = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      Matrix Z = truth.asDiagonal();
      for (double& value : Z.reshaped()) value += kError * random.normal();
      const EllipsoidFinding found = ellipsoid_finding(Z, kError * kError * Matrix::Identity(9, 9));
      for (Index k = 0; k < 3; ++k) {
        const auto [low, high] = found.principal[static_cast<std::size_t>(k)].value95;
        held[static_cast<std::size_t>(k)] += truth[k] >= low && truth[k] <= high ? 1 : 0;
      }
      shape += truth[0] / truth[2] >= found.shape95.first && truth[0] / truth[2] <= found.shape95.second ? 1 : 0;
    }
    for (const int one : held) EXPECT_GE(one, 0.93 * kDraws) << truth.transpose();
    EXPECT_GE(shape, 0.93 * kDraws) << truth.transpose();
  }
}

TEST(Ellipsoids, WithoutACovarianceHaveNoIntervals) {
  const Matrix none = Matrix::Constant(9, 9, std::nan(""));
  const EllipsoidFinding found = ellipsoid_finding(kInSpace, none);
  EXPECT_TRUE(std::isnan(found.principal[0].value95.first));
  EXPECT_TRUE(std::isnan(found.volume95.first));
  EXPECT_TRUE(std::isnan(found.principal[0].half_angle95));
  const CirculationFinding about = circulation_finding(kInSpace, none);
  EXPECT_TRUE(std::isnan(about.vector95[0].first));
  EXPECT_TRUE(std::isnan(about.size95.first));
}

TEST(Ellipsoids, OfAnIndefiniteMatrixThereIsNone) {
  const EllipsoidFinding found = ellipsoid(Eigen::Vector3d(100.0, 50.0, -3.0).asDiagonal(), 0.001);
  EXPECT_FALSE(found.closed);
  EXPECT_TRUE(std::isnan(found.volume));
  EXPECT_EQ(found.principal[2].value, -3.0);
  EXPECT_FALSE(ellipsoid(Eigen::Vector3d(100.0, 50.0, 0.1).asDiagonal(), 0.01).closed);  // nor of one that may be
}

TEST(Ellipsoids, OfAPlaneAreTheEllipseOfThePlane) {
  Matrix Z = Matrix::Zero(3, 3);
  Z.topLeftCorner(2, 2) << 42.4, -20.9, -36.3, 125.3;
  Z(2, 2) = 1000.0;
  const EllipsoidFinding found = ellipsoid_finding(Z, Matrix::Identity(9, 9));
  const EllipseFinding plane = ellipse_finding(Z.topLeftCorner(2, 2), Eigen::Matrix4d::Identity());
  EXPECT_NEAR(found.principal[1].value, plane.ellipse.lambda_max, 1e-10);
  EXPECT_NEAR(found.principal[1].value95.first, plane.lambda_max95.first, 1e-9);
  EXPECT_NEAR(found.principal[2].value95.second, plane.lambda_min95.second, 1e-9);
  const CirculationFinding about = circulation_finding(Z, Matrix::Identity(9, 9));
  EXPECT_NEAR(about.vector[2], -impedance::antisymmetric_part(Z.topLeftCorner(2, 2)), 1e-12);
  EXPECT_TRUE(about.significant);
  EXPECT_FALSE(circulation_finding(Z, 100.0 * Matrix::Identity(9, 9)).significant);
}

}  // namespace ellipses_test
}  // namespace mbk::analyse
