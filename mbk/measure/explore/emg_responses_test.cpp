#include "mbk/measure/explore/emg_responses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/emg.h"
#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace emg_responses_test {

constexpr double kT = 0.0005;
constexpr Index kEvery = 2000;  ///< samples from one perturbation to the next

EmgProcessing usual() {
  return *emg_processing_at(Hertz(1.0 / kT), {});
}

/// Noise in the band whose amplitude is `ratio` times as large from `latency` after each onset on, for `length`.
Vector emg(Index samples, const std::vector<Index>& onsets, double ratio, double latency, double length,
           std::uint64_t seed) {
  numeric::Random random(seed);
  Vector x(samples);
  for (double& value : x) value = 1e-5 * random.normal();
  x = *emg_band(x, usual());
  for (const Index onset : onsets) {
    const auto from = onset + static_cast<Index>(std::ceil(latency / kT));
    x.segment(from, std::llround(length / kT)) *= ratio;
  }
  return x;
}

std::vector<Index> every_second(Index count) {
  std::vector<Index> onsets;
  for (Index g = 0; g < count; ++g) onsets.push_back((g + 1) * kEvery);
  return onsets;
}

/// Epochs of one muscle.
Matrix epochs(Index trials, double ratio, double latency, std::uint64_t seed) {
  const auto onsets = every_second(trials);
  const Vector x = emg((trials + 1) * kEvery + 1000, onsets, ratio, latency, 0.3, seed);
  Matrix rectified(600, trials);
  for (Index g = 0; g < trials; ++g) {
    rectified.col(g) = x.segment(onsets[static_cast<std::size_t>(g)] - 200, 600).cwiseAbs();
  }
  return rectified;
}

bool holds(const Interval& interval, double truth) {
  return interval.first <= truth && truth <= interval.second;
}

bool responds(const EmgWindowResponse& one) {
  return one.response != EmgChange::none;
}

/// Whether a share may be as expected: the Clopper–Pearson interval at 99.9 % reaches the range.
void expect_share(int hits, int trials, double low, double high, const char* what) {
  const auto [least, most] = numeric::binomial_interval(hits, trials, 0.999);
  EXPECT_LE(least, high) << what << ": " << hits << " of " << trials;
  EXPECT_GE(most, low) << what << ": " << hits << " of " << trials;
}

TEST(EmgResponse, HasTheLatencyAndRatiosWithinTheirIntervals) {
  constexpr int kRuns = 120;
  constexpr double kWithin = 0.003;  // [s]
  int held = 0, close = 0, ratios = 0;
  for (int run = 0; run < kRuns; ++run) {
    const double latency = 0.025 + 0.02 * run / kRuns;
    const auto found = emg_response(epochs(10, 2.0, latency, 100 + static_cast<std::uint64_t>(run)), kT, {}, 1);
    ASSERT_TRUE(found) << found.error().line();
    ASSERT_EQ(found->windows.size(), 3u);
    ASSERT_TRUE(found->latency) << run;
    held += holds(found->latency->interval95, latency) ? 1 : 0;
    close += std::abs(found->latency->value - latency) <= kWithin ? 1 : 0;
    ratios += holds(found->windows[1].interval95, 2.0) ? 1 : 0;
  }
  expect_share(held, kRuns, 0.92, 0.98, "latency inside its interval");
  expect_share(ratios, kRuns, 0.92, 0.98, "ratio inside its interval");
  expect_share(close, kRuns, 0.95, 1.0, "latency within 3 ms");
}

TEST(EmgResponse, IsHardlyEverSaidWhereThereIsNone) {
  constexpr int kRuns = 120;
  int said = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto found = emg_response(epochs(10, 1.0, 0.03, 900 + static_cast<std::uint64_t>(run)), kT, {}, 1);
    ASSERT_TRUE(found);
    const bool any = std::ranges::any_of(found->windows, responds);
    said += any ? 1 : 0;
    EXPECT_TRUE(any || !found->latency);
  }
  expect_share(said, kRuns, 0.0, 0.05, "false responses");
}

TEST(EmgResponse, OfALongLatencyOnlyIsNoShortLatencyResponse) {
  const auto found = emg_response(epochs(20, 2.0, 0.06, 3), kT, {}, 1);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->windows[0].response, EmgChange::none);
  EXPECT_EQ(found->windows[1].response, EmgChange::increase);
  ASSERT_TRUE(found->latency);
  EXPECT_NEAR(found->latency->value, 0.06, 0.003);
}

TEST(EmgResponse, MayBeADecreaseWithoutALatency) {
  const auto found = emg_response(epochs(20, 0.4, 0.02, 3), kT, {}, 1);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->windows[1].response, EmgChange::decrease);
  EXPECT_FALSE(found->latency);
}

TEST(EmgResponse, IsReproducible) {
  const Matrix rectified = epochs(10, 2.0, 0.03, 3);
  const auto one = emg_response(rectified, kT, {}, 1), other = emg_response(rectified, kT, {}, 1);
  EXPECT_EQ(one->windows[0].interval95, other->windows[0].interval95);
  EXPECT_EQ(one->latency->interval95, other->latency->interval95);
}

TEST(EmgResponse, NeedsFiveTrialsAndRisingWindows) {
  EXPECT_FALSE(emg_response(epochs(4, 2.0, 0.03, 3), kT, {}, 1));
  EmgOptions falling;
  falling.edges_s = {0.05, 0.02};
  EXPECT_FALSE(emg_response(epochs(10, 2.0, 0.03, 3), kT, falling, 1));
}

TEST(MotionOnsets, AreWhereAConstantAccelerationBegins) {
  const auto onsets = every_second(6);
  Matrix position = Matrix::Zero(7 * kEvery, 1);
  numeric::Random random(4);
  for (Index i = 0; i < position.rows(); ++i) position(i, 0) = 1e-5 * random.normal();
  for (std::size_t g = 0; g < onsets.size(); ++g) {
    const double sign = g % 2 == 0 ? 1.0 : -1.0;
    for (Index k = 0; k < 1000; ++k) {  // 40 rad/s² for 50 ms, then held; back at once, which is a movement of its own
      const double t = std::min(static_cast<double>(k) * kT, 0.05);
      position(onsets[g] + k, 0) += sign * 20.0 * t * t;
    }
  }
  const auto found = motion_onsets(position, kT, 200);
  std::vector<Onset> away;
  std::ranges::copy_if(found, std::back_inserter(away),
                       [](const Onset& one) { return one.sample % kEvery < 500 || one.sample % kEvery > 1500; });
  ASSERT_EQ(away.size(), onsets.size());
  constexpr Index kWithin = 4;  // samples: 2 ms
  for (std::size_t g = 0; g < onsets.size(); ++g) {
    EXPECT_LE(std::abs(away[g].sample - onsets[g]), kWithin) << away[g].sample << " " << onsets[g];
    EXPECT_NEAR(away[g].step[0], g % 2 == 0 ? 0.05 : -0.05, 2e-4);
  }
}

TEST(PerturbationOnsets, OfPulsesPointWhereThePulseGoes) {
  Matrix reference = Matrix::Zero(3 * kEvery, 2);
  reference.block(kEvery, 1, 100, 1).setConstant(-0.3);  // shorter than a rest: the levels before and after are equal
  const auto found = perturbation_onsets(trial_of(reference, reference, kT, reference), 200);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].sample, kEvery);
  EXPECT_EQ(found[0].step, (Vector{{0.0, -0.3}}));
}

struct Made {
  std::vector<Recording> recordings;
  std::vector<EmgRecording> sources;
};

/// Perturbations along + and − by turns, to which emg_biceps responds along + only and emg_triceps never.
Made make(std::size_t recordings, Index onsets_each) {
  Made made;
  const Index samples = (onsets_each + 1) * kEvery;
  for (std::size_t r = 0; r < recordings; ++r) {
    std::vector<Index> all = every_second(onsets_each), extension;
    for (std::size_t g = 0; g < all.size(); g += 2) extension.push_back(all[g]);
    Recording recording;
    recording.time = Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) * kT);
    const auto add = [&](const char* name, Vector values) {
      recording.channels.push_back({name, "V", "", std::move(values)});
    };
    add("emg_biceps", emg(samples, extension, 3.0, 0.03, 0.04, 10 * r + 1));
    add("emg_triceps", emg(samples, {}, 1.0, 0.0, 0.0, 10 * r + 2));
    add("emg_dead", Vector::Zero(samples));
    if (r == 0) add("emg_once", emg(samples, {}, 1.0, 0.0, 0.0, 5));
    made.recordings.push_back(std::move(recording));
  }
  for (const Recording& recording : made.recordings) {
    EmgRecording source{&recording, {}};
    for (Index g = 0; g < onsets_each; ++g) {
      source.onsets.push_back({(g + 1) * kEvery, Vector::Constant(1, g % 2 == 0 ? 0.1 : -0.1)});
    }
    made.sources.push_back(std::move(source));
  }
  return made;
}

TEST(EmgResponses, ArePooledOverRecordingsByDirection) {
  const Made made = make(2, 12);
  EmgOptions options;
  options.mvc["emg_biceps"] = 1e-3;
  const auto found = emg_responses(made.sources, kT, options);
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_EQ(found->directions.size(), 2u);
  EXPECT_EQ(found->directions[0].direction[0], 1.0);
  EXPECT_EQ(found->directions[0].trials, 12);
  EXPECT_EQ(found->onsets, 24);
  ASSERT_EQ(found->channels.size(), 3u);  // emg_once is not in both
  EXPECT_EQ(found->notes.size(), 1u);
  const EmgChannelEstimate& biceps = found->channels[0];
  ASSERT_EQ(biceps.directions.size(), 2u);
  EXPECT_EQ(biceps.mvc, 1e-3);
  EXPECT_TRUE(biceps.findings.empty());
  ASSERT_TRUE(biceps.directions[0].latency);
  EXPECT_NEAR(biceps.directions[0].latency->value, 0.03, 0.003);
  EXPECT_FALSE(biceps.directions[1].latency);
  EXPECT_TRUE(std::ranges::none_of(biceps.directions[1].windows, responds));
  EXPECT_TRUE(std::ranges::none_of(found->channels[1].directions[0].windows, responds));
  EXPECT_FALSE(found->channels[2].usable);
  EXPECT_TRUE(found->channels[2].directions.empty());
  // The curve is highest within the response, at about three times the background.
  Index peak = 0;
  const double top = biceps.directions[0].curve.maxCoeff(&peak);
  EXPECT_GT(found->curve_time[peak], 0.03);
  EXPECT_LT(found->curve_time[peak], 0.07);
  EXPECT_NEAR(top / biceps.directions[0].background, 3.0, 0.6);
}

TEST(EmgResponses, OmitOnsetsWithoutAWholeEpoch) {
  Made made = make(1, 12);
  made.sources[0].onsets.front().sample = 50;
  made.sources[0].onsets[6].sample = made.sources[0].onsets[5].sample + 100;
  const auto found = emg_responses(made.sources, kT, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->omitted, 2);
  EXPECT_EQ(found->onsets, 10);
}

TEST(EmgResponses, OfAnArtefactOrOfAClockThatIsEarlyAreNone) {
  const auto biceps_of = [](const Made& made) { return emg_responses(made.sources, kT, {})->channels[0]; };
  Made made = make(1, 24);
  Vector& signal = made.recordings[0].channels[0].values;
  const double size = 20.0 * signal.cwiseAbs().mean();
  for (const Onset& onset : made.sources[0].onsets) signal.segment(onset.sample, 4) << size, size, -size, -size;
  const EmgChannelEstimate struck = biceps_of(made);
  EXPECT_FALSE(struck.usable);
  ASSERT_FALSE(struck.findings.empty());
  EXPECT_EQ(struck.findings.back().problem, EmgProblem::artefact);
  made = make(1, 24);
  for (Onset& onset : made.sources[0].onsets) onset.sample += std::llround(0.027 / kT);  // 3 ms before the response
  const EmgChannelEstimate early = biceps_of(made);
  EXPECT_FALSE(early.usable);
  ASSERT_FALSE(early.findings.empty());
  EXPECT_EQ(early.findings.back().problem, EmgProblem::too_early);
}

TEST(EmgResponses, AreOfAChannelCalledEmgToo) {
  Made made = make(1, 12);
  made.recordings[0].channels.resize(1);
  made.recordings[0].channels[0].name = "emg";
  const auto found = emg_responses(made.sources, kT, {});
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->channels.at(0).name, "emg");
}

TEST(EmgResponses, KnowTheMusclesOfTheMvc) {
  EmgOptions options;
  options.mvc["emg_nosuch"] = 1e-3;
  EXPECT_FALSE(emg_responses(make(1, 12).sources, kT, options));
}

TEST(EmgResponses, NeedEmgAndOnsets) {
  Made made = make(1, 12);
  made.sources[0].onsets.resize(2);
  EXPECT_FALSE(emg_responses(made.sources, kT, {}));
  made = make(1, 12);
  made.recordings[0].channels.clear();
  EXPECT_FALSE(emg_responses(made.sources, kT, {}));
}

}  // namespace emg_responses_test
}  // namespace mbk::explore
