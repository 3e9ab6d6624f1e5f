#include "mbk/measure/analyse/describe_transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

using std::numbers::pi;
constexpr double kRounding = 1e-12;

Vector grid(double low, double high, Index count) {
  return Vector::LinSpaced(count, std::log(low), std::log(high)).array().exp();
}

TEST(FrequencyResponse, OfAFirstOrderSystemIsItsClosedForm) {
  // b/(s + a): ln|H| = ln b − ½ ln(ω² + a²), φ = −atan(ω/a).
  constexpr double kA = 4.0, kB = 6.0, kErrorA = 0.3, kErrorB = 0.5;
  const TransferFunction model{Vector{{kB}}, Vector{{kA, 1.0}}};
  const Matrix covariance = Vector{{kErrorA * kErrorA, kErrorB * kErrorB}}.asDiagonal();
  const FrequencyResponse response = frequency_response(model, covariance, grid(0.01, 100.0, 50));
  for (Index i = 0; i < response.size(); ++i) {
    const double w = 2.0 * pi * response.frequency[i], square = w * w + kA * kA;
    EXPECT_NEAR(std::abs(response.value[i]), kB / std::sqrt(square), kRounding);
    EXPECT_NEAR(response.phase[i], -std::atan2(w, kA), kRounding);
    EXPECT_NEAR(std::sqrt(response.relative(i, 0)), std::hypot(kErrorB / kB, kErrorA * kA / square), kRounding);
    EXPECT_NEAR(std::sqrt(response.relative(i, 2)), kErrorA * w / square, kRounding);
    EXPECT_NEAR(response.phase_half_width[i], numeric::kNormal95 * kErrorA * w / square, kRounding);
  }
}

TEST(FrequencyResponse, OfADiscreteModelIsTakenOnTheUnitCircle) {
  constexpr double kPole = 0.9, kB = 0.2, kStep = 0.02, kErrorPole = 0.01;
  TransferFunction model{Vector{{0.0, kB}}, Vector{{1.0, -kPole}}};
  model.sample_time = kStep;
  Matrix covariance = Matrix::Zero(3, 3);
  covariance(0, 0) = kErrorPole * kErrorPole;
  const FrequencyResponse response = frequency_response(model, covariance, grid(0.1, 0.5 / kStep, 40));
  for (Index i = 0; i < response.size(); ++i) {
    const double w = 2.0 * pi * response.frequency[i] * kStep;
    const std::complex<double> z = std::polar(1.0, -w), below = 1.0 - kPole * z;
    EXPECT_LT(std::abs(response.value[i] - kB * z / below), kRounding);
    EXPECT_NEAR(std::sqrt(response.relative(i, 0)), kErrorPole * std::abs((z / below).real()), kRounding);
    EXPECT_NEAR(std::sqrt(response.relative(i, 2)), kErrorPole * std::abs((z / below).imag()), kRounding);
  }
  EXPECT_NEAR(response.value[39].imag(), 0.0, kRounding) << "at half the rate";
}

TEST(FrequencyResponse, PhaseRunsOnWithoutJumpsAndADelayAddsToIt) {
  TransferFunction model{Vector{{100.0}}, Vector{{100.0, 1.0, 40.0, 0.2, 1.0}}};
  const Vector frequency = grid(0.05, 20.0, 400);
  const Matrix none = Matrix::Zero(5, 5);
  const FrequencyResponse without = frequency_response(model, none, frequency);
  EXPECT_NEAR(without.phase[399], -2.0 * pi, 0.05);
  model.delay = 0.3;
  const FrequencyResponse with = frequency_response(model, none, frequency);
  for (Index i = 0; i < frequency.size(); ++i) {
    EXPECT_NEAR(with.phase[i], without.phase[i] - 2.0 * pi * frequency[i] * model.delay, 1e-9);
    EXPECT_LT(std::abs(std::polar(std::abs(with.value[i]), with.phase[i]) - with.value[i]), 1e-9);
  }
}

/// A lightly damped mode with a zero, and correlated errors of a few per cent.
struct Uncertain {
  TransferFunction model{Vector{{30.0, 2.0}}, Vector{{40.0, 3.0, 1.0}}};
  Matrix covariance;
  Uncertain() {
    Matrix root(4, 4);
    root << 1.0, 0.0, 0.0, 0.0, 0.02, 0.1, 0.0, 0.0, 0.5, 0.3, 0.4, 0.0, -0.01, 0.02, 0.0, 0.05;
    covariance = 0.25 * root * root.transpose();
  }
};

TEST(FrequencyResponse, IntervalsAreThoseOfMonteCarlo) {
  const Uncertain uncertain;
  const Vector frequency = grid(0.1, 10.0, 15);
  const FrequencyResponse response = frequency_response(uncertain.model, uncertain.covariance, frequency);
  const Matrix root = numeric::Cholesky(uncertain.covariance).upper().transpose();
  numeric::Random random(5);
  constexpr int kDraws = 4000;
  constexpr double kChance = 4.0 * 0.0035, kWide = 0.06;  // of 0.95 in so many draws; of a standard deviation
  Matrix inside = Matrix::Zero(frequency.size(), 4), squares = Matrix::Zero(frequency.size(), 2);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Vector off = root * Vector::NullaryExpr(4, [&] { return random.normal(); });
    TransferFunction moved = uncertain.model;
    moved.denominator.head(2) += off.head(2);
    moved.numerator += off.tail(2);
    const FrequencyResponse other = frequency_response(moved, uncertain.covariance, frequency);
    for (Index i = 0; i < frequency.size(); ++i) {
      const double magnitude = std::abs(other.value[i]), phase = other.phase[i] - response.phase[i];
      squares(i, 0) += std::pow(std::log(magnitude / std::abs(response.value[i])), 2) / kDraws;
      squares(i, 1) += phase * phase / kDraws;
      inside(i, 0) += magnitude > response.magnitude95(i, 0) && magnitude < response.magnitude95(i, 1);
      inside(i, 1) += std::abs(phase) < response.phase_half_width[i];
      inside(i, 2) += std::abs(other.value[i].real() - response.value[i].real()) < response.real_half_width[i];
      const std::complex<double> turned =
          (other.value[i] - response.value[i]) * std::polar(1.0, -response.region95(i, 2));
      inside(i, 3) +=
          std::hypot(turned.real() / response.region95(i, 0), turned.imag() / response.region95(i, 1)) < 1.0;
    }
  }
  for (Index i = 0; i < frequency.size(); ++i) {
    EXPECT_NEAR(std::sqrt(squares(i, 0) / response.relative(i, 0)), 1.0, kWide) << frequency[i] << " Hz";
    EXPECT_NEAR(std::sqrt(squares(i, 1) / response.relative(i, 2)), 1.0, kWide) << frequency[i] << " Hz";
    for (Index k = 0; k < 4; ++k) EXPECT_NEAR(inside(i, k) / kDraws, 0.95, kChance) << frequency[i] << " Hz, " << k;
  }
}

TransferFunctionIdentification identified(const TransferFunction& model, const Matrix& covariance) {
  TransferFunctionIdentification found;
  found.model = model;
  found.covariance = covariance;
  found.band_low = 0.2;
  found.band_high = 8.0;
  found.sample_time = 0.01;
  found.input_unit = "N";
  return found;
}

TEST(InvertedAdmittance, OfASecondOrderArmIsItsInertiaDampingAndStiffness) {
  constexpr double kM = 1.5, kB = 9.0, kK = 120.0;
  const Vector error{{0.8, 0.06, 0.01}};
  const Matrix covariance = error.cwiseAbs2().asDiagonal();
  const auto inverse = inverted(identified({Vector{{1.0 / kM}}, Vector{{kK / kM, kB / kM, 1.0}}}, covariance),
                                AdmittanceOutput::position);
  ASSERT_TRUE(inverse.has_value());
  EXPECT_NEAR(inverse->M->value, kM, kRounding);
  EXPECT_NEAR(inverse->B->value, kB, 10 * kRounding);
  EXPECT_NEAR(inverse->K->value, kK, 1000 * kRounding);
  EXPECT_NEAR(inverse->M->standard_error, kM * kM * error[2], kRounding);
  EXPECT_NEAR(inverse->B->standard_error, std::hypot(kM * error[1], kB * kM * error[2]), kRounding);
  EXPECT_NEAR(inverse->K->standard_error, std::hypot(kM * error[0], kK * kM * error[2]), 10 * kRounding);
  EXPECT_EQ(inverse->motion, Motion::translation);
  const FrequencyResponse& z = inverse->impedance;
  EXPECT_DOUBLE_EQ(z.frequency[0], 0.2);
  EXPECT_DOUBLE_EQ(z.frequency[z.size() - 1], 8.0);
  for (Index i = 0; i < z.size(); ++i) {
    const std::complex<double> s(0.0, 2.0 * pi * z.frequency[i]);
    EXPECT_LT(std::abs(z.value[i] - (kM * s + kB + kK / s)), 1e-9);
    EXPECT_LT(std::abs(inverse->stiffness.value[i] - s * z.value[i]), 1e-7);
    EXPECT_NEAR(z.phase[i], std::arg(z.value[i]), 1e-9);
    EXPECT_NEAR(z.real_half_width[i], numeric::kNormal95 * inverse->B->standard_error, 1e-9) << "Re Z is B";
  }
}

TEST(InvertedAdmittance, OfAVelocityHasNoStiffness) {
  constexpr double kM = 2.0, kB = 5.0;
  const auto inverse = inverted(identified({Vector{{1.0 / kM}}, Vector{{kB / kM, 1.0}}}, Matrix::Identity(2, 2)),
                                AdmittanceOutput::velocity);
  ASSERT_TRUE(inverse.has_value());
  EXPECT_NEAR(inverse->M->value, kM, kRounding);
  EXPECT_NEAR(inverse->B->value, kB, kRounding);
  EXPECT_FALSE(inverse->K.has_value());
  const std::complex<double> s(0.0, 2.0 * pi * inverse->impedance.frequency[7]);
  EXPECT_LT(std::abs(inverse->impedance.value[7] - (kM * s + kB)), kRounding * 100);
}

TEST(InvertedAdmittance, WithZerosHasAResponseAloneAndSaysWhereItIsUnstable) {
  auto found = identified({Vector{{30.0, -2.0}}, Vector{{40.0, 3.0, 1.0}}}, Matrix::Identity(4, 4));
  found.zeros = {{.value = 15.0, .frequency = 15.0 / (2.0 * pi)}};
  const auto inverse = inverted(found, AdmittanceOutput::position);
  ASSERT_TRUE(inverse.has_value());
  EXPECT_FALSE(inverse->M.has_value() || inverse->B.has_value() || inverse->K.has_value());
  EXPECT_TRUE(inverse->unstable);
}

TEST(InvertedAdmittance, OfADelayIsRefused) {
  auto found = identified({Vector{{1.0}}, Vector{{2.0, 1.0}}}, Matrix::Identity(2, 2));
  found.model.delay = 0.01;
  EXPECT_FALSE(inverted(found, AdmittanceOutput::position).has_value());
}

TEST(FrequenciesOf, BeginWhereTheRecordResolvesThemIfTheInputIsSlower) {
  auto found = identified({Vector{{1.0}}, Vector{{1.0, 1.0}}}, Matrix::Identity(2, 2));
  found.band_low = 0.0;
  found.samples = 8000;
  found.experiments = 2;
  const Vector all = frequencies_of(found, true);
  EXPECT_NEAR(all[0], 8.0 / 40.0, kRounding);
  EXPECT_DOUBLE_EQ(all[all.size() - 1], 8.0);
}

TEST(FrequenciesOf, KeepToHalfTheSampleRateAndMeetEveryResonance) {
  auto found = identified({Vector{{1.0}}, Vector{{1.0, 1.0}}}, Matrix::Identity(2, 2));
  found.poles = {{.value = {-0.1, 40.0}, .frequency = 6.0, .damping = 0.002, .pair = true},
                 {.value = -900.0, .frequency = 143.0, .damping = 1.0}};
  const Vector all = frequencies_of(found, false);
  EXPECT_DOUBLE_EQ(all[all.size() - 1], 50.0);
  EXPECT_NEAR(all[0], 0.2 / 3.0, kRounding);
  for (Index i = 1; i < all.size(); ++i) EXPECT_GT(all[i], all[i - 1]);
  EXPECT_GE(((all.array() - 6.0).abs() < 6.0 * 0.002).count(), 20);
}

}  // namespace
}  // namespace mbk::analyse
