#include "mbk/measure/analyse/tremor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace mbk::analyse {
namespace tremor_test {

constexpr double kRate = 500.0;

struct Making {
  double tremor = 0.0, tremor_hz = 6.0;  ///< amplitude [N]
  double reference_hz = 1.0;
  double noise = 0.1;
  double seconds = 40.0;
  bool reference = true;
};

Recording recording(const Making& making) {
  Recording made;
  const auto samples = static_cast<Index>(making.seconds * kRate);
  made.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) / kRate);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const std::vector<const char*> names = {"hand_x", "hand_y", "force_x", "force_y", "reference_x", "reference_y"};
  for (const char* name : names) {
    Channel channel{name, "", "base", Vector(samples)};
    for (Index i = 0; i < samples; ++i) {
      const double t = made.time[i], sine = std::sin(2.0 * M_PI * making.reference_hz * t);
      const bool force = channel.name.starts_with("force");
      channel.values[i] = force ? 2.0 * sine + making.tremor * std::sin(2.0 * M_PI * making.tremor_hz * t) +
                                      making.noise * normal(random)
                                : 0.01 * sine;
    }
    if (making.reference || !channel.name.starts_with("reference")) made.channels.push_back(std::move(channel));
  }
  return made;
}

std::optional<AssumptionTest> tested(const Making& making) {
  const Recording made = recording(making);
  PreparedTrial trial;
  trial.recording_rate = kRate;
  trial.preparation.to_s = making.seconds;
  const Recording* const pointer = &made;
  return test_tremor({&pointer, 1}, {&trial, 1});
}

TEST(Tremor, IsFoundWithItsFrequencyAndForce) {
  const auto found = tested({.tremor = 1.0, .tremor_hz = 6.2});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->contradicted);
  EXPECT_NEAR(found->frequency_hz, 6.2, 0.25);
  EXPECT_NEAR(found->size, std::sqrt(0.5), 0.1);
}

TEST(Tremor, IsNotFoundWhereThereIsNone) {
  const auto found = tested({});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->contradicted);
}

TEST(Tremor, IsNotFoundWhereItIsTooSmallToMatter) {
  const auto found = tested({.tremor = 0.1, .noise = 0.01});
  ASSERT_TRUE(found);
  EXPECT_LT(found->p_value, 1e-6);
  EXPECT_FALSE(found->contradicted);
}

TEST(Tremor, IsNotWhatTheReferenceDoes) {
  const auto found = tested({.reference_hz = 6.2});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->contradicted);
}

TEST(Tremor, IsNotLookedForWithoutAReferenceOrInLittleData) {
  EXPECT_FALSE(tested({.tremor = 1.0, .reference = false}));
  EXPECT_FALSE(tested({.tremor = 1.0, .seconds = 10.0}));
}

TEST(Tremor, IsNoWarningOfInstrumentalVariables) {
  const auto found = tested({.tremor = 1.0});
  ASSERT_TRUE(found);
  Identification least_squares, instrumental;
  instrumental.method = Method::instrumental_variables;
  warn_of_tremor(*found, least_squares);
  warn_of_tremor(*found, instrumental);
  ASSERT_EQ(least_squares.warnings.size(), 1U);
  EXPECT_EQ(least_squares.warnings[0].code, WarningCode::tremor);
  EXPECT_TRUE(instrumental.warnings.empty());
  EXPECT_EQ(instrumental.assumptions.size(), 1U);
}

}  // namespace tremor_test
}  // namespace mbk::analyse
