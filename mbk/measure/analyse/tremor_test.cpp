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
  double other_axis_hz = 0.0;  ///< a line of reference_y that moves both axes' forces
  double ringing_hz = 0.0;     ///< a step of the reference makes the force ring
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
      const double other = making.other_axis_hz > 0.0 ? std::sin(2.0 * M_PI * making.other_axis_hz * t) : 0.0;
      // Every two seconds a step there and back, and what a filter with little damping makes of it.
      const double since = std::fmod(t, 2.0), side = std::fmod(t, 4.0) < 2.0 ? 1.0 : -1.0;
      const double step = making.ringing_hz > 0.0 ? side : 0.0;
      const double ringing = step * std::exp(-2.0 * since) * std::cos(2.0 * M_PI * making.ringing_hz * since);
      channel.values[i] = force ? 2.0 * sine + 1.5 * other + 2.0 * (step - ringing) +
                                      making.tremor * std::sin(2.0 * M_PI * making.tremor_hz * t) +
                                      making.noise * normal(random)
                          : channel.name == "reference_y" ? 0.01 * (sine + other + step)
                          : channel.name == "reference_x" ? 0.01 * (sine + step)
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

TEST(Tremor, IsNotWhatTheOtherAxisDoes) {
  const auto found = tested({.other_axis_hz = 5.0});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->contradicted) << found->frequency_hz;
}

TEST(Tremor, IsNotTheRingingOfAFilterBehindTheReference) {
  for (const double ringing : {3.5, 6.0}) {
    const auto found = tested({.ringing_hz = ringing});
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->contradicted) << found->frequency_hz;
    const auto with_tremor = tested({.tremor = 1.5, .tremor_hz = 9.0, .ringing_hz = ringing});
    EXPECT_TRUE(with_tremor->contradicted) << ringing;
    EXPECT_NEAR(with_tremor->frequency_hz, 9.0, 0.3);
  }
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
