// Default mode against the truth in generated recordings, and on real ones.
#include <gtest/gtest.h>

#include "mbk/files/contents/disk_pages.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/measurement/explore.h"
#include "mbk/measure/measurement/measure_movement.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "tests/pipeline/pipeline_helpers.h"

namespace mbk::pipeline {
namespace default_mode_test {

Identification measured(const std::vector<Recording>& recordings, const measurement::Options& options = {}) {
  auto result = measurement::measure(recordings, options);
  EXPECT_TRUE(result) << result.error().line();
  return result ? result->identification : Identification{};
}

Vector flat(const impedance::Model& model) {
  Vector values(3 * model.M.size() + model.x0.size());
  values << Vector(model.M.transpose().reshaped()), Vector(model.B.transpose().reshaped()),
      Vector(model.K.transpose().reshaped()), model.x0;
  return values;
}

struct Case {
  const char* name;
  mbk::Protocol protocol;
  int axes;
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class DefaultMode : public testing::TestWithParam<Case> {
 protected:
  static laboratory::PrescribedMotionOptions motion(std::uint64_t seed) {
    laboratory::PrescribedMotionOptions options;
    options.protocol = GetParam().protocol;
    options.seed = seed;
    if (GetParam().axes == 1) {
      options.limb = laboratory::relaxed_arm_one_axis();
      options.home = Vector::Constant(1, 0.02);
    }
    options.sensors.coloured_force_noise = 0.2;
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(All, DefaultMode,
                         testing::Values(Case{"Sinusoidal", mbk::Protocol::sinusoidal, 2},
                                         Case{"Underdamped", mbk::Protocol::underdamped, 2},
                                         Case{"SinusoidalOneAxis", mbk::Protocol::sinusoidal, 1},
                                         Case{"UnderdampedOneAxis", mbk::Protocol::underdamped, 1}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(DefaultMode, RecoversTheTruthOfANoisyLogWithinItsOwnErrors) {
  // 14 parameters in 4 cases: 3.5 standard errors are left by chance once in 40 runs of all, and the seed is fixed.
  const double kErrors = 3.5;
  const auto options = motion(11);
  const Identification id = measured({generated(options)});
  const Vector error = (flat(id.model) - flat(options.limb)).cwiseQuotient(flat(id.standard_error));
  for (Index k = 0; k < error.size(); ++k) {
    EXPECT_LE(std::abs(error[k]), kErrors) << id.parameters[static_cast<std::size_t>(k)];
  }
  EXPECT_TRUE(id.usable);
  EXPECT_EQ(codes(id), "");
}

TEST_P(DefaultMode, FindsTheSameInARecordingWhoseNumbersStandInAFile) {
  const Recording in_memory = generated(motion(11));
  Recording on_disk = in_memory;
  recording::DiskPages disk;
  disk.take(on_disk.time.data(), on_disk.samples());
  for (Channel& channel : on_disk.channels) disk.take(channel.values.data(), on_disk.samples());
  const auto expected = measurement::measure(std::vector{in_memory}, {}).value();
  const auto found = measurement::measure(std::span(&on_disk, 1), {}).value();
  EXPECT_EQ(flat(found.identification.model), flat(expected.identification.model));
  EXPECT_EQ(found.identification.covariance, expected.identification.covariance);
  EXPECT_EQ(codes(found.identification), codes(expected.identification));
  ASSERT_EQ(found.energies.size(), 1U);
  EXPECT_EQ(found.energies[0].account.absorbed, expected.energies[0].account.absorbed);
  EXPECT_EQ(found.energies[0].curve.absorbed, expected.energies[0].curve.absorbed);
}

TEST(Consent, DataOfAPersonWhoHasWithdrawnAreMeasuredByNoFunction) {
  Recording recording = generated({});
  recording.metadata["withdrawn"] = "yes";
  const std::vector<Recording> recordings = {recording};
  const auto code = [](const auto& result) { return result ? std::string("measured") : result.error().code; };
  EXPECT_EQ(code(measurement::measure(recordings, {})), "withdrawn");
  EXPECT_EQ(code(measurement::examine(recordings, {})), "withdrawn");
  EXPECT_EQ(code(measurement::explore(recordings, {})), "withdrawn");
  EXPECT_EQ(code(measurement::movement_quality(recording, {})), "withdrawn");
  recording.metadata["withdrawn"] = "no";
  EXPECT_TRUE(preprocess::check_consent(recording));
}

TEST_P(DefaultMode, RecoversTheTruthOfALogWithoutNoise) {
  auto options = motion(12);
  options.sensors = {.position_quantum = 0.0, .force_noise = 0.0, .acceleration_noise = 0.0};
  const Identification id = measured({generated(options)});
  // Smoothing fits polynomials of degree 6, whose derivatives fall short by 1e-4 at the top of the band; a pulse has
  // more above it.
  const double kSmoothing = GetParam().protocol == mbk::Protocol::sinusoidal ? 1e-3 : 1e-2;
  EXPECT_LE(difference(id.model.M, options.limb.M), kSmoothing);
  EXPECT_LE(difference(id.model.B, options.limb.B), kSmoothing);
  EXPECT_LE(difference(id.model.K, options.limb.K), kSmoothing);
  EXPECT_LE(difference(id.model.x0, options.limb.x0), kSmoothing);
  EXPECT_GT(id.fit.vaf.minCoeff(), 99.99);
}

TEST_P(DefaultMode, PoolingTwoTrialsShrinksTheErrorsByTheRootOfTwo) {
  double sum = 0.0;
  constexpr int kPairs = 5;
  for (std::uint64_t pair = 0; pair < kPairs; ++pair) {
    const Recording a = generated(motion(20 + 2 * pair)), b = generated(motion(21 + 2 * pair));
    const Vector one = flat(measured({a}).standard_error), other = flat(measured({b}).standard_error);
    sum += (0.5 * (one + other)).cwiseQuotient(flat(measured({a, b}).standard_error)).mean();
  }
  // A standard error from some 50 correlation times is itself known to 10 % or so, and the elements of one trial err
  // together; five pairs halve that. The widenings for long lags and for what was fitted add 2.5 %.
  EXPECT_NEAR(sum / kPairs, 1.025 * std::sqrt(2.0), 0.15);
}

class GoldenLog : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, GoldenLog, testing::Values("sinusoidal", "underdamped"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(GoldenLog, DefaultModeFindsItsTruth) {
  const auto folder = data_folder();
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const auto recording = recording::read(*folder / "golden" / (std::string(GetParam()) + ".mat"), {});
  ASSERT_TRUE(recording) << recording.error().line();
  const Identification id = measured({*recording});
  const impedance::Model truth{matrix2(std::array{1.2, -0.5, -0.4, 1.6}), matrix2(std::array{6.0, -3.0, -3.0, 12.0}),
                               matrix2(std::array{90.0, -30.0, -40.0, 200.0}), vector2(std::array{0.304, -0.053})};
  const Vector error = (flat(id.model) - flat(truth)).cwiseQuotient(flat(id.standard_error));
  EXPECT_LE(error.cwiseAbs().maxCoeff(), 3.5) << error.transpose();
}

// A real ankle (McGill, reklab_public): position perturbations under tonic contraction.

struct Ankle {
  const char* name;
  double vaf, stiffness;
};

void PrintTo(const Ankle& one, std::ostream* out) {
  *out << one.name;
}

class RealAnkle : public testing::TestWithParam<Ankle> {
 protected:
  static measurement::Options with(int window, double cutoff_hz) {
    measurement::Options options;
    options.preprocess.smoothing_window = window;
    options.preprocess.smoothing_order = 6;
    options.preprocess.cutoff = Hertz(cutoff_hz);
    options.preprocess.window.split_s = 40.0;
    return options;
  }
  void SetUp() override {
    const auto folder = data_folder();
    if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
    const recording::ReadOptions columns{.channels = recording::parse_channel_map("t=1,x=2:rad,F=3:N.m").value(),
                                         .axes = 1};
    const auto read = recording::read(*folder / "ankle" / (std::string(GetParam().name) + ".csv"), columns);
    ASSERT_TRUE(read) << read.error().line();
    recording_ = *read;
  }
  Recording recording_;
};
INSTANTIATE_TEST_SUITE_P(All, RealAnkle,
                         testing::Values(Ankle{"z_df", 87.2, 104.0}, Ankle{"z_pf", 61.0, 109.0},
                                         Ankle{"z_df2", 92.7, 60.0}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(RealAnkle, HasItsKnownFitStiffnessAndInertia) {
  const Identification id = measured({recording_}, with(31, 25.0));
  EXPECT_NEAR(id.fit.vaf[0], GetParam().vaf, 2.0);                                   // points, as the figures are known
  EXPECT_NEAR(id.model.K(0, 0), GetParam().stiffness, 0.05 * GetParam().stiffness);  // "about"
  EXPECT_GE(id.model.M(0, 0), 0.010);
  EXPECT_LE(id.model.M(0, 0), 0.024);
  EXPECT_EQ(id.motion, Motion::rotation);
}

TEST_P(RealAnkle, TheFilterOfTheThesisIsFlagged) {
  const Identification id = measured({recording_}, with(101, 5.0));
  EXPECT_TRUE(warns(id, WarningCode::inertia_not_positive) || warns(id, WarningCode::band_too_narrow)) << codes(id);
  EXPECT_EQ(id.usable, id.model.M(0, 0) > 0.0);
}

TEST_P(RealAnkle, PlantarFlexionIsNotExplainedWithoutItsReflexes) {
  const Identification id = measured({recording_});
  if (std::string(GetParam().name) == "z_pf") {
    EXPECT_LT(id.fit.vaf[0], 90.0);
  } else {
    EXPECT_GT(id.fit.vaf[0], 80.0);
  }
}

}  // namespace default_mode_test
}  // namespace mbk::pipeline
