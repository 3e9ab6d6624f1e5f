#include "mbk/base/lti/positive_real.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/lti/test_polynomials.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::lti {
namespace positive_real_test {

using enum PositiveRealCondition;
using numeric::Random;
using testing::HasSubstr;

/// numerator/denominator, ascending, as decimals.
RationalMatrix siso(const std::vector<double>& numerator, const std::vector<double>& denominator) {
  return RationalMatrix(*RationalFunction::from_decimals(numerator, denominator));
}

PositiveRealness judged(const RationalMatrix& Z) {
  const auto result = positive_real(Z);
  EXPECT_TRUE(result);
  return *result;
}

PositiveRealness judged(const Matrix& M, const Matrix& B, const Matrix& K) {
  return judged(*RationalMatrix::impedance(M, B, K));
}

/// Which conditions are violated, as bits in their order.
unsigned violated(const PositiveRealness& result) {
  unsigned bits = 0;
  for (const ConditionOutcome& outcome : result.conditions) {
    if (!outcome.holds()) bits |= 1u << static_cast<unsigned>(outcome.condition);
  }
  return bits;
}

constexpr unsigned only(PositiveRealCondition condition) {
  return 1u << static_cast<unsigned>(condition);
}

/// A Gram matrix of whole numbers over 8: ⪰ 0 exactly, singular where rank < n.
Matrix gram(Random& random, Index n, Index rank) {
  Matrix L(n, rank);
  for (double& value : L.reshaped()) value = static_cast<double>(random.below(17)) - 8.0;
  return L * L.transpose() / 64.0;
}

const Matrix kNone = Matrix::Zero(2, 2);  // NOLINT: of the tests

TEST(PositiveReal, HoldsForMassDamperAndSpring) {
  EXPECT_TRUE(judged(siso({0, 2}, {1})).holds());
  EXPECT_TRUE(judged(siso({3}, {1})).holds());
  EXPECT_TRUE(judged(siso({5}, {0, 1})).holds());
  EXPECT_TRUE(judged(siso({5, 3, 2}, {0, 1})).holds());
  EXPECT_TRUE(judged(siso({0}, {1})).holds());
}

TEST(PositiveReal, NamesTheConditionThatIsViolated) {
  EXPECT_EQ(violated(judged(siso({0, -2}, {1}))), only(residues));  // −2 s
  EXPECT_EQ(violated(judged(siso({-5}, {0, 1}))), only(residues));  // −5/s
  EXPECT_EQ(violated(judged(siso({-3}, {1}))), only(hermitian_part));
  EXPECT_EQ(violated(judged(siso({0, 0, -1}, {1}))), only(simple_poles));  // −s²: Re = ω²
  EXPECT_EQ(violated(judged(siso({0, 1}, {4, 0, 1}))), 0u);                // s/(s² + 4)
  EXPECT_EQ(violated(judged(siso({0, -1}, {4, 0, 1}))), only(residues));
  EXPECT_EQ(violated(judged(siso({1}, {4, 0, 1}))), only(residues) | only(hermitian_part));  // residue −j/4
  EXPECT_EQ(violated(judged(siso({2, 1}, {-1, 1}))), only(no_right_poles) | only(hermitian_part));
  EXPECT_EQ(violated(judged(siso({-1}, {-1, 1}))), only(no_right_poles));  // 1/(1 − s): Re > 0 on the axis
  EXPECT_EQ(violated(judged(siso({0, 0, 0, 1}, {16, 0, 8, 0, 1}))), only(simple_poles));  // s³/(s² + 4)²
}

TEST(PositiveReal, SaysWhere) {
  const PositiveRealness resonance = judged(siso({0, -1}, {4, 0, 1}));
  EXPECT_DOUBLE_EQ(resonance[residues].violated.at(0).low.value, 2.0);
  const PositiveRealness spring = judged(siso({-5}, {0, 1}));
  EXPECT_EQ(spring[residues].violated.at(0).high.value, 0.0);
  EXPECT_THAT(spring[residues].line(), HasSubstr(" 0 rad/s"));
  const PositiveRealness mass = judged(siso({0, -2}, {1}));
  EXPECT_TRUE(std::isinf(mass[residues].violated.at(0).low.value));
  const PositiveRealness unstable = judged(siso({1}, {5, -2, 1}));  // poles 1 ± 2j
  ASSERT_EQ(unstable[no_right_poles].violated.size(), 1u);
  EXPECT_NEAR(unstable[no_right_poles].violated[0].low.value, 2.0, 1e-12);
  // 1/(s + 1)²: Re = (1 − ω²)/(1 + ω²)²
  const PositiveRealness lag = judged(siso({1}, {1, 2, 1}));
  ASSERT_EQ(lag[hermitian_part].violated.size(), 1u);
  EXPECT_DOUBLE_EQ(lag[hermitian_part].violated[0].low.value, 1.0);
  EXPECT_TRUE(std::isinf(lag[hermitian_part].violated[0].high.value));
  EXPECT_THAT(lag[hermitian_part].line(), HasSubstr("inf rad/s"));
  EXPECT_THAT(lag[no_right_poles].line(), testing::Not(HasSubstr("rad/s")));
}

TEST(PositiveReal, FindsTheStiffnessThatTheorem32AcceptsOnItsBoundary) {
  const Matrix K{{0, 0}, {0, -1}};
  EXPECT_EQ(violated(judged(Matrix::Identity(2, 2), Matrix::Identity(2, 2), K)), only(residues));
  EXPECT_EQ(violated(judged(K, Matrix::Identity(2, 2), kNone)), only(residues));
  EXPECT_EQ(violated(judged(kNone, K, kNone)), only(hermitian_part));
}

TEST(PositiveReal, OfAnImpedanceNeedsThreeSemidefiniteMatrices) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = 1 + trial % 3;
    const auto rank = [&] { return static_cast<Index>(random.below(static_cast<unsigned>(n) + 1)); };
    const Matrix M = gram(random, n, rank()), K = gram(random, n, rank());
    Matrix B = gram(random, n, rank());
    if (n > 1) {
      B(0, 1) += 0.75;  // gyration takes no energy
      B(1, 0) -= 0.75;
    }
    EXPECT_TRUE(judged(M, B, K).holds()) << "trial " << trial;
    // a little less than the smallest eigenvalue is too little
    const auto lowered = [](const Matrix& matrix) {
      const double smallest = numeric::symmetric_eigenvalues((matrix + matrix.transpose()) / 2)[0];
      return Matrix(matrix - (smallest + 1e-9) * Matrix::Identity(matrix.rows(), matrix.cols()));
    };
    EXPECT_EQ(violated(judged(lowered(M), B, K)), only(residues)) << "trial " << trial;
    EXPECT_EQ(violated(judged(M, B, lowered(K))), only(residues)) << "trial " << trial;
    EXPECT_EQ(violated(judged(M, lowered(B), K)), only(hermitian_part)) << "trial " << trial;
  }
}

TEST(PositiveReal, OfAnImpedanceNeedsSymmetricMassAndStiffness) {
  const Matrix two = 2.0 * Matrix::Identity(2, 2), curl{{0, 1e-6}, {-1e-6, 0}};
  EXPECT_TRUE(judged(two, two + curl, two).holds());
  const PositiveRealness stiffness = judged(two, two, two + curl);
  EXPECT_FALSE(stiffness[residues].holds());
  // k_a/ω = b: non-passive below |k_a|/b
  ASSERT_EQ(stiffness[hermitian_part].violated.size(), 1u);
  EXPECT_EQ(stiffness[hermitian_part].violated[0].low.value, 0.0);
  EXPECT_NEAR(stiffness[hermitian_part].violated[0].high.value, 1e-6 / 2.0, 1e-20);
  const PositiveRealness mass = judged(two + curl, two, two);
  EXPECT_FALSE(mass[residues].holds());
  EXPECT_NEAR(mass[hermitian_part].violated.at(0).low.value, 2e6, 1e-6);
}

TEST(PositiveReal, HasTheClosedFormFrequencyOfAnAntisymmetricArm) {
  // f₀ = |k_a|/(2π √det B_s), P1 of Dyck 2013 with k_a = 7.7 N/m
  const Matrix M{{1.326, -0.935}, {-0.935, 1.883}}, B{{5.76, -2.14}, {-2.14, 10.56}};
  const Matrix K{{42.4, -28.6 + 7.7}, {-28.6 - 7.7, 125.3}};
  const PositiveRealness arm = judged(M, B, K);
  ASSERT_EQ(arm[hermitian_part].violated.size(), 1u);
  const double closed_form = 7.7 / std::sqrt(5.76 * 10.56 - 2.14 * 2.14);
  EXPECT_NEAR(arm[hermitian_part].violated[0].high.value, closed_form, 1e-13);
  EXPECT_NEAR(Hertz(arm[hermitian_part].violated[0].high).value, 0.16, 0.005);
}

TEST(PositiveReal, LessItsLargestShareOfTheIdentityIsTheLeastDamping) {
  const Matrix M = Matrix::Identity(2, 2), K = Matrix::Identity(2, 2);
  const Matrix B{{5, 2}, {2, 8}};  // eigenvalues 4 and 9
  const RationalMatrix Z = *RationalMatrix::impedance(M, B, K);
  EXPECT_TRUE(judged(Z - RationalMatrix::scalar(2, 4)).holds());
  const Rational tiny = Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 30);
  EXPECT_FALSE(judged(Z - RationalMatrix::scalar(2, 4 + tiny)).holds());
}

TEST(PositiveReal, FindsANarrowResonanceThatAGridMisses) {
  // 1 − 1.01 (s/50)/(s² + s/50 + 100)
  const RationalMatrix z = siso({100, 0.02 - 1.01 * 0.02, 1}, {100, 0.02, 1});
  double lowest = 1.0;
  for (int i = 0; i < 100; ++i) lowest = std::min(lowest, z(RadPerSec(std::pow(10.0, -2 + 4 * i / 99.0)))(0, 0).real());
  EXPECT_GT(lowest, 0.99);
  const PositiveRealness found = judged(z);
  EXPECT_EQ(violated(found), only(hermitian_part));
  const FrequencyBand band = found[hermitian_part].violated.at(0);
  EXPECT_LT(band.low.value, 10.0);
  EXPECT_GT(band.high.value, 10.0);
  // u² = (1 − 1/1.01)… : |ω² − 100| < 0.1 · 0.02 ω
  EXPECT_NEAR(band.high.value - band.low.value, 0.002, 1e-6);
  EXPECT_LT(z(band.witness)(0, 0).real(), 0.0);
  EXPECT_TRUE(judged(siso({100, 0, 1}, {100, 0.02, 1})).holds());  // 1 in place of 1.01: touches zero
}

TEST(PositiveReal, AcceptsTheBoundaryAndNothingBeyond) {
  // (s² + a s + 1)/(s² + s + 1) is positive real if and only if a ≥ 0
  EXPECT_TRUE(judged(siso({1, 0, 1}, {1, 1, 1})).holds());
  EXPECT_FALSE(judged(siso({1, -1e-15, 1}, {1, 1, 1})).holds());
  // (s + a)/(s + 1)²  is if and only if a ≤ 2
  EXPECT_TRUE(judged(siso({2, 1}, {1, 2, 1})).holds());
  EXPECT_FALSE(judged(siso({std::nextafter(2.0, 3.0), 1}, {1, 2, 1})).holds());
}

/// C (s I + L Lᵀ + S)⁻¹ Cᵀ + D Dᵀ with S skew: passive.
RationalMatrix random_passive(Random& random, Index states, Index ports) {
  Matrix A = gram(random, states, states) + 0.125 * Matrix::Identity(states, states);
  for (Index i = 0; i < states; ++i) {
    for (Index j = 0; j < i; ++j) {
      const double skew = (static_cast<double>(random.below(17)) - 8.0) / 4.0;
      A(i, j) += skew;
      A(j, i) -= skew;
    }
  }
  RationalMatrix resolvent(states);
  for (Index i = 0; i < states; ++i) {
    for (Index j = 0; j < states; ++j) {
      const double one = i == j ? 1.0 : 0.0;
      resolvent(i, j) = RationalFunction(*Polynomial::from_decimals(std::vector<double>{A(i, j), one}));
    }
  }
  const RationalMatrix full = *inverse(resolvent);
  RationalMatrix C(states);
  for (Index i = 0; i < ports; ++i) {
    for (Index j = 0; j < states; ++j) {
      C(i, j) = RationalFunction(Polynomial{Rational(static_cast<int>(random.below(9)) - 4, 4)});
    }
  }
  RationalMatrix Ct(states);
  for (Index i = 0; i < states; ++i) {
    for (Index j = 0; j < states; ++j) Ct(i, j) = C(j, i);
  }
  const RationalMatrix product = C * full * Ct;
  RationalMatrix Z(ports);
  for (Index i = 0; i < ports; ++i) {
    for (Index j = 0; j < ports; ++j) Z(i, j) = product(i, j);
  }
  return Z;
}

TEST(PositiveReal, HoldsForPassiveNetworksAndTheirInverses) {
  Random random(7);
  for (int trial = 0; trial < 12; ++trial) {
    const Index ports = 1 + trial % 2;
    const RationalMatrix Z = random_passive(random, 2 + trial % 3, ports);
    const PositiveRealness result = judged(Z);
    EXPECT_TRUE(result.holds()) << "trial " << trial << ", violated " << violated(result);
    const auto Y = inverse(Z);
    if (Y) {
      EXPECT_TRUE(judged(*Y).holds()) << "trial " << trial;
    }
    // strictly proper: any negative resistance is too much
    const Rational tiny = Rational(1) / boost::multiprecision::pow(boost::multiprecision::cpp_int(10), 20);
    EXPECT_EQ(violated(judged(Z - RationalMatrix::scalar(ports, tiny))), only(hermitian_part)) << "trial " << trial;
  }
}

TEST(PositiveReal, AgreesWithADenseGridOnTheAxis) {
  Random random(11);
  int negative = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Index n = 1 + trial % 2;
    RationalMatrix Z(n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Polynomial stable = Polynomial{1 + static_cast<int>(random.below(9)), 1} *
                                  Polynomial{1 + static_cast<int>(random.below(9)), Rational(1, 4), 1};
        Z(i, j) = *RationalFunction::of(random_polynomial(random, 3), stable);
        if (i == j) Z(i, j) = Z(i, j) + RationalFunction(Polynomial{static_cast<int>(random.below(30))});
      }
    }
    const PositiveRealness result = judged(Z);
    const auto& bands = result[hermitian_part].violated;
    negative += bands.empty() ? 0 : 1;
    for (int i = 0; i < 400; ++i) {
      const double omega = std::pow(10.0, -3 + 6 * i / 399.0);
      const Eigen::MatrixXcd value = Z(RadPerSec(omega));
      const Eigen::MatrixXcd part = value + value.adjoint();
      const double smallest = numeric::hermitian_eigenvalues(part)[0];
      if (std::abs(smallest) < 1e-9 * value.norm()) continue;  // a double cannot tell
      const bool listed = std::any_of(bands.begin(), bands.end(), [&](const FrequencyBand& band) {
        return omega > band.low.value && omega < band.high.value;
      });
      EXPECT_EQ(listed, smallest < 0.0) << "trial " << trial << ", " << omega << " rad/s";
    }
  }
  EXPECT_GT(negative, 8);
  EXPECT_LT(negative, 32);
}

TEST(PositiveReal, IsDecidedForNumbersAtTheEndsOfADouble) {
  EXPECT_TRUE(judged(siso({1e300, 1e-300}, {1e-300, 1e300})).holds());
  EXPECT_EQ(violated(judged(siso({1e300, -1e-300}, {1, 1e-300}))), only(hermitian_part));
  EXPECT_FALSE(judged(siso({1}, {-1e-300, 1e300, 1}))[no_right_poles].holds());
  EXPECT_FALSE(judged(siso({1}, {1, -1e300, 1e-300, 1e300, 1e-300, 1}))[no_right_poles].holds());
}

TEST(PositiveReal, RefusesSizesThatItCannotJudge) {
  EXPECT_FALSE(positive_real(RationalMatrix(Index{0})));
  EXPECT_FALSE(positive_real(RationalMatrix(kMaxPorts + 1)));
}

}  // namespace positive_real_test
}  // namespace mbk::lti
