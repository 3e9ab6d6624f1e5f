#include "mbk/base/lti/rational_passivity_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/lti/positive_real.h"
#include "mbk/base/lti/test_polynomials.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::lti {
namespace rational_passivity_index_test {

using numeric::Random;
using testing::HasSubstr;

constexpr double kProven = 3e-10;      // three widths of the proven bounds, for values near 1
constexpr double kPublished = 5.1e-5;  // four printed decimals

RationalMatrix siso(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  return RationalMatrix(*RationalFunction::from_decimals(numerator, denominator));
}

void expect_index(const Result<PassivityIndex>& index, double value, double tolerance = kProven) {
  ASSERT_TRUE(index) << index.error().line();
  EXPECT_NEAR(index->value, value, tolerance);
  EXPECT_LE(index->at_least, index->value);
  EXPECT_GE(index->at_most, index->value);
}

TEST(PassivityIndices, HaveThePublishedValues) {
  const RationalMatrix G = siso({0.1, 5, 1, 1}, {4, 3, 2, 1});
  expect_index(relative_passivity_index(G), 0.9512, kPublished);
  expect_index(input_passivity_index(G), 0.025, kProven);
  expect_index(output_passivity_index(G), 0.2583, kPublished);
  expect_index(relative_passivity_index(siso({1, 1}, {2, 1})), 1.0 / 3.0);
}

TEST(PassivityIndices, OfTheCircuitInMatlabsExampleAgree) {
  // (s + 2)(2 s + 10)/(s² + 4 s + 10)
  const RationalMatrix G = siso({20, 14, 2}, {10, 4, 1});
  expect_index(input_passivity_index(G), 2.0);
  expect_index(output_passivity_index(G), 0.2857, kPublished);
}

TEST(PassivityIndices, OfAGainHaveTheirClosedForms) {
  for (const double gain : {0.25, 1.0, 3.0, -0.5, -3.0}) {
    const RationalMatrix G = siso({gain}, {1});
    expect_index(input_passivity_index(G), gain, kProven * std::abs(gain));
    expect_index(output_passivity_index(G), 1.0 / gain, kProven / std::abs(gain));
    expect_index(relative_passivity_index(G), std::abs(1.0 - gain) / std::abs(1.0 + gain), 1e-9);
  }
}

TEST(PassivityIndices, OfALagAreReachedAtInfinity) {
  const RationalMatrix G = siso({1}, {1, 1});
  const auto input = input_passivity_index(G);
  expect_index(input, 0.0);
  EXPECT_TRUE(std::isinf(input->frequency.value));
  expect_index(output_passivity_index(G), 1.0);  // of s + 1, improper
  expect_index(relative_passivity_index(G), 1.0);
}

TEST(InputPassivityIndex, OfAnImpedanceIsTheLeastDamping) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Index n = 1 + trial % 3;
    const auto symmetric = [&](double offset) {
      Matrix L(n, n);
      for (double& value : L.reshaped()) value = static_cast<double>(random.below(17)) / 8.0 - 1.0;
      return Matrix(L * L.transpose() + offset * Matrix::Identity(n, n));
    };
    Matrix B = symmetric(-1.5);
    const double least = numeric::symmetric_eigenvalues(B)[0];
    if (n > 1) {
      B(0, 1) += 2.5;
      B(1, 0) -= 2.5;
    }
    const auto Z = RationalMatrix::impedance(symmetric(0.5), B, symmetric(0.5));
    expect_index(input_passivity_index(*Z), least, 1e-9);
  }
}

TEST(InputPassivityIndex, OfALosslessMatrixIsZero) {
  expect_index(input_passivity_index(siso({5, 0, 2}, {0, 1})), 0.0);
  expect_index(input_passivity_index(siso({0, 1}, {4, 0, 1})), 0.0);
}

TEST(InputPassivityIndex, FindsANarrowResonanceThatAGridMisses) {
  // 1 − 1.01 (s/50)/(s² + s/50 + 100): 1 − 1.01 at 10 rad/s
  const auto index = input_passivity_index(siso({100, 0.02 - 1.01 * 0.02, 1}, {100, 0.02, 1}));
  expect_index(index, -0.01);
  EXPECT_NEAR(index->frequency.value, 10.0, 1e-4);  // flat to the second order within the proven width
  const auto sharp = input_passivity_index(siso({100, 1e-9 - 1.01e-9, 1}, {100, 1e-9, 1}));
  expect_index(sharp, -0.01);
}

TEST(RelativePassivityIndex, IsOneAtMostIfAndOnlyIfTheMatrixIsPositiveReal) {
  Random random(3);
  int passive = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const RationalMatrix G = RationalMatrix(*RationalFunction::of(
        Polynomial{static_cast<int>(random.below(6)), static_cast<int>(random.below(6)), 1},
        Polynomial{1 + static_cast<int>(random.below(6)), 1 + static_cast<int>(random.below(6)), 1}));
    const auto R = relative_passivity_index(G);
    ASSERT_TRUE(R);
    const bool positive = positive_real(G)->holds();
    passive += positive ? 1 : 0;
    if (positive) {
      EXPECT_LE(R->at_least, 1.0);
    } else {
      EXPECT_GT(R->at_most, 1.0);
    }
  }
  EXPECT_GT(passive, 5);
  EXPECT_LT(passive, 35);
}

/// Stable, of n ports, with a share of the identity.
RationalMatrix random_stable(Random& random, Index n) {
  RationalMatrix G(n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const Polynomial stable{1 + static_cast<int>(random.below(9)), Rational(1 + static_cast<int>(random.below(4)), 4),
                              1};
      G(i, j) = *RationalFunction::of(random_polynomial(random, 1), stable);
      if (i == j) G(i, j) = G(i, j) + RationalFunction(Polynomial{static_cast<int>(random.below(20))});
    }
  }
  return G;
}

double min_hermitian(const Eigen::MatrixXcd& value) {
  return numeric::hermitian_eigenvalues(0.5 * (value + value.adjoint()))[0];
}

double input_at(const Eigen::MatrixXcd& G) {
  return min_hermitian(G);
}

double output_at(const Eigen::MatrixXcd& G) {
  return min_hermitian(numeric::complex_inverse(G));
}

double minus_relative_at(const Eigen::MatrixXcd& G) {
  const Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(G.rows(), G.cols());
  const Eigen::MatrixXcd S = (one - G) * numeric::complex_inverse(one + G);
  return -std::sqrt(numeric::hermitian_eigenvalues(S.adjoint() * S).maxCoeff());
}

/// The index is the value at its frequency, and a grid over eight decades has no lower one.
void expect_lowest(const RationalMatrix& G, double index, RadPerSec frequency,
                   double (*value_at)(const Eigen::MatrixXcd&)) {
  const double tolerance = 1e-6 * (1.0 + std::abs(index));  // of evaluation in double, beside limits and cancellation
  EXPECT_NEAR(value_at(G(RadPerSec(std::clamp(frequency.value, 1e-7, 1e7)))), index, tolerance);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_GE(value_at(G(RadPerSec(std::pow(10.0, -4 + 8 * i / 999.0)))), index - tolerance);
  }
}

TEST(PassivityIndices, AreAttainedAndNowhereLowerOnADenseGrid) {
  Random random(5);
  int found = 0;
  for (int trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE(trial);
    const RationalMatrix G = random_stable(random, 1 + trial % 2);
    const auto input = input_passivity_index(G), output = output_passivity_index(G);
    const auto relative = relative_passivity_index(G);
    ASSERT_TRUE(input) << input.error().line();
    expect_lowest(G, input->value, input->frequency, input_at);
    if (output) expect_lowest(G, output->value, output->frequency, output_at);
    if (relative) expect_lowest(G, -relative->value, relative->frequency, minus_relative_at);
    found += (output ? 1 : 0) + (relative ? 1 : 0);
  }
  EXPECT_GT(found, 5);
}

void expect_none(const Result<PassivityIndex>& index, const std::string& why) {
  ASSERT_FALSE(index);
  EXPECT_EQ(index.error().kind, ErrorKind::not_usable);
  EXPECT_THAT(index.error().line(), HasSubstr(why));
}

TEST(PassivityIndices, ThatDoNotExistSayWhy) {
  expect_none(input_passivity_index(siso({1}, {-1, 1})), "real part");
  expect_none(input_passivity_index(siso({0, 0, 1}, {1})), "inf rad/s");
  expect_none(input_passivity_index(siso({-1}, {0, 1})), "residues");
  expect_none(output_passivity_index(siso({-1, 1}, {1, 1})), "real part");
  expect_none(output_passivity_index(siso({0}, {1})), "inverse");
  expect_none(relative_passivity_index(siso({-1}, {1})), "inverse");
  expect_none(relative_passivity_index(siso({-2}, {1, 1})), "Re s ≥ 0");     // 1 + G = (s − 1)/(s + 1)
  expect_none(relative_passivity_index(siso({1, -1}, {1, 1})), "infinite");  // 1 + G = 2/(s + 1)
  expect_none(input_passivity_index(RationalMatrix(RationalFunction(Polynomial{*exact(1e300) * *exact(1e300)}))),
              "double");
  EXPECT_EQ(input_passivity_index(RationalMatrix(Index{0})).error().kind, ErrorKind::usage);
  EXPECT_EQ(relative_passivity_index(RationalMatrix(kMaxPorts + 1)).error().kind, ErrorKind::usage);
}

TEST(RelativePassivityIndex, OfAnUnstableMatrixMayExist) {
  // (s + 5)/(s − 1): S = −6/(2s + 4)
  expect_index(relative_passivity_index(siso({5, 1}, {-1, 1})), 1.5);
}

}  // namespace rational_passivity_index_test
}  // namespace mbk::lti
