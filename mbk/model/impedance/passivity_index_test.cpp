#include "mbk/model/impedance/passivity_index.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::impedance {
namespace {

constexpr double kPi = std::numbers::pi;

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

Matrix matrix(double xx, double xy, double yx, double yy) {
  return (Matrix(2, 2) << xx, xy, yx, yy).finished();
}

/// M near 1 kg, B near 10 N·s/m and K near 100 N/m, with antisymmetric parts; definite or not.
Model random_model(std::mt19937& random, Index axes = 2) {
  const auto part = [&](double size) {
    Matrix Z(axes, axes);
    for (double& z : Z.reshaped()) z = size * uniform(random, -1.0, 1.0);
    return Matrix(Z + size * uniform(random, 0.0, 1.5) * Matrix::Identity(axes, axes));
  };
  return {part(1.0), part(10.0), part(100.0), Vector::Zero(axes)};
}

/// P1 of table 3.3 of Dyck 2013, symmetric parts rebuilt, with antisymmetric stiffness k_a.
Model participant1(double k_a) {
  return {matrix(1.326, -0.935, -0.935, 1.883), matrix(5.76, -2.14, -2.14, 10.56),
          matrix(42.4, -28.6 + k_a, -28.6 - k_a, 125.3), Vector::Zero(2)};
}

/// ½ λ_min(Z(jω) + Zᴴ(jω)), by the complex eigenvalue problem.
double slow_index(const Model& model, double omega) {
  const std::complex<double> s(0.0, omega);
  const Eigen::MatrixXcd Z = s * model.M + model.B + model.K / s;
  return 0.5 * numeric::hermitian_eigenvalues(Z + Z.adjoint()).minCoeff();
}

double largest_number(const Model& model, double omega) {
  return omega * model.M.cwiseAbs().maxCoeff() + model.B.cwiseAbs().maxCoeff() + model.K.cwiseAbs().maxCoeff() / omega;
}

TEST(PassivityIndex, IsTheSmallestEigenvalueOfTheHermitianPart) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Model model = random_model(random, i < 500 ? 2 : 3);
    const double omega = std::pow(10.0, uniform(random, -1.0, 2.0));
    EXPECT_NEAR(passivity_index(model, omega).value, slow_index(model, omega), 1e-13 * largest_number(model, omega))
        << "model " << i;
  }
}

TEST(PassivityIndex, OfOneAxisIsItsDampingAtEveryFrequency) {
  const Model model = unstacked((Vector(4) << 0.4, -1.5, 20.0, 0.0).finished(), 1);
  for (const double omega : {0.1, 1.0, 50.0}) {
    EXPECT_EQ(passivity_index(model, omega).value, -1.5);
    EXPECT_EQ(antisymmetry_margin(model, omega, 1).value, -1.5);
  }
  EXPECT_EQ(passivity_index(model, 1.0).gradient, (Eigen::RowVectorXd(4) << 0.0, 1.0, 0.0, 0.0).finished());
}

TEST(PassivityIndex, IsSmallestAtAnEndOfAnyBand) {
  std::mt19937 random(2);
  for (int i = 0; i < 400; ++i) {
    const Model model = random_model(random, i < 200 ? 2 : 3);
    const double low = uniform(random, 0.2, 5.0), high = low * uniform(random, 1.5, 30.0);
    const double ends = std::min(passivity_index(model, low).value, passivity_index(model, high).value);
    for (int k = 1; k < 50; ++k) {
      const double omega = low * std::pow(high / low, k / 50.0);
      EXPECT_GE(passivity_index(model, omega).value, ends - 1e-12 * largest_number(model, low));
    }
  }
}

TEST(PassivityIndex, OfP1WithItsAntisymmetryIsNegativeAtLowFrequencies) {
  const Model model = participant1(7.7);
  const auto at = [&](double hertz) { return passivity_index(model, 2.0 * kPi * hertz).value; };
  EXPECT_NEAR(at(0.1), -4.5, 0.05);  // as they are printed in one decimal
  EXPECT_NEAR(at(0.2), 1.2, 0.05);
  EXPECT_NEAR(at(1.0), 4.7, 0.05);
  const double crossing = nonpassive_below(model).value();
  EXPECT_NEAR(crossing, 0.16, 0.005);
  EXPECT_NEAR(at(crossing), 0.0, 1e-12);
  EXPECT_NEAR(nonpassive_below(participant1(-7.7)).value(), crossing, 1e-15);
}

TEST(NonpassiveBelow, IsAbsentWhereDampingIsNotDefinite) {
  Model model = participant1(7.7);
  model.B = matrix(1.0, 2.0, 2.0, 1.0);
  EXPECT_FALSE(nonpassive_below(model).has_value());
  model.B = matrix(-1.0, 0.0, 0.0, -1.0);  // determinant 1, but negative definite
  EXPECT_FALSE(nonpassive_below(model).has_value());
  EXPECT_EQ(nonpassive_below(participant1(0.0)).value(), 0.0);
}

TEST(AntisymmetryMargins, ArePositiveExactlyWhereTheIndexIs) {
  std::mt19937 random(3);
  int positive = 0, negative = 0;
  for (int i = 0; i < 6000; ++i) {
    Model model = random_model(random, i < 2000 ? 2 : 3);
    if (i >= 2000) model.B += 8.0 * Matrix::Identity(3, 3);
    if (smallest_eigenvalue(model, 1).value <= 0.0) continue;
    const double omega = std::pow(10.0, uniform(random, -0.5, 1.5));
    const double index = passivity_index(model, omega).value;
    if (std::abs(index) < 1e-10 * largest_number(model, omega)) continue;  // rounding decides
    const bool both =
        antisymmetry_margin(model, omega, 1).value > 0.0 && antisymmetry_margin(model, omega, -1).value > 0.0;
    EXPECT_EQ(both, index > 0.0) << "model " << i;
    ++(index > 0.0 ? positive : negative);
  }
  EXPECT_GT(positive, 50);
  EXPECT_GT(negative, 50);
}

TEST(AntisymmetryMargin, IsNoNumberWhereTheDeterminantIsNotPositive) {
  Model model = participant1(7.7);
  for (const Matrix& B : {matrix(1.0, 2.0, 2.0, 1.0), matrix(1.0, 1.0, 1.0, 1.0), matrix(0.0, 0.0, 0.0, 0.0)}) {
    model.B = B;
    const Sensitive margin = antisymmetry_margin(model, 1.0, 1);
    EXPECT_TRUE(std::isnan(margin.value));
    EXPECT_TRUE(margin.gradient.array().isNaN().all());
    EXPECT_EQ(margin.gradient.size(), 14);
  }
}

struct Case {
  const char* name;
  std::function<Sensitive(const Model&)> quantity;
};

TEST(PassivityInSpace, OfAPlanarLimbIsThatOfThePlane) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const Model plane = random_model(random);
    if (smallest_eigenvalue(plane, 1).value <= 0.0) continue;
    const double own = uniform(random, 20.0, 40.0);  // damping of the third axis
    Model space{Matrix::Identity(3, 3), own * Matrix::Identity(3, 3), Matrix::Identity(3, 3), Vector::Zero(3)};
    for (const int k : {0, 1, 2}) const_cast<Matrix&>(matrix_of(space, k)).topLeftCorner(2, 2) = matrix_of(plane, k);
    const double omega = std::pow(10.0, uniform(random, -0.5, 1.5));
    EXPECT_NEAR(passivity_index(space, omega).value, std::min(own, passivity_index(plane, omega).value), 1e-10);
    const double margin =
        std::min(antisymmetry_margin(plane, omega, 1).value, antisymmetry_margin(plane, omega, -1).value);
    EXPECT_NEAR(antisymmetry_margin(space, omega, 1).value, margin, 1e-10);
    const auto inside = absorbing_in_circles(plane), outside = absorbing_in_circles(space);
    ASSERT_EQ(inside.has_value(), outside.has_value());
    if (!inside) continue;
    EXPECT_NEAR(outside->first, inside->first, 1e-9 * inside->first);
    EXPECT_NEAR(outside->second, inside->second, 1e-9 * inside->second);
  }
}

TEST(PassivityInSpace, IsTheSameInEveryFrame) {
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    const Model model = random_model(random, 3);
    const Eigen::Quaterniond turn(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0),
                                  uniform(random, -1.0, 1.0));
    const Eigen::Matrix3d R = turn.normalized().toRotationMatrix();
    const auto turned = [&](const Matrix& Z) { return Matrix(R * Z * R.transpose()); };
    const Model other{turned(model.M), turned(model.B), turned(model.K), Vector::Zero(3)};
    EXPECT_NEAR(passivity_index(other, 3.0).value, passivity_index(model, 3.0).value, 1e-9);
    if (smallest_eigenvalue(model, 1).value <= 0.0) continue;
    EXPECT_NEAR(antisymmetry_margin(other, 3.0, 1).value, antisymmetry_margin(model, 3.0, 1).value, 1e-9);
  }
}

TEST(PassivityInSpace, TheBandOfCirclesEndsWhereTheIndexIsZero) {
  std::mt19937 random(7);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    Model model = random_model(random, 3);
    model.B += 12.0 * Matrix::Identity(3, 3);
    const auto band = absorbing_in_circles(model);
    if (!band) continue;
    ++found;
    for (const double omega : {band->first, band->second}) {
      EXPECT_NEAR(passivity_index(model, omega).value, 0.0, 1e-9 * largest_number(model, omega));
    }
  }
  EXPECT_GT(found, 100);
}

class Gradient : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    All, Gradient,
    testing::Values(Case{"Inertia", [](const Model& m) { return smallest_eigenvalue(m, 0); }},
                    Case{"Damping", [](const Model& m) { return smallest_eigenvalue(m, 1); }},
                    Case{"Stiffness", [](const Model& m) { return smallest_eigenvalue(m, 2); }},
                    Case{"IndexLow", [](const Model& m) { return passivity_index(m, 0.8); }},
                    Case{"IndexHigh", [](const Model& m) { return passivity_index(m, 20.0); }},
                    Case{"MarginAbove", [](const Model& m) { return antisymmetry_margin(m, 2.0, 1); }},
                    Case{"MarginBelow", [](const Model& m) { return antisymmetry_margin(m, 2.0, -1); }},
                    Case{"Published", [](const Model& m) { return published_excess_of_passivity(m); }}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_P(Gradient, AgreesWithCentralDifferences) {
  // Steps of 1e-5 of the number err by their square times the third derivative, and by ε/1e-5 of rounding.
  constexpr double kStep = 1e-5, kTolerance = 1e-7;
  std::mt19937 random(4);
  std::array<int, 4> tried{};
  for (int i = 0; i < 180; ++i) {
    const Index axes = i < 60 ? 2 : 3;
    Model model = random_model(random, axes);
    model.B += 12.0 * Matrix::Identity(axes, axes);
    const Sensitive quantity = GetParam().quantity(model);
    ASSERT_EQ(quantity.gradient.size(), 3 * axes * axes + axes);
    // Where two eigenvalues nearly meet or a root is near 0 the derivative changes within a step.
    const bool smooth = std::ranges::all_of(std::array{0, 1, 2}, [&](int part) {
      const Vector values = numeric::symmetric_eigenvalues(symmetric_part(matrix_of(model, part)));
      const double gap = (values.tail(axes - 1) - values.head(axes - 1)).minCoeff();
      return gap > 0.1 * values.cwiseAbs().maxCoeff();
    });
    if (!smooth || !std::isfinite(quantity.value)) continue;
    ++tried[static_cast<std::size_t>(axes)];
    const Vector numbers = stacked(model);
    for (Index k = 0; k < numbers.size(); ++k) {
      const double step = kStep * std::max(1.0, std::abs(numbers[k]));
      Vector above = numbers, below = numbers;
      above[k] += step;
      below[k] -= step;
      const double slope =
          (GetParam().quantity(unstacked(above, axes)).value - GetParam().quantity(unstacked(below, axes)).value) /
          (2.0 * step);
      EXPECT_NEAR(quantity.gradient[k], slope, kTolerance * (1.0 + std::abs(slope)))
          << "model " << i << " number " << k;
    }
  }
  EXPECT_GT(tried[2], 20);
  EXPECT_GT(tried[3], 20);
}

TEST(PassivityIndex, AtItsKinkMovesWithTheMeanDamping) {
  Model model = participant1(0.0);
  model.B = 5.0 * Matrix::Identity(2, 2);
  const Sensitive index = passivity_index(model, 3.0);
  EXPECT_EQ(index.value, 5.0);
  EXPECT_EQ(index.gradient[4], 0.5);
  EXPECT_EQ(index.gradient[7], 0.5);
  EXPECT_EQ(index.gradient.norm(), std::sqrt(0.5));
}

TEST(ExcessOfPassivity, NeedsInertiaAndStiffnessToBeSemidefinite) {
  Model model = participant1(7.7);
  EXPECT_NEAR(excess_of_passivity(model).value().value, ellipse(model.B).lambda_min, 1e-14);
  EXPECT_NEAR(published_excess_of_passivity(model).value, ellipse(model.B).lambda_max / 2.0, 1e-14);
  model.K = matrix(0.0, 0.0, 0.0, 1.0);
  EXPECT_TRUE(excess_of_passivity(model).has_value());
  model.K = matrix(0.0, 0.0, 0.0, -1.0);  // meets (3.19) and (3.20)
  EXPECT_FALSE(excess_of_passivity(model).has_value());
  model = participant1(0.0);
  model.M = matrix(0.1, 0.5, 0.5, 0.1);
  EXPECT_FALSE(excess_of_passivity(model).has_value());
}

/// Area and shape of the damping ellipse as tables 3.3 and 3.5 of Dyck 2013 print them, and what table 3.6 prints.
struct Printed {
  const char* participant;
  double area, shape;  ///< rounded to 0.1
  double published;    ///< table 3.6, rounded to 0.1
  double corrected;    ///< λ_min(B_s)
};

constexpr std::array kPrinted = {
    Printed{"P1", 176.8, 2.3, 5.7, 4.95},        Printed{"P2", 144.3, 2.4, 5.3, 4.37},
    Printed{"P3", 162.9, 2.9, 6.1, 4.23},        Printed{"P4", 111.3, 3.5, 5.6, 3.18},
    Printed{"P5", 159.8, 3.2, 6.3, 3.99},        Printed{"P6", 76.2, 3.0, 4.3, 2.84},
    Printed{"P1 pulses", 385.7, 1.7, 7.2, 8.50}, Printed{"P4 pulses", 165.0, 3.1, 6.4, 4.12},
};
constexpr double kHalfDigit = 0.05;

double larger(double area, double shape) {
  return std::sqrt(area * shape / kPi);
}
double smaller(double area, double shape) {
  return std::sqrt(area / (kPi * shape));
}

/// A damping with these eigenvalues, turned.
Model damped(double largest, double smallest) {
  const double c = std::cos(0.6), s = std::sin(0.6);
  const Matrix turn = matrix(c, -s, s, c);
  Model model = participant1(0.0);
  model.B = turn * matrix(largest, 0.0, 0.0, smallest) * turn.transpose();
  return model;
}

TEST(Table36, HasHalfOfTheLargestEigenvalueInEveryCell) {
  for (const Printed& one : kPrinted) {
    SCOPED_TRACE(one.participant);
    const auto excess = [&](double area, double shape) {
      return published_excess_of_passivity(damped(larger(area, shape), smaller(area, shape))).value;
    };
    // Rising in both. Every printed cell's own rounding is allowed too.
    EXPECT_LE(excess(one.area - kHalfDigit, one.shape - kHalfDigit), one.published + kHalfDigit);
    EXPECT_GE(excess(one.area + kHalfDigit, one.shape + kHalfDigit), one.published - kHalfDigit);
  }
}

TEST(Table36, IsNotTheExcessOfPassivityInAnyCell) {
  for (const Printed& one : kPrinted) {
    SCOPED_TRACE(one.participant);
    const auto excess = [&](double area, double shape) {
      return excess_of_passivity(damped(larger(area, shape), smaller(area, shape))).value().value;
    };
    EXPECT_NEAR(excess(one.area, one.shape), one.corrected, 0.005 + 1e-9);
    // Rising in the area, falling in the shape.
    const double least = excess(one.area - kHalfDigit, one.shape + kHalfDigit);
    const double most = excess(one.area + kHalfDigit, one.shape - kHalfDigit);
    EXPECT_TRUE(most < one.published - kHalfDigit || least > one.published + kHalfDigit) << least << " … " << most;
  }
  const Printed& pulses = kPrinted[6];
  EXPECT_NEAR(smaller(pulses.area - kHalfDigit, pulses.shape + kHalfDigit), 8.38, 0.01);
  EXPECT_NEAR(smaller(pulses.area + kHalfDigit, pulses.shape - kHalfDigit), 8.63, 0.01);
}

TEST(AbsorbingInCircles, EndsWhereTheIndexIsZero) {
  std::mt19937 random(7);
  int bounded = 0, none = 0;
  for (int i = 0; i < 400; ++i) {
    Model model = participant1(uniform(random, -20.0, 20.0));
    const double m_a = i % 4 == 0 ? 0.0 : uniform(random, -1.5, 1.5);
    model.M(0, 1) += m_a;
    model.M(1, 0) -= m_a;
    const auto range = absorbing_in_circles(model);
    if (!range) {  // nowhere positive
      ++none;
      for (double omega = 0.01; omega < 1000.0; omega *= 1.1) EXPECT_LT(passivity_index(model, omega).value, 1e-9);
      continue;
    }
    EXPECT_NEAR(passivity_index(model, range->first).value, 0.0, 1e-9);
    EXPECT_GT(passivity_index(model, 1.001 * range->first).value, 0.0);
    if (m_a == 0.0) {
      EXPECT_TRUE(std::isinf(range->second));
      EXPECT_NEAR(range->first, 2.0 * kPi * nonpassive_below(model).value(), 1e-12);
      continue;
    }
    ++bounded;
    EXPECT_NEAR(passivity_index(model, range->second).value, 0.0, 1e-9);
    EXPECT_GT(passivity_index(model, 0.999 * range->second).value, 0.0);
  }
  EXPECT_GT(bounded, 100);
  EXPECT_GT(none, 3);
  EXPECT_FALSE(absorbing_in_circles(unstacked((Vector(4) << 0.4, 1.5, 20.0, 0.0).finished(), 1)));
}

}  // namespace
}  // namespace mbk::impedance
