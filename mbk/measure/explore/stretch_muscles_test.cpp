#include "mbk/measure/explore/stretch_muscles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/random.h"
#include "mbk/measure/explore/stretch.h"

namespace mbk::explore {
namespace stretch_muscles_test {

constexpr double kRate = 1000.0, kFrom = 60.0 * kDegree, kTo = 150.0 * kDegree;
constexpr double kLatency = 0.03, kRest = 0.8;

/// EMG is noise of amplitude 1 + gain (θ − λ + μ θ')₊, a latency later, with λ that varies between stretches.
struct Muscle {
  double gain = 60.0, threshold = 118.0 * kDegree, shift = 0.1, spread = 2.0 * kDegree;
};

struct Made {
  Recording recording;
  ExplorationTrial trial;
};

void append_movement(double from, double to, double speed, std::vector<double>& x, std::vector<double>& v,
                     double rest = kRest) {
  const double a = 30.0, ramp = speed / a, way = std::abs(to - from), sign = to > from ? 1.0 : -1.0;
  const double duration = way / speed + ramp;
  for (int i = 0; i < static_cast<int>((rest + duration) * kRate); ++i) {
    const double t = i / kRate - rest, left = duration - t;
    double s = 0.0, rate = 0.0;
    if (t > duration - ramp) {
      s = way - 0.5 * a * left * left, rate = a * left;
    } else if (t > ramp) {
      s = 0.5 * speed * ramp + speed * (t - ramp), rate = speed;
    } else if (t > 0.0) {
      s = 0.5 * a * t * t, rate = a * t;
    }
    x.push_back(from + sign * s);
    v.push_back(sign * rate);
  }
}

Made made(const Muscle& muscle, std::uint64_t seed, int repetitions = 5,
          const std::vector<double>& speeds = {20.0, 60.0, 100.0, 140.0, 180.0}, double rest_before_return = kRest) {
  numeric::Random random(seed);
  std::vector<double> x, v, threshold;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (const double speed : speeds) {
      append_movement(kFrom, kTo, speed * kDegree, x, v);
      append_movement(kTo, kFrom, speed * kDegree, x, v, rest_before_return);
      threshold.resize(x.size(), muscle.threshold + muscle.spread * random.normal());
    }
  }
  const auto n = static_cast<Index>(x.size());
  Made all;
  Vector emg(n), relaxed(n), time(n);
  const auto late = static_cast<std::size_t>(kLatency * kRate);
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::size_t then = k < late ? 0 : k - late;
    const double beyond = v[then] > 0.0 ? std::max(0.0, x[then] - threshold[then] + muscle.shift * v[then]) : 0.0;
    emg[i] = 1e-5 * (1.0 + muscle.gain * beyond) * random.normal();
    relaxed[i] = 1e-5 * random.normal();
    time[i] = static_cast<double>(i) / kRate;
  }
  all.trial.axes = 1;
  all.trial.motion = Motion::rotation;
  all.trial.sample_time = 1.0 / kRate;
  all.trial.input = Vector::Map(x.data(), n);
  all.trial.output = 0.3 * Vector::Map(v.data(), n);
  for (Index i = 0; i < n; ++i) all.trial.output(i, 0) += 0.05 * random.normal();
  all.recording.time = time;
  all.recording.channels = {Channel{"emg_biceps", "V", "", emg}, Channel{"emg_triceps", "V", "", relaxed}};
  return all;
}

StretchEstimate found_in(const Made& made) {
  std::vector<Warning> warnings;
  auto found = stretch({&made.trial, 1}, {}, warnings);
  EXPECT_TRUE(found) << found.error().line();
  const Recording* const recording = &made.recording;
  EXPECT_TRUE(add_stretch_muscles({&recording, 1}, {&made.trial, 1}, *found));
  return *found;
}

TEST(StretchMuscles, ThresholdAndShiftAreThoseOfTheReflex) {
  const Muscle muscle;
  const auto found = found_in(made(muscle, 3));
  const StretchDirection& up = found.directions.front();
  ASSERT_EQ(up.direction, 1);
  ASSERT_EQ(up.muscles.size(), 2u);
  const StretchMuscle& biceps = up.muscles.front();
  EXPECT_EQ(biceps.name, "emg_biceps");
  ASSERT_EQ(biceps.speeds.size(), 5u);
  for (const StretchMuscleSpeed& one : biceps.speeds) {
    EXPECT_EQ(one.stretches, 5);
    EXPECT_EQ(one.onsets, 5);
    ASSERT_TRUE(one.onset_angle);
    EXPECT_NEAR(one.onset_angle->value, muscle.threshold + (kLatency - muscle.shift) * one.speed, 3.0 * kDegree);
  }
  ASSERT_TRUE(biceps.threshold) << biceps.threshold_note;
  EXPECT_NEAR(biceps.threshold->value, muscle.threshold, 3.0 * kDegree);
  ASSERT_TRUE(biceps.threshold->interval95);
  EXPECT_LT(biceps.threshold->interval95->first, muscle.threshold);
  EXPECT_GT(biceps.threshold->interval95->second, muscle.threshold);
  EXPECT_NEAR(*biceps.shift, kLatency - muscle.shift, 0.03);
}

TEST(StretchMuscles, AReactionAtAConstantTimeIsNoThreshold) {
  // 0.2 s after the start: the onset is where the stretch begins, and 0.2 s times the speed.
  const auto found = found_in(made({.gain = 400.0, .threshold = kFrom, .shift = -0.2, .spread = 0.0}, 3));
  const StretchMuscle& biceps = found.directions.front().muscles.front();
  EXPECT_FALSE(biceps.threshold);
  EXPECT_TRUE(biceps.responds());
}

TEST(StretchMuscles, RelaxedMuscleDoesNotRespond) {
  const auto found = found_in(made({}, 4));
  for (const StretchDirection& one : found.directions) {
    EXPECT_FALSE(one.muscles[1].responds());
    EXPECT_FALSE(one.muscles[1].threshold);
    EXPECT_TRUE(one.muscles[1].usable);
  }
  EXPECT_FALSE(found.directions[1].muscles[0].responds()) << "the return does not stretch it";
}

TEST(StretchMuscles, LateOnsetsHiddenByTheEndOfTheRangeGiveNoThreshold) {
  const auto found = found_in(made({.threshold = 153.0 * kDegree, .spread = 6.0 * kDegree}, 5));
  const StretchMuscle& biceps = found.directions.front().muscles.front();
  EXPECT_TRUE(biceps.responds());
  EXPECT_FALSE(biceps.threshold);
  EXPECT_NE(biceps.threshold_note.find("three speeds are needed"), std::string::npos) << biceps.threshold_note;
}

TEST(StretchMuscles, OneMovementArtefactIsNoOnset) {
  Made all = made({.gain = 0.0}, 6);
  all.recording.channels[0].values[1300] = 3e-4;  // one sample, 0.4 s after the first stretch begins
  EXPECT_FALSE(found_in(all).directions.front().muscles.front().responds());
}

TEST(StretchMuscles, DeadChannelIsNotUsable) {
  Made all = made({}, 7);
  all.recording.channels[1].values.setZero();
  const auto found = found_in(all);
  const StretchMuscle& triceps = found.directions.front().muscles[1];
  EXPECT_FALSE(triceps.usable);
  EXPECT_NE(triceps.reason.find("never changes"), std::string::npos);
}

TEST(StretchMuscles, WithoutRestBeforeTheReturnsNothingIsSaidOfThem) {
  const auto found = found_in(made({}, 9, 5, {20.0, 60.0, 100.0}, 0.05));
  for (const StretchMuscle& muscle : found.directions[1].muscles) {
    EXPECT_FALSE(muscle.usable);
    EXPECT_NE(muscle.reason.find("rests of 200 ms"), std::string::npos) << muscle.reason;
  }
  EXPECT_TRUE(found.directions[0].muscles[0].usable);
}

TEST(StretchMuscles, WithoutEmgNothingChanges) {
  Made all = made({}, 8);
  all.recording.channels.clear();
  EXPECT_TRUE(found_in(all).directions.front().muscles.empty());
}

}  // namespace stretch_muscles_test
}  // namespace mbk::explore
