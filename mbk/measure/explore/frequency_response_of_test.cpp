#include "mbk/measure/explore/frequency_response_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace frequency_response_of_test {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kStep = 0.01;

std::vector<WarningCode> codes(const FrequencyResponseEstimate& found) {
  std::vector<WarningCode> of;
  for (const Warning& warning : warnings_of(found)) of.push_back(warning.code);
  return of;
}

ExplorationTrial periodic_trial(unsigned seed, double noise, double cubic = 0.0) {
  const Vector u = periodic_signal(odd_lines(39), 200, 1000, seed);
  const Vector y = 2.0 * u + cubic * u.cwiseProduct(u.cwiseProduct(u)) + noise * white_noise(1000, seed + 99);
  return trial_of(u, y, kStep, u);
}

TEST(FrequencyResponse, IsByTheFirstMethodThatTheDataAllow) {
  const std::vector<ExplorationTrial> several = {periodic_trial(1, 0.1), periodic_trial(2, 0.1)};
  const auto robust = frequency_response(several);
  ASSERT_TRUE(robust.has_value());
  EXPECT_EQ(robust->method, FrequencyResponseMethod::robust);
  EXPECT_THAT(robust->method_rule, AllOf(HasSubstr(" 2 s"), HasSubstr("2 realisations")));
  const auto fast = frequency_response({several.data(), 1});
  EXPECT_EQ(fast->method, FrequencyResponseMethod::fast);
  const Vector u = white_noise(4000, 3);
  const auto any = trial_of(u, u, kStep);
  const auto local = frequency_response({&any, 1});
  EXPECT_EQ(local->method, FrequencyResponseMethod::local_polynomial);
  EXPECT_THAT(local->method_rule, HasSubstr("input"));
  Matrix r(4000, 2);
  r.col(0) = periodic_signal(odd_lines(39), 200, 4000, 5);
  r.col(1) = periodic_signal(odd_lines(39), 200, 4000, 6);
  const auto one = trial_of(r, r + 0.1 * white_noise(4000, 2, 7), kStep, r);
  const auto welch = frequency_response({&one, 1});
  ASSERT_TRUE(welch.has_value()) << welch.error().line();
  EXPECT_EQ(welch->method, FrequencyResponseMethod::welch);
  EXPECT_THAT(welch->method_rule, HasSubstr("two inputs"));
}

TEST(FrequencyResponse, IsByTheMethodThatIsAskedForOrRefused) {
  const std::vector<ExplorationTrial> several = {periodic_trial(1, 0.1), periodic_trial(2, 0.1)};
  for (const auto method : {FrequencyResponseMethod::welch, FrequencyResponseMethod::fast}) {
    const auto found = frequency_response(several, {.method = method});
    ASSERT_TRUE(found.has_value()) << found.error().line();
    EXPECT_EQ(found->method, method);
  }
  const auto robust = frequency_response({several.data(), 1}, {.method = FrequencyResponseMethod::robust});
  ASSERT_FALSE(robust.has_value());
  EXPECT_THAT(robust.error().line(), HasSubstr("realisation"));
  // Lines 10 Hz apart: around each there is no other that would tell the response from a transient.
  const Vector u = periodic_signal(odd_lines(9), 20, 1000, 4);
  const auto far_apart = trial_of(u, 2.0 * u + 0.1 * white_noise(1000, 8), kStep, u);
  const auto local = frequency_response({&far_apart, 1}, {.method = FrequencyResponseMethod::local_polynomial});
  ASSERT_FALSE(local.has_value());
  EXPECT_THAT(local.error().line(), AllOf(HasSubstr("--method"), HasSubstr("welch")));
}

TEST(FrequencyResponse, WarnsOfWhatItsUserMustKnow) {
  std::vector<ExplorationTrial> quiet, loud, hard;
  for (unsigned k = 0; k < 6; ++k) {
    quiet.push_back(periodic_trial(10 + k, 0.1));
    loud.push_back(periodic_trial(10 + k, 100.0));
    hard.push_back(periodic_trial(10 + k, 0.1, 0.01));
  }
  EXPECT_TRUE(codes(*frequency_response(quiet)).empty());
  EXPECT_THAT(codes(*frequency_response(loud)), Contains(WarningCode::low_coherence));
  EXPECT_THAT(codes(*frequency_response(hard)), Contains(WarningCode::nonlinear_distortion));
  EXPECT_THAT(codes(*frequency_response({quiet.data(), 3})), Contains(WarningCode::few_realisations));
  EXPECT_THAT(codes(*frequency_response({quiet.data(), 4})), Not(Contains(WarningCode::few_realisations)));
}

}  // namespace frequency_response_of_test
}  // namespace mbk::explore
