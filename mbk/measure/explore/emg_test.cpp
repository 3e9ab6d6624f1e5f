#include "mbk/measure/explore/emg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/random.h"

namespace mbk::explore {
namespace emg_test {

const Hertz kRate(2000.0);

EmgProcessing usual() {
  return *emg_processing_at(kRate, {});
}

Vector noise(Index samples, std::uint64_t seed = 1) {
  numeric::Random random(seed);
  Vector x(samples);
  for (double& value : x) value = 1e-5 * random.normal();
  return x;
}

Vector sine(Index samples, double hz, double amplitude = 1.0) {
  Vector x(samples);
  for (Index i = 0; i < samples; ++i) {
    x[i] = amplitude * std::sin(2.0 * std::numbers::pi * hz * static_cast<double>(i) / kRate.value);
  }
  return x;
}

bool has(const std::vector<EmgFinding>& findings, EmgProblem problem) {
  return std::ranges::find(findings, problem, &EmgFinding::problem) != findings.end();
}

/// In the middle of a long sine, so that the ends do not matter.
double gain_at(double hz) {
  const Index n = 20000;
  const auto y = emg_band(sine(n, hz), usual());
  EXPECT_TRUE(y);
  return std::sqrt(2.0) * std::sqrt(y->segment(n / 4, n / 2).squaredNorm() / static_cast<double>(n / 2));
}

TEST(EmgBand, AttenuatesBy3DecibelAtBothEndsAndHasNoPhase) {
  constexpr double kWithin = 2e-3;  // of the mean over a part of a period
  EXPECT_NEAR(gain_at(20.0), std::sqrt(0.5), kWithin);
  EXPECT_NEAR(gain_at(450.0), std::sqrt(0.5), kWithin);
  EXPECT_NEAR(gain_at(100.0), 1.0, 1e-2);
  EXPECT_LT(gain_at(5.0), 0.01);  // 24 dB per octave, two octaves below
  const Vector x = sine(20000, 100.0);
  const auto y = emg_band(x, usual());
  ASSERT_TRUE(y);
  const auto middle = Eigen::seqN(5000, 10000);
  const double correlation = x(middle).dot((*y)(middle)) / (x(middle).norm() * (*y)(middle).norm());
  EXPECT_NEAR(correlation, 1.0, 1e-6);
}

TEST(EmgBand, RefusesAnOddOrder) {
  EmgProcessing how = usual();
  how.order = 3;
  EXPECT_FALSE(emg_band(noise(1000), how));
}

TEST(EmgProcessingAt, LowersTheBandOfASlowRecordingAndRefusesOneThatIsTooSlow) {
  const auto slow = emg_processing_at(Hertz(600.0), {});
  ASSERT_TRUE(slow);
  EXPECT_DOUBLE_EQ(slow->high_hz, 270.0);
  EXPECT_DOUBLE_EQ(emg_processing_at(Hertz(1000.0), {})->high_hz, 450.0);
  EXPECT_FALSE(emg_processing_at(Hertz(250.0), {}));
}

TEST(EmgProcessingAt, RefusesAnEmptyBandAndTwoEnvelopes) {
  EmgProcessing how;
  how.low_hz = 500.0;
  EXPECT_FALSE(emg_processing_at(kRate, how));
  how = {};
  how.envelope_rms_s = 0.05;
  EXPECT_FALSE(emg_processing_at(kRate, how));
}

TEST(EmgEnvelope, OfAConstantIsThatConstant) {
  const Vector one = Vector::Constant(1000, 3.0);
  EmgProcessing how = usual();
  EXPECT_NEAR((*emg_envelope(one, how) - one).norm(), 0.0, 1e-9);
  how.envelope_hz = 0.0;
  how.envelope_rms_s = 0.05;
  EXPECT_NEAR((*emg_envelope(one, how) - one).norm(), 0.0, 1e-9);
}

TEST(EmgEnvelope, MovingRmsIsThatOfItsWindow) {
  EmgProcessing how = usual();
  how.envelope_hz = 0.0;
  how.envelope_rms_s = 0.05;
  const Vector x = noise(1000).cwiseAbs();
  const auto y = emg_envelope(x, how);
  ASSERT_TRUE(y);
  EXPECT_NEAR((*y)[500], std::sqrt(x.segment(450, 101).squaredNorm() / 101.0), 1e-12);
}

TEST(CheckEmg, FindsNothingInCleanEmg) {
  const auto clean = emg_band(noise(20000), usual());
  ASSERT_TRUE(clean);
  EXPECT_TRUE(check_emg(*clean, usual()).empty());
}

TEST(CheckEmg, FindsEachProblem) {
  const Vector clean = *emg_band(noise(20000), usual());
  const double rms = std::sqrt(clean.squaredNorm() / 20000.0);
  const auto problems = [](const Vector& raw) { return check_emg(raw, usual()); };
  Vector raw = clean;
  raw[77] = kNaN;
  EXPECT_TRUE(has(problems(raw), EmgProblem::not_finite));
  EXPECT_TRUE(has(problems(Vector::Constant(20000, 1e-3)), EmgProblem::constant));
  EXPECT_TRUE(has(problems((clean / rms).array().round().matrix()), EmgProblem::few_levels));
  EXPECT_TRUE(has(problems(clean.cwiseMax(-rms).cwiseMin(rms)), EmgProblem::clipping));
  EXPECT_TRUE(has(problems(clean + sine(20000, 2.0, 3.0 * rms)), EmgProblem::movement_artefact));
  EXPECT_TRUE(has(problems(clean.cwiseAbs()), EmgProblem::rectified));
  EXPECT_FALSE(has(problems((clean.array() + 10.0 * rms).matrix()), EmgProblem::rectified)) << "an offset only";
  for (const double mains : {50.0, 60.0}) {
    const auto found = problems(clean + sine(20000, mains, rms));
    ASSERT_TRUE(has(found, EmgProblem::mains_hum));
    EXPECT_EQ(std::ranges::find(found, EmgProblem::mains_hum, &EmgFinding::problem)->frequency, mains);
  }
  for (const auto& finding : problems(clean + sine(20000, 50.0, rms))) EXPECT_TRUE(finding.usable);
  EXPECT_FALSE(problems(Vector::Constant(20000, 1e-3)).front().usable);
}

TEST(WeakChannels, AreBelowATenthOfTheMedian) {
  EXPECT_EQ(weak_channels({1.0, 1.2, 0.05, kNaN}), (std::vector<bool>{false, false, true, false}));
  EXPECT_EQ(weak_channels({1.0, 0.05}), (std::vector<bool>{false, false}));
}

}  // namespace emg_test
}  // namespace mbk::explore
