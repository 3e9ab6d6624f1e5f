#include "mbk/model/impedance/impedance_width.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::impedance {
namespace impedance_width_test {

constexpr double kRounding = 1e-11;  ///< of distances near one, from matrices with a condition up to about 100

class Random {
 public:
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  Matrix matrix(Index n) {
    return Matrix(n, n).unaryExpr([&](double /*none*/) { return (*this)(-1.0, 1.0); });
  }
  /// With a curl, which the distance must not see.
  Matrix impedance(Index n) {
    const Matrix root = matrix(n);
    const Matrix some = matrix(n);
    return root * root.transpose() + 0.1 * Matrix::Identity(n, n) + 0.5 * (some - some.transpose());
  }

 private:
  std::mt19937 random_{1};
};

const Matrix kRelaxed = (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished();  // P1 [N/m], k_a = 7.7

double distance(const Matrix& A, const Matrix& B) {
  return impedance_width(A, B).value().distance;
}

TEST(ImpedanceWidth, OfSevenfoldStiffnessIsRootTwoTimesItsLogarithm) {
  const Width width = impedance_width(kRelaxed, 7.0 * kRelaxed).value();
  EXPECT_NEAR(width.distance, std::sqrt(2.0) * std::log(7.0), kRounding);
  EXPECT_NEAR(width.distance, 2.752, 0.0005);
  EXPECT_NEAR(width.ratios[0], 7.0, kRounding);
  EXPECT_NEAR(width.ratios[1], 7.0, kRounding);
}

TEST(ImpedanceWidth, OfOneAxisIsTheLogarithmOfTheRatio) {
  const Matrix one = Matrix::Constant(1, 1, 30.0), other = Matrix::Constant(1, 1, 12.0);
  EXPECT_NEAR(distance(one, other), std::log(2.5), kRounding);
  EXPECT_NEAR(impedance_width(one, other)->ratios[0], 0.4, kRounding);
}

TEST(ImpedanceWidth, OfDiagonalMatricesIsThatOfTheirRatiosAlongTheAxes) {
  const Matrix A = Eigen::Vector2d(2.0, 5.0).asDiagonal(), B = Eigen::Vector2d(6.0, 4.0).asDiagonal();
  const Width width = impedance_width(A, B).value();
  EXPECT_NEAR(width.distance, std::hypot(std::log(3.0), std::log(0.8)), kRounding);
  EXPECT_NEAR(width.ratios[0], 0.8, kRounding);
  EXPECT_NEAR(width.ratios[1], 3.0, kRounding);
  EXPECT_NEAR(std::abs(width.directions(1, 0)), 1.0, kRounding);
  EXPECT_NEAR(std::abs(width.directions(0, 1)), 1.0, kRounding);
}

/// The same by the matrix logarithm of A^(−1/2) B A^(−1/2).
TEST(ImpedanceWidth, AgreesWithTheMatrixLogarithm) {
  Random random;
  for (int trial = 0; trial < 50; ++trial) {
    const Matrix A = symmetric_part(random.impedance(2)), B = symmetric_part(random.impedance(2));
    const auto [values, vectors] = numeric::symmetric_eigen(A);
    const Matrix root = vectors * values.cwiseSqrt().cwiseInverse().asDiagonal() * vectors.transpose();
    const Vector lambda = numeric::symmetric_eigenvalues(root * B * root);
    EXPECT_NEAR(distance(A, B), lambda.array().log().matrix().norm(), kRounding) << "trial " << trial;
  }
}

TEST(ImpedanceWidth, IsAMetric) {
  Random random;
  for (const Index n : {1, 2}) {
    for (int trial = 0; trial < 200; ++trial) {
      const Matrix A = random.impedance(n), B = random.impedance(n), C = random.impedance(n);
      EXPECT_NEAR(distance(A, B), distance(B, A), kRounding) << "trial " << trial;
      EXPECT_LT(distance(A, A), kRounding);
      EXPECT_GT(distance(A, B), 1e-6);
      EXPECT_LE(distance(A, C), distance(A, B) + distance(B, C) + kRounding) << "trial " << trial;
    }
  }
}

TEST(ImpedanceWidth, IsTheSameInEveryBasisAndOfInverses) {
  Random random;
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix A = random.impedance(2), B = random.impedance(2);
    Matrix J = random.matrix(2);
    J.diagonal().array() += 2.0;  // regular: its determinant is above zero
    const Matrix A_q = J.transpose() * A * J, B_q = J.transpose() * B * J;
    EXPECT_NEAR(distance(A_q, B_q), distance(A, B), kRounding) << "trial " << trial;
    const Matrix A_s = symmetric_part(A), B_s = symmetric_part(B);
    EXPECT_NEAR(distance(numeric::inverse(A_s), numeric::inverse(B_s)), distance(A, B), kRounding) << "trial " << trial;
  }
}

TEST(ImpedanceWidth, GradientsAgreeWithFiniteDifferences) {
  Random random;
  const double step = 1e-6, kTruncation = 1e-7;
  for (const Index n : {1, 2}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Matrix A = random.impedance(n) + Matrix::Identity(n, n), B = random.impedance(n) + Matrix::Identity(n, n);
      const Width width = impedance_width(A, B).value();
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j < n; ++j) {
          Matrix change = Matrix::Zero(n, n);
          change(i, j) = step;
          const Width up = impedance_width(A + change, B).value(), down = impedance_width(A - change, B).value();
          const Width more = impedance_width(A, B + change).value(), less = impedance_width(A, B - change).value();
          const Index k = n * i + j;
          EXPECT_NEAR(width.by_first[k], (up.distance - down.distance) / (2.0 * step), kTruncation);
          EXPECT_NEAR(width.by_second[k], (more.distance - less.distance) / (2.0 * step), kTruncation);
          for (Index r = 0; r < n; ++r) {
            EXPECT_NEAR(width.ratios_by_first(r, k), std::log(up.ratios[r] / down.ratios[r]) / (2.0 * step),
                        10.0 * kTruncation);
            EXPECT_NEAR(width.ratios_by_second(r, k), std::log(more.ratios[r] / less.ratios[r]) / (2.0 * step),
                        10.0 * kTruncation);
          }
        }
      }
    }
  }
}

TEST(ImpedanceWidth, RefusesWhatIsNotPositiveDefiniteAndSaysWhich) {
  const Matrix indefinite = (Matrix(2, 2) << 1.0, 3.0, 3.0, 1.0).finished();
  const Matrix singular = (Matrix(2, 2) << 1.0, 1.0, 1.0, 1.0).finished();
  const std::string first = impedance_width(indefinite, kRelaxed).error().message;
  EXPECT_NE(first.find("first"), std::string::npos) << first;
  EXPECT_NE(first.find("-2"), std::string::npos) << first;
  const std::string second = impedance_width(kRelaxed, indefinite).error().message;
  EXPECT_NE(second.find("second"), std::string::npos) << second;
  EXPECT_NE(second.find("-2"), std::string::npos) << second;
  EXPECT_FALSE(impedance_width(kRelaxed, singular));
  EXPECT_FALSE(impedance_width(-kRelaxed, -kRelaxed));
  EXPECT_FALSE(impedance_width(Matrix::Zero(2, 2), kRelaxed));
  const Matrix unknown = Matrix::Constant(2, 2, std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(impedance_width(kRelaxed, unknown).error().message.find("second"), std::string::npos);
  EXPECT_FALSE(impedance_width(kRelaxed, Matrix::Identity(1, 1)));
}

}  // namespace impedance_width_test
}  // namespace mbk::impedance
