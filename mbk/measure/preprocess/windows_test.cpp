#include "mbk/measure/preprocess/windows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"

namespace mbk::preprocess {
namespace windows_test {

using testing::HasSubstr;

constexpr Hertz kRate{1000.0};
constexpr Index kHalf = 50;  // of the published smoothing window, W = 101

/// An even clock.
Clock clock(Index samples, Hertz rate = kRate) {
  return {Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) / rate.value, rate};
}

/// A sine of 0.5 Hz and amplitude 1, held for `hold` samples at a time.
Matrix sine(Index samples, Index hold = 1) {
  Matrix reference(samples, 1);
  for (Index i = 0; i < samples; ++i) {
    reference(i, 0) = std::sin(2.0 * std::numbers::pi * 0.5 * static_cast<double>(i - i % hold) / kRate.value);
  }
  return reference;
}

/// At 0.3 but for the runs [begin, end), where it stands at 0.305; the second column never moves.
Matrix pulses(Index samples, const std::vector<std::pair<Index, Index>>& runs) {
  Matrix reference = Matrix::Constant(samples, 2, 0.3);
  for (const auto& [begin, end] : runs) reference.col(0).segment(begin, end - begin).setConstant(0.305);
  return reference;
}

/// `count` runs of 1500 samples, one every 3000, the first at `first`.
std::vector<std::pair<Index, Index>> train(Index first, int count) {
  std::vector<std::pair<Index, Index>> runs;
  for (int k = 0; k < count; ++k) runs.emplace_back(first + 3000 * k, first + 3000 * k + 1500);
  return runs;
}

TEST(DetectProtocol, StepsAreUnderdamped) {
  EXPECT_EQ(detect_protocol(pulses(20000, train(1000, 6))).protocol, Protocol::underdamped);
}

TEST(DetectProtocol, AContinuousReferenceIsSinusoidal) {
  EXPECT_EQ(detect_protocol(sine(20000)).protocol, Protocol::sinusoidal);
}

TEST(DetectProtocol, ASlowReferenceHeldForTenSamplesIsSinusoidal) {
  EXPECT_EQ(detect_protocol(sine(20000, 10)).protocol, Protocol::sinusoidal);
}

TEST(DetectProtocol, AConstantReferenceIsNone) {
  const ProtocolFinding found = detect_protocol(Matrix(Matrix::Constant(1000, 2, 0.3)));
  EXPECT_EQ(found.protocol, Protocol::free);
  EXPECT_NE(found.rule, detect_protocol(Matrix()).rule);
}

TEST(DetectProtocol, NoReferenceIsFree) {
  EXPECT_EQ(detect_protocol(Matrix()).protocol, Protocol::free);
}

TEST(DetectProtocol, OneMovingColumnIsEnough) {
  Matrix reference = Matrix::Zero(20000, 2);
  reference.col(1) = sine(20000);
  EXPECT_EQ(detect_protocol(reference).protocol, Protocol::sinusoidal);
}

// Reference mode: the sample numbers of the published procedure.

TEST(ReferenceWindows, SinusoidalIsSamples11999To61999) {
  const WindowPlan plan = reference_windows(Protocol::sinusoidal, sine(62100), clock(62100), {}, kHalf).value();
  ASSERT_EQ(plan.cuts.size(), 1u);
  EXPECT_EQ(plan.cuts[0].begin, 11999);
  EXPECT_EQ(plan.cuts[0].end, 62000);
  EXPECT_EQ(plan.trim, 1);  // the first centre is s₀ + h + 1
}

TEST(ReferenceWindows, SinusoidalIdentifiesOnTheFirst40000Centres) {
  const WindowPlan plan = reference_windows(Protocol::sinusoidal, sine(62100), clock(62100), {}, kHalf).value();
  ASSERT_EQ(plan.cuts[0].keep.size(), 2u);
  const Index first = 11999 + kHalf + 1;
  EXPECT_EQ(plan.cuts[0].keep[0].end, first + 40000);
  EXPECT_EQ(plan.cuts[0].keep[0].purpose, Purpose::identification);
  EXPECT_EQ(plan.cuts[0].keep[1].begin, first + 40000);
  EXPECT_EQ(plan.cuts[0].keep[1].end, 62000);
  EXPECT_EQ(plan.cuts[0].keep[1].purpose, Purpose::validation);
}

TEST(ReferenceWindows, UnderdampedFiltersFromSample15999ToTheEndAsOnePiece) {
  const Index n = 70000;
  const WindowPlan plan =
      reference_windows(Protocol::underdamped, pulses(n, train(17000, 16)), clock(n), {}, kHalf).value();
  ASSERT_EQ(plan.cuts.size(), 1u);
  EXPECT_EQ(plan.cuts[0].begin, 15999);
  EXPECT_EQ(plan.cuts[0].end, n);
}

TEST(ReferenceWindows, UnderdampedKeepsTheDisplacedRunsAndValidatesFromTheNinthOnset) {
  const Index n = 70000;
  const auto runs = train(17000, 16);
  const WindowPlan plan = reference_windows(Protocol::underdamped, pulses(n, runs), clock(n), {}, kHalf).value();
  ASSERT_EQ(plan.cuts[0].keep.size(), 16u);
  for (std::size_t k = 0; k < 16; ++k) {
    const Segment& keep = plan.cuts[0].keep[k];
    EXPECT_EQ(keep.begin, runs[k].first) << k;
    EXPECT_EQ(keep.end, runs[k].second) << k;
    EXPECT_EQ(keep.purpose, k < 8 ? Purpose::identification : Purpose::validation) << k;
  }
}

TEST(ReferenceWindows, ARunUnderWayAtTheFirstCentreIsNoOnset) {
  const Index n = 70000, first_centre = 15999 + kHalf + 1;
  std::vector<std::pair<Index, Index>> runs = train(19000, 15);
  runs.insert(runs.begin(), {first_centre - 20, first_centre + 800});  // begins after s₀ and before the first centre
  const WindowPlan plan = reference_windows(Protocol::underdamped, pulses(n, runs), clock(n), {}, kHalf).value();
  ASSERT_EQ(plan.cuts[0].keep.size(), 16u);
  EXPECT_EQ(plan.cuts[0].keep[0].begin, first_centre);
  EXPECT_EQ(plan.cuts[0].keep[8].purpose, Purpose::identification);  // the eighth onset
  EXPECT_EQ(plan.cuts[0].keep[9].purpose, Purpose::validation);      // the ninth
}

TEST(ReferenceWindows, ARunThatBeginsRightAfterTheFirstCentreIsAnOnset) {
  const Index n = 70000, first_centre = 15999 + kHalf + 1;
  std::vector<std::pair<Index, Index>> runs = train(19000, 15);
  runs.insert(runs.begin(), {first_centre + 1, first_centre + 800});
  const WindowPlan plan = reference_windows(Protocol::underdamped, pulses(n, runs), clock(n), {}, kHalf).value();
  EXPECT_EQ(plan.cuts[0].keep[7].purpose, Purpose::identification);
  EXPECT_EQ(plan.cuts[0].keep[8].purpose, Purpose::validation);
}

TEST(ReferenceWindows, RefusesARecordingThatEndsBeforeTheWindow) {
  const auto plan = reference_windows(Protocol::sinusoidal, sine(9000), clock(9000), {}, kHalf);
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().kind, ErrorKind::data);
  EXPECT_THAT(plan.error().line(), HasSubstr(" 9 s"));
  EXPECT_THAT(plan.error().remedy, HasSubstr("--from"));
}

TEST(ReferenceWindows, SaysNothingOfASplitThatARecordingDoesNotReach) {
  const auto plan = reference_windows(Protocol::sinusoidal, sine(40000), clock(40000), {}, kHalf);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->cuts[0].keep.size(), 1u);  // all of it identifies
  EXPECT_FALSE(plan->split_s.has_value());
}

TEST(ReferenceWindows, ABadSplitIsNotBlamedOnTheLengthOfTheRecording) {
  const auto plan = reference_windows(Protocol::sinusoidal, sine(62100), clock(62100), {.split_s = 70.0}, kHalf);
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, AllOf(HasSubstr("--split"), HasSubstr("70 s")));
}

TEST(ReferenceWindows, GivenLimitsReplaceThePublishedOnes) {
  const WindowPlan plan = reference_windows(Protocol::sinusoidal, sine(30000), clock(30000),
                                            {.from_s = 5.0, .split_s = 15.0, .to_s = 20.0}, kHalf)
                              .value();
  EXPECT_EQ(plan.cuts[0].begin, 5000);
  EXPECT_EQ(plan.cuts[0].end, 20000);
  EXPECT_EQ(plan.cuts[0].keep[1].begin, 15000);
  EXPECT_EQ(plan.split_s, 15.0);
}

// mbk's own windows.

TEST(DefaultWindows, LeavesTheMovingInOut) {
  Matrix reference = sine(40000);
  // The hand is brought in from 5 (five times the steady-state range) over 4 s.
  for (Index i = 0; i < 4000; ++i) reference(i, 0) = 5.0 * (1.0 - static_cast<double>(i) / 4000.0);
  const WindowPlan plan = default_windows(Protocol::sinusoidal, reference, clock(40000), {}).value();
  // A quarter of the range (2) beyond the range [−1, 1] is allowed: 5 (1 − i/4000) ≤ 1.5 from sample 2800 on.
  EXPECT_NEAR(static_cast<double>(plan.cuts[0].begin), 2800.0, 1.0);
  EXPECT_EQ(plan.cuts[0].end, 40000);
}

TEST(DefaultWindows, LeavesTheStillEndsOut) {
  Matrix reference = Matrix::Zero(30000, 1);
  reference.middleRows(5000, 20000) = sine(20000);
  const WindowPlan plan = default_windows(Protocol::sinusoidal, reference, clock(30000), {}).value();
  EXPECT_NEAR(static_cast<double>(plan.cuts[0].begin), 5000.0, 1.0);
  EXPECT_NEAR(static_cast<double>(plan.cuts[0].end), 25000.0, 1.0);
}

TEST(DefaultWindows, SinusoidalIdentifiesOnTheFirstFourFifths) {
  const WindowPlan plan = default_windows(Protocol::sinusoidal, sine(20000), clock(20000), {}).value();
  ASSERT_EQ(plan.cuts[0].keep.size(), 2u);
  EXPECT_EQ(plan.cuts[0].keep[0].end, 16000);
  EXPECT_EQ(plan.cuts[0].keep[1].purpose, Purpose::validation);
  EXPECT_EQ(plan.split_s, 16.0);
}

TEST(DefaultWindows, EachPulseIsACutOfItsOwnAndTheFirstHalfIdentifies) {
  const auto runs = train(2000, 5);
  const WindowPlan plan = default_windows(Protocol::underdamped, pulses(20000, runs), clock(20000), {}).value();
  ASSERT_EQ(plan.cuts.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(plan.cuts[k].begin, runs[k].first);
    EXPECT_EQ(plan.cuts[k].end, runs[k].second);
    ASSERT_EQ(plan.cuts[k].keep.size(), 1u);
    EXPECT_EQ(plan.cuts[k].keep[0].purpose, k < 3 ? Purpose::identification : Purpose::validation) << k;
  }
}

TEST(DefaultWindows, RestIsWhereTheReferenceStaysLongestEvenIfTheWindowBeginsInAPulse) {
  const WindowPlan plan =
      default_windows(Protocol::underdamped, pulses(20000, {{0, 1000}, {9000, 10000}}), clock(20000), {}).value();
  ASSERT_EQ(plan.cuts.size(), 2u);
  EXPECT_EQ(plan.cuts[0].end, 1000);
  EXPECT_EQ(plan.cuts[1].begin, 9000);
}

TEST(DefaultWindows, ASplitInSecondsDividesThePulses) {
  const WindowPlan plan =
      default_windows(Protocol::underdamped, pulses(20000, train(2000, 5)), clock(20000), {.split_s = 6.0}).value();
  EXPECT_EQ(plan.cuts[1].keep[0].purpose, Purpose::identification);  // begins at 5 s
  EXPECT_EQ(plan.cuts[2].keep[0].purpose, Purpose::validation);      // at 8 s
}

TEST(DefaultWindows, RefusesAWindowWithoutADisplacement) {
  const auto plan = default_windows(Protocol::underdamped, pulses(20000, {{15000, 16000}}), clock(20000),
                                    {.from_s = 0.0, .to_s = 10.0});
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().remedy, HasSubstr("--from"));
}

TEST(DefaultWindows, NamesTheOptionThatIsOutsideTheRecording) {
  const auto late = default_windows(Protocol::free, sine(20000), clock(20000), {.from_s = 100.0});
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().line(), HasSubstr("--from 100 s"));
  const auto empty = default_windows(Protocol::free, sine(20000), clock(20000), {.from_s = 5.0, .to_s = 4.0});
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().remedy, HasSubstr("--from before --to"));
}

TEST(DefaultWindows, RefusesAReferenceThatNeverRests) {
  Matrix varying(20000, 1);
  for (Index i = 0; i < varying.rows(); ++i) varying(i, 0) = std::sin(0.01 * static_cast<double>(i));
  const auto plan = default_windows(Protocol::underdamped, varying, clock(20000), {});
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("samples"));
  EXPECT_THAT(plan.error().remedy, HasSubstr("--protocol"));
}

TEST(DefaultWindows, FreeTakesEverything) {
  const WindowPlan plan = default_windows(Protocol::free, Matrix(), clock(10000), {}).value();
  EXPECT_EQ(plan.cuts[0].begin, 0);
  EXPECT_EQ(plan.cuts[0].end, 10000);
  EXPECT_EQ(plan.cuts[0].keep[0].end, 8000);
}

TEST(DefaultWindows, LimitsAreSecondsFromTheFirstSample) {
  const WindowPlan plan = default_windows(Protocol::free, Matrix(), clock(10000, Hertz(500.0)),
                                          {.from_s = 2.0, .split_s = 9.0, .to_s = 11.0})
                              .value();
  EXPECT_EQ(plan.cuts[0].begin, 1000);
  EXPECT_EQ(plan.cuts[0].end, 5500);
  EXPECT_EQ(plan.cuts[0].keep[1].begin, 4500);
}

TEST(DefaultWindows, ToMayNameTheEndOfTheRecording) {
  EXPECT_EQ(default_windows(Protocol::free, Matrix(), clock(10000), {.to_s = 10.0})->cuts[0].end, 10000);
}

TEST(DefaultWindows, ASplitOutsideTheSteadyRangeIsRefused) {
  Matrix reference = Matrix::Zero(30000, 1);
  reference.middleRows(5000, 20000) = sine(20000);
  for (const double split : {3.0, 28.0}) {
    const auto plan = default_windows(Protocol::sinusoidal, reference, clock(30000), {.split_s = split});
    ASSERT_FALSE(plan) << split;
    EXPECT_THAT(plan.error().message, HasSubstr("--split"));
  }
}

class BadLimits : public testing::TestWithParam<std::pair<const char*, WindowLimits>> {};
INSTANTIATE_TEST_SUITE_P(
    All, BadLimits,
    testing::Values(std::pair{"Reversed", WindowLimits{.from_s = 6.0, .to_s = 4.0}},
                    std::pair{"Empty", WindowLimits{.from_s = 4.0, .to_s = 4.0}},
                    std::pair{"BehindTheEnd", WindowLimits{.from_s = 30.0}},
                    std::pair{"ToBehindTheEnd", WindowLimits{.to_s = 30.0}},
                    std::pair{"NegativeFrom", WindowLimits{.from_s = -1.0}},
                    std::pair{"NegativeTo", WindowLimits{.to_s = -1.0}},
                    std::pair{"FromNaN", WindowLimits{.from_s = kNaN}}, std::pair{"ToNaN", WindowLimits{.to_s = kNaN}},
                    std::pair{"SplitNaN", WindowLimits{.split_s = kNaN}},
                    std::pair{"Infinite", WindowLimits{.to_s = std::numeric_limits<double>::infinity()}},
                    std::pair{"Huge", WindowLimits{.from_s = 1e300}},
                    std::pair{"SplitBeforeFrom", WindowLimits{.from_s = 5.0, .split_s = 4.0}},
                    std::pair{"SplitAtFrom", WindowLimits{.from_s = 5.0, .split_s = 5.0}},
                    std::pair{"SplitBehindTo", WindowLimits{.split_s = 8.0, .to_s = 7.0}},
                    std::pair{"SplitNegative", WindowLimits{.split_s = -3.0}}),
    [](const auto& limits) { return std::string(limits.param.first); });

TEST_P(BadLimits, AreRefusedInBothModes) {
  const WindowLimits& limits = GetParam().second;
  const auto improved = default_windows(Protocol::free, Matrix(), clock(10000), limits);
  const auto published = reference_windows(Protocol::free, Matrix(), clock(10000), limits, kHalf);
  ASSERT_FALSE(improved);
  ASSERT_FALSE(published);
  EXPECT_THAT(improved.error().message, HasSubstr(limits.split_s                 ? "--split"
                                                  : limits.from_s && limits.to_s ? "empty"
                                                                                 : "10 s"));
  EXPECT_EQ(published.error().message, improved.error().message);
}

TEST_P(BadLimits, AreNamedAsTheUserGaveThem) {
  const WindowLimits& limits = GetParam().second;
  const auto plan = default_windows(Protocol::free, Matrix(), clock(10000), limits);
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, testing::Not(HasSubstr("e+15")));  // a time that nobody gave
}

}  // namespace windows_test
}  // namespace mbk::preprocess
