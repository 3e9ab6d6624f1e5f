#include "mbk/measure/identify/instruments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/identify/test_trials.h"

namespace mbk::identify {
namespace instruments_test {

constexpr double kSampleTime = 0.001;
constexpr Index kSamples = 60000;
constexpr double kChance = 0.05;  ///< of a share, where some 280 samples of the noise are independent

/// One axis: sines as the reference, and what a model leaves of the force: noise with a corner at 1.5 Hz, and an answer
/// to the reference 0.2 s before.
struct Left {
  Regression regression;
  Instruments instruments;
  Matrix residual;
  double share;  ///< of the answer, in the power about the mean

  explicit Left(double answer) : residual(Matrix::Zero(kSamples, 1)) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const double memory = std::exp(-2.0 * M_PI * 1.5 * kSampleTime);
    regression.sample_time = kSampleTime;
    regression.Y.resize(kSamples, 1);
    regression.reference = Matrix::Zero(kSamples, 4);
    regression.reference.rightCols(1).setOnes();
    Vector answered = Vector::Zero(kSamples), noise(kSamples);
    double last = 0.0;
    for (Index i = 0; i < kSamples; ++i) {
      const double t = static_cast<double>(i) * kSampleTime;
      for (int line = 1; line <= 8; ++line) {
        const double omega = 2.0 * M_PI * 0.37 * line, phase = 1.9 * line * line;
        regression.reference(i, 0) -= omega * omega * std::sin(omega * t + phase);
        regression.reference(i, 1) += omega * std::cos(omega * t + phase);
        regression.reference(i, 2) += std::sin(omega * t + phase);
        answered[i] += answer * std::sin(omega * (t - 0.2) + phase);
      }
      noise[i] = last = memory * last + std::sqrt(1.0 - memory * memory) * normal(random);
    }
    residual.col(0) = answered + noise;
    const auto power = [](const Vector& of) { return (of.array() - of.mean()).square().sum(); };
    share = power(answered) / power(residual.col(0));
  }

  [[nodiscard]] double found(const std::vector<RowRange>& ranges, Index step) const {
    return coherent_residual_fraction(regression, instruments, {residual}, ranges, step)[0];
  }
};

TEST(CoherentResidual, IsTheShareThatAnswersTheReferenceWhicheverRowsAreTaken) {
  const std::vector<RowRange> whole = {{0, kSamples}}, parts = {{0, 20000}, {20300, 20800}, {21000, kSamples}};
  for (const double answer : {0.0, 0.1, 0.4}) {
    const Left left(answer);
    for (const Index step : {1, 7, 20}) {
      EXPECT_NEAR(left.found(whole, step), left.share, kChance) << "answer " << answer << ", every " << step;
      EXPECT_NEAR(left.found(parts, step), left.share, kChance) << "answer " << answer << ", every " << step;
    }
    EXPECT_NEAR(left.found(whole, 20), left.found(whole, 1), 0.004) << "answer " << answer;
  }
}

TEST(CoherentResidual, IsNotSaidOfFewRows) {
  const Left left(0.4);
  EXPECT_TRUE(std::isnan(left.found({{0, 400}}, 1)));  // no row has a whole past
  EXPECT_TRUE(std::isnan(left.found({{0, 512}}, 1)));  // less than two rows for each column
  EXPECT_TRUE(std::isnan(left.found({{0, 860}}, 20)));
  EXPECT_FALSE(std::isnan(left.found({{0, 5000}}, 20)));
}

/// Where nothing was filtered every row counts; those that a low-pass at 5 Hz needs say nearly the same.
TEST(Instruments, AreJudgedByAsManyRowsAsTheCutoffNeeds) {
  PreparedTrial prepared = testing_support::trial(testing_support::arm(), {.noise = 0.3});
  const PreparedTrial other = testing_support::trial(testing_support::arm(), {.seed = 2});
  prepared.reference_motion.resize(prepared.time.size(), 6);
  prepared.reference_motion << prepared.acceleration + 0.5 * other.acceleration,
      prepared.velocity + 0.5 * other.velocity, prepared.position + 0.5 * other.position;
  constexpr Index kLate = 200;
  const Index rows = prepared.time.size() - kLate;
  prepared.force_hand_on_robot.bottomRows(rows) += 30.0 * prepared.position.topRows(rows);
  const auto found = [&] {
    const Comparison both = compare_methods({prepared}, {}).value();
    return both.instrumental_variables.instrument.value();
  };
  prepared.preparation.cutoff.reset();
  const InstrumentCheck of_every_row = found();
  prepared.preparation.cutoff = Hertz(5.0);
  const InstrumentCheck of_some = found();
  const auto differ = [](const Vector& a, const Vector& b) { return (a - b).cwiseAbs().maxCoeff(); };
  ASSERT_GT(of_every_row.strength.minCoeff(), 1.0);
  EXPECT_NE(of_some.strength, of_every_row.strength);
  EXPECT_LE(differ(of_some.strength.cwiseQuotient(of_every_row.strength), Vector::Ones(6)), 0.05);
  EXPECT_NE(of_some.coherent_residual, of_every_row.coherent_residual);
  EXPECT_LE(differ(of_some.coherent_residual, of_every_row.coherent_residual), 0.02);  // this noise passed no filter
}

}  // namespace instruments_test
}  // namespace mbk::identify
