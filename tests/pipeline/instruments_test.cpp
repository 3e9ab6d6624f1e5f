// Least squares beside instrumental variables, on simulated recordings whose truth is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/measure/preprocess/prepare.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/model.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace instruments_test {

using identify::Comparison;
using testing::HasSubstr;

PreparedTrial prepared(const Recording& recording, std::optional<Hertz> cutoff = {}) {
  preprocess::Options options;
  options.cutoff = cutoff;
  options.instruments = true;
  return preprocess::prepare(recording, recording::inspect(recording), options).value();
}

Comparison compared(const Recording& recording, std::optional<Hertz> cutoff = {}) {
  auto both = identify::compare_methods({prepared(recording, cutoff)}, {});
  EXPECT_TRUE(both) << both.error().line();
  return both ? *both : Comparison{};
}

laboratory::Scenario ready(const std::string& name, std::uint64_t seed) {
  auto scenario =
      laboratory::read_scenarios(laboratory::find_ready_scenario(name)->text, name + ".toml").value().front();
  scenario.seed = seed;
  return scenario;
}

Recording simulated(const std::string& name, std::uint64_t seed) {
  return laboratory::simulate(ready(name, seed)).value().recording;
}

/// In units of their own standard errors.
Vector errors(const Identification& id, const impedance::Model& truth, Index count) {
  return (impedance::stacked(id.model) - impedance::stacked(truth))
      .cwiseQuotient(impedance::stacked(id.standard_error))
      .head(count);
}

/// The arm of a simulated trial; the handle that the recording names is subtracted.
impedance::Model truth_of(const Recording& recording) {
  const auto matrix = [&](const char* name) {
    const auto rows = nlohmann::json::parse(recording.metadata.at(name));
    return Matrix{{rows[0][0].get<double>(), rows[0][1].get<double>()},
                  {rows[1][0].get<double>(), rows[1][1].get<double>()}};
  };
  impedance::Model model{matrix("truth_M"), matrix("truth_B"), matrix("truth_K"), Vector::Zero(2)};
  return model;
}

Eigen::Vector2d eigenvalues(const Matrix& Z) {
  return numeric::symmetric_eigenvalues(impedance::symmetric_part(Z));
}

TEST(RelaxedArmMovedByARobot, HasOneModelByBothMethods) {
  laboratory::PrescribedMotionOptions options;
  options.sensors.coloured_force_noise = 0.2;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    options.seed = seed;
    const Comparison both = compared(generated(options));
    EXPECT_FALSE(both.disagreement.significant) << both.disagreement.parameter;
    EXPECT_EQ(both.instrumental_variables.instrument->from, ReferenceQuantity::position);
    EXPECT_TRUE(both.instrumental_variables.instrument->strong());
    // 12 numbers in 4 trials: beyond 3.8 standard errors by chance once in 140 such tests; the seeds are fixed.
    EXPECT_LT(errors(both.instrumental_variables, options.limb, 12).cwiseAbs().maxCoeff(), 3.8);
    EXPECT_LT(errors(both.least_squares, options.limb, 12).cwiseAbs().maxCoeff(), 3.8);
  }
}

// The reference is the step behind the pulse: nothing moves within a perturbation, and velocity and acceleration have
// no instrument.
// A step has no derivatives that could serve; what a second-order system makes of it has.
TEST(PulsesWhoseReferenceIsAStep, AreInstrumentsByTheResponseToThem) {
  laboratory::PrescribedMotionOptions options;
  options.protocol = Protocol::underdamped;
  const Comparison both = compared(generated(options));
  EXPECT_TRUE(both.least_squares.usable);
  EXPECT_TRUE(both.instrumental_variables.usable);
  EXPECT_TRUE(both.instrumental_variables.instrument->strong());
  EXPECT_EQ(both.instrumental_variables.instrument->from, ReferenceQuantity::position);
  EXPECT_FALSE(both.disagreement.significant);
  const Vector error = impedance::stacked(both.instrumental_variables.model) - impedance::stacked(options.limb);
  const Vector reach = 4.0 * impedance::stacked(both.instrumental_variables.standard_error);
  EXPECT_TRUE((error.head(12).array().abs() <= reach.head(12).array()).all()) << error.transpose();
}

// Noise of a regressor draws its coefficient towards zero, of the second derivative most: its power grows with the
// fifth power of the cutoff, so that the default one, near 5 Hz, leaves nothing of it.
TEST(NoiseOfThePosition, DrawsTheInertiaDownByLeastSquaresAlone) {
  constexpr double kNoise = 0.2e-3;
  laboratory::PrescribedMotionOptions options;
  Recording recording = generated(options);
  numeric::Random random(5);
  for (Channel& channel : recording.channels) {
    if (channel.name != "hand_x" && channel.name != "hand_y") continue;
    for (double& value : channel.values) value += kNoise * random.normal();
  }
  const Comparison both = compared(recording, Hertz(20.0));
  const double truth = options.limb.M(1, 1);
  const double ls = both.least_squares.model.M(1, 1), iv = both.instrumental_variables.model.M(1, 1);
  const double error = both.instrumental_variables.standard_error.M(1, 1);
  EXPECT_LT(ls, truth - 0.1) << "standard error " << error;
  EXPECT_NEAR(iv, truth, 4.0 * error);
  EXPECT_LT(4.0 * error, 0.1);
  const Comparison filtered = compared(recording);
  EXPECT_NEAR(filtered.least_squares.model.M(1, 1), truth, 0.01);
  EXPECT_TRUE(both.disagreement.significant);
  EXPECT_EQ(both.disagreement.parameter.front(), 'm');
  EXPECT_GT(std::abs(both.disagreement.difference), 3.341 * both.disagreement.standard_error);
}

// The participant's own responses are in the loop with the robot's impedance. Damping is drawn little either way.
TEST(RigidArmUnderAForce, IsFoundByInstrumentsAndNotByLeastSquares) {
  static constexpr int kSeeds = 4;
  struct Eigenvalues {
    Eigen::Vector2d M = Eigen::Vector2d::Zero(), B = M, K = M;
    void add(const impedance::Model& model) {
      M += eigenvalues(model.M) / kSeeds;
      B += eigenvalues(model.B) / kSeeds;
      K += eigenvalues(model.K) / kSeeds;
    }
  } truth, ls, iv;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Recording recording = simulated("rigid_sinusoidal_6N", seed);
    const Comparison both = compared(recording);
    EXPECT_TRUE(both.disagreement.significant);
    EXPECT_EQ(both.instrumental_variables.instrument->from, ReferenceQuantity::force);
    EXPECT_TRUE(both.instrumental_variables.instrument->strong());
    EXPECT_GT(eigenvalues(both.instrumental_variables.model.M)[0], 0.0);
    truth.add(truth_of(recording));
    ls.add(both.least_squares.model);
    iv.add(both.instrumental_variables.model);
  }
  EXPECT_LT(ls.M[0], 0.0);  // a model that says active
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(std::abs(iv.M[k] - truth.M[k]), 0.5 * std::abs(ls.M[k] - truth.M[k])) << k;
    EXPECT_LT(std::abs(iv.K[k] - truth.K[k]), 0.6 * std::abs(ls.K[k] - truth.K[k])) << k;
    EXPECT_NEAR(iv.B[k], truth.B[k], 0.15 * truth.B[k]) << k;
    EXPECT_NEAR(iv.M[k], truth.M[k], 0.4 * truth.M[k]) << k;
    EXPECT_NEAR(iv.K[k], truth.K[k], 0.3 * truth.K[k]) << k;
  }
}

Error refusal(Recording recording) {
  const auto both = identify::compare_methods({prepared(recording)}, {});
  EXPECT_FALSE(both);
  return both ? Error{} : both.error();
}

TEST(Instruments, AskForAReference) {
  Recording recording = generated({});
  std::erase_if(recording.channels, [](const Channel& channel) { return channel.name.starts_with("reference"); });
  const Error error = refusal(recording);
  EXPECT_THAT(error.line(), HasSubstr("reference"));
  EXPECT_THAT(error.line(), HasSubstr("xr"));
  // measure goes on with least squares alone, unless instruments were asked for.
  measurement::Options options;
  const std::vector<Recording> recordings = {recording};
  const auto alone = measurement::measure(recordings, options);
  ASSERT_TRUE(alone);
  EXPECT_FALSE(alone->alternative || alone->disagreement);
  options.identify.method = Method::instrumental_variables;
  EXPECT_FALSE(measurement::measure(recordings, options));
}

TEST(Instruments, AskForAReferenceThatChangesInEveryAxis) {
  laboratory::PrescribedMotionOptions options;
  Recording recording = generated(options);
  for (Channel& channel : recording.channels) {
    if (channel.name == "reference_y") channel.values.setConstant(0.02);
  }
  EXPECT_THAT(refusal(recording).line(), HasSubstr("axis"));
}

TEST(Bootstrap, IsTheSameForAnyNumberOfThreads) {
  laboratory::PrescribedMotionOptions motion;
  motion.sensors.coloured_force_noise = 0.2;
  const PreparedTrial trial = prepared(generated(motion));
  identify::Options options;
  options.bootstrap = 50;
  options.seed = 9;
  options.method = Method::instrumental_variables;
  const auto one = identify::identify_impedance({trial}, options);
  options.threads = 2;
  const auto two = identify::identify_impedance({trial}, options);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->replicates->models, two->replicates->models);
  options.seed = 10;
  const auto other = identify::identify_impedance({trial}, options);
  EXPECT_NE(one->replicates->models, other->replicates->models);
  EXPECT_EQ(one->replicates->seed, 9U);
  EXPECT_EQ(one->model.K, identify::identify_impedance({trial}, {.method = Method::instrumental_variables})->model.K);
}

}  // namespace instruments_test
}  // namespace mbk::pipeline
