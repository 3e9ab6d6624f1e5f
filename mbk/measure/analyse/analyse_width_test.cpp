#include "mbk/measure/analyse/analyse_width.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/impedance_width.h"

namespace mbk::analyse {
namespace analyse_width_test {

constexpr double kZ95 = 1.959963984540054;

/// The first participant's relaxed arm with errors of a share of each matrix's largest number.
Identification arm(double times, double share) {
  Identification id;
  id.model.M = (Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  id.model.B = (Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  id.model.K = times * (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished();
  id.model.x0 = Vector::Zero(2);
  id.covariance = Matrix::Zero(14, 14);
  const Matrix* matrices[] = {&id.model.M, &id.model.B, &id.model.K};
  for (Index part = 0; part < 3; ++part) {
    for (Index i = 0; i < 4; ++i) {
      for (Index j = 0; j < 4; ++j) {
        id.covariance(4 * part + i, 4 * part + j) =
            std::pow(share * matrices[part]->maxCoeff(), 2) * std::pow(0.4, std::abs(static_cast<double>(i - j)));
      }
    }
  }
  return id;
}

class Draws {
 public:
  Identification operator()(const Identification& id) {
    Identification drawn = id;
    const Matrix root = numeric::Cholesky(id.covariance.topLeftCorner(12, 12)).upper().transpose();
    Vector numbers = impedance::stacked(id.model);
    numbers.head(12) += root * Vector(12).unaryExpr([&](double /*none*/) { return normal_(random_); });
    drawn.model = impedance::unstacked(numbers, 2);
    return drawn;
  }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST(AnalyseWidth, OfSevenfoldStiffnessIsItsClosedForm) {
  const WidthFindings found = analyse_width(arm(1.0, 0.02), arm(7.0, 0.02)).value();
  ASSERT_TRUE(found.complete());
  const WidthFinding& stiffness = *found.of[2];
  EXPECT_NEAR(stiffness.distance, 2.752, 0.0005);
  EXPECT_TRUE(stiffness.distinguishable);
  EXPECT_LT(stiffness.distance95.first, 2.752);
  EXPECT_GT(stiffness.distance95.second, 2.752);
  EXPECT_NEAR(stiffness.ratios.at(0).ratio, 7.0, 1e-9);
  EXPECT_NEAR(found.of[0]->distance, 0.0, 1e-9);
  EXPECT_FALSE(found.of[0]->distinguishable);
  EXPECT_EQ(found.of[0]->distance95.first, 0.0);
}

TEST(AnalyseWidth, IntervalsHoldTheDistanceAsOftenAsTheySay) {
  Identification second = arm(3.0, 0.03);
  second.model.K(0, 0) *= 1.6;
  const Identification first = arm(1.0, 0.03);
  const double truth = impedance::impedance_width(first.model.K, second.model.K)->distance;
  Draws draw;
  constexpr int kTrials = 2000;
  int held = 0, held_most = 0;
  const double most = impedance::impedance_width(first.model.K, second.model.K)->ratios[1];
  for (int trial = 0; trial < kTrials; ++trial) {
    const WidthFinding one = *analyse_width(draw(first), draw(second))->of[2];
    held += one.distance95.first <= truth && truth <= one.distance95.second ? 1 : 0;
    held_most += one.ratios[1].ratio95.first <= most && most <= one.ratios[1].ratio95.second ? 1 : 0;
  }
  // 2000 trials give 95 % to 0.5 % (one standard deviation); the delta method itself errs by about 1 % here
  EXPECT_NEAR(held / static_cast<double>(kTrials), 0.95, 0.025);
  EXPECT_NEAR(held_most / static_cast<double>(kTrials), 0.95, 0.025);
}

TEST(AnalyseWidth, TellsTwoMeasurementsOfOneArmApartInFiveOfAHundredCases) {
  const Identification one = arm(1.0, 0.03);
  Draws draw;
  constexpr int kTrials = 4000;
  int told = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const WidthFindings found = analyse_width(draw(one), draw(one)).value();
    for (const auto& finding : found.of) told += finding->distinguishable ? 1 : 0;
  }
  EXPECT_NEAR(told / (3.0 * kTrials), 0.05, 0.008);  // four standard deviations of 12,000 tests
}

TEST(AnalyseWidth, SaysWhichMatrixHasNoneAndWhy) {
  Identification indefinite = arm(1.0, 0.02);
  indefinite.model.M(0, 0) = 0.1;
  const WidthFindings found = analyse_width(arm(1.0, 0.02), indefinite).value();
  EXPECT_FALSE(found.complete());
  EXPECT_FALSE(found.of[0]);
  EXPECT_NE(found.refused[0].find("second"), std::string::npos) << found.refused[0];
  EXPECT_TRUE(found.of[1]);
  EXPECT_TRUE(found.of[2]);
}

TEST(AnalyseWidth, SaysWhereAnEigenvalueIsNotSurelyPositive) {
  EXPECT_TRUE(analyse_width(arm(1.0, 0.02), arm(2.0, 0.02))->of[2]->surely_positive);
  EXPECT_FALSE(analyse_width(arm(1.0, 0.02), arm(2.0, 0.5))->of[2]->surely_positive);
}

TEST(AnalyseWidth, NamesTheDirectionsOfLeastAndMost) {
  Identification first = arm(1.0, 0.01), second = arm(1.0, 0.01);
  first.model.K = Eigen::Vector2d(100.0, 50.0).asDiagonal();
  second.model.K = Eigen::Vector2d(150.0, 300.0).asDiagonal();
  const WidthFinding found = *analyse_width(first, second)->of[2];
  ASSERT_EQ(found.ratios.size(), 2U);
  EXPECT_NEAR(found.ratios[0].ratio, 1.5, 1e-12);
  EXPECT_NEAR(std::sin(found.ratios[0].direction), 0.0, 1e-12);
  EXPECT_NEAR(found.ratios[1].ratio, 6.0, 1e-12);
  EXPECT_NEAR(found.ratios[1].direction, std::numbers::pi / 2.0, 1e-12);
}

TEST(AnalyseWidth, OfOneAxisIsThatOfItsNumbers) {
  const auto joint = [](double k) {
    Identification id;
    id.axes = 1;
    id.motion = Motion::rotation;
    id.model = {Matrix::Constant(1, 1, 0.02), Matrix::Constant(1, 1, 1.0), Matrix::Constant(1, 1, k), Vector::Zero(1)};
    id.covariance = Vector(Eigen::Vector4d(1e-8, 1e-4, 0.25, 1e-6)).asDiagonal();
    return id;
  };
  const WidthFinding found = *analyse_width(joint(10.0), joint(30.0))->of[2];
  EXPECT_NEAR(found.distance, std::log(3.0), 1e-12);
  // d ln k = dk/k of both: √((0.5/10)² + (0.5/30)²)
  EXPECT_NEAR(found.distance95.second - found.distance, kZ95 * std::hypot(0.05, 0.5 / 30.0), 1e-12);
  EXPECT_TRUE(found.distinguishable);
  Identification hand = joint(10.0);
  hand.motion = Motion::translation;
  EXPECT_NE(analyse_width(joint(10.0), hand).error().message.find("kg·m²"), std::string::npos);
  EXPECT_FALSE(analyse_width(joint(10.0), arm(1.0, 0.1)));
}

TEST(AnalyseWidth, WithoutACovarianceHasNoInterval) {
  Identification id = arm(2.0, 0.02);
  id.covariance.setConstant(std::nan(""));
  const WidthFinding found = *analyse_width(arm(1.0, 0.02), id)->of[2];
  EXPECT_NEAR(found.distance, std::sqrt(2.0) * std::log(2.0), 1e-12);
  EXPECT_TRUE(std::isnan(found.distance95.second));
  EXPECT_FALSE(found.distinguishable);
  EXPECT_FALSE(found.surely_positive);
}

}  // namespace analyse_width_test
}  // namespace mbk::analyse
