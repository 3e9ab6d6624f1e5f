#include "mbk/files/recording/stale_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/test_stale_signals.h"

namespace mbk::recording {
namespace stale_samples_test {

using test::held;
using test::in_steps;
using test::multisine;
using test::NamedSignal;
using test::pulses;
using test::sampled;
using test::with_noise;

constexpr Index kSamples = 30000;

Vector median_of(const Vector& values, Index width) {
  const Index half = width / 2, last = values.size() - 1;
  return sampled(values.size(), [&](Index i) {
    const Index from = std::max<Index>(0, i - half), to = std::min(last, i + half);
    return numeric::median(std::vector<double>(values.data() + from, values.data() + to + 1));
  });
}

/// A gear that follows only when the play is taken up.
Vector with_backlash(const Vector& values, double play) {
  double at = values[0];
  return values.unaryExpr([&](double v) {
    at = std::clamp(at, v - play, v + play);
    return at;
  });
}

/// A mass with Coulomb friction, pushed by a spring and a sine.
Vector stick_slip(Index n, double rate) {
  double x = 0.0, v = 0.0;
  return sampled(n, [&](Index i) {
    const double dt = 1.0 / (16.0 * rate);
    for (int k = 0; k < 16; ++k) {
      const double push = 5.0 * std::sin(3.0 * (static_cast<double>(i) / rate + k * dt)) - 60.0 * x - 4.0 * v;
      if (v == 0.0 && std::abs(push) < 2.6) continue;
      const double next = v + dt * (push - std::copysign(2.0, v != 0.0 ? v : push));
      v = next * v < 0.0 ? 0.0 : next;
      x += dt * v;
    }
    return x;
  });
}

/// Contacts of 30 ms, nothing between them.
Vector taps(Index n, double rate) {
  return sampled(n, [&](Index i) {
    const double u = std::fmod(static_cast<double>(i) / rate, 0.7) / 0.03;
    return u < 1.0 ? (8.0 + std::sin(static_cast<double>(i / static_cast<Index>(0.7 * rate)))) *
                         std::sin(std::numbers::pi * u)
                   : 0.0;
  });
}

/// What a sound sensor may record at a rate.
std::vector<NamedSignal> honest(double rate) {
  numeric::Random random(7);
  const Index n = std::min(kSamples, static_cast<Index>(60.0 * rate));
  const auto seconds = [rate](Index i) { return static_cast<double>(i) / rate; };
  const Vector p = multisine(n, rate, 0.01), f = with_noise(multisine(n, rate, 5.0), 0.05, random);
  const Vector triangle = sampled(n, [&](Index i) { return 0.02 * std::abs(std::fmod(0.5 * seconds(i), 2.0) - 1.0); });
  const Vector ramps =
      sampled(n, [&](Index i) { return std::clamp(0.01 * (std::fmod(seconds(i), 8.0) - 1.0), 0.0, 0.02); });
  const Vector reach = sampled(n, [&](Index i) {
    const double u = std::clamp(std::fmod(seconds(i), 4.0) - 1.0, 0.0, 1.0);
    return 0.1 * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  });
  const Vector rest = Vector::Constant(n, 0.3);
  // Differences of an encoder's position over a clock that jitters: one step, a bit more or less.
  const Vector steps = in_steps(multisine(n, rate, 0.4), 4e-4 * 500.0 / rate);
  const Vector velocity = sampled(n, [&](Index i) {
    return i == 0 ? 0.0 : (steps[i] - steps[i - 1]) * rate * (1.0 + (random.uniform() < 0.1 ? 1e-4 : 0.0));
  });
  return {
      {"exact", p},
      {"fine encoder", in_steps(p, 1e-6)},
      {"encoder", in_steps(p, 1e-5)},
      {"coarse encoder", in_steps(p, 1e-4)},
      {"very coarse encoder", in_steps(p, 1e-3)},
      {"encoder with noise of a step", in_steps(with_noise(p, 1e-4, random), 1e-4)},
      {"encoder with noise of three steps", in_steps(with_noise(p, 3e-4, random), 1e-4)},
      {"single precision", p.cast<float>().cast<double>()},
      {"force", f},
      {"force of a converter, noise of a step", in_steps(f, 0.05)},
      {"force of a converter, noise of four steps", in_steps(with_noise(f, 0.2, random), 0.05)},
      {"force of a converter, noise of a fifth of a step",
       in_steps(with_noise(multisine(n, rate, 5.0), 0.01, random), 0.05)},
      {"at rest, noise of a fifth of a step", in_steps(with_noise(rest, 2e-5, random), 1e-4)},
      {"at rest, noise of half a step", in_steps(with_noise(rest, 5e-5, random), 1e-4)},
      {"constant", rest},
      {"position from two encoders that flicker",
       sampled(n,
               [&](Index i) {
                 return 0.39e-6 * std::round(0.3 * random.normal() + 300.0 * p[i]) +
                        1.46e-6 * std::round(0.3 * random.normal() + 200.0 * p[n - 1 - i]);
               })},
      {"velocity from an encoder", velocity},
      {"pulses", pulses(n, rate, 1.0)},
      {"pulses of an encoder", in_steps(pulses(n, rate, 0.01), 1e-5)},
      {"pulses of a coarse encoder", in_steps(pulses(n, rate, 0.01), 1e-4)},
      {"triangle of an encoder", in_steps(triangle, 1e-5)},
      {"triangle of a coarse encoder", in_steps(triangle, 1e-4)},
      {"triangle of a coarse encoder with noise", in_steps(with_noise(triangle, 3e-5, random), 1e-4)},
      {"ramp and hold", ramps},
      {"ramp and hold of an encoder", in_steps(ramps, 1e-5)},
      {"ramp and hold of an encoder with noise", in_steps(with_noise(ramps, 1e-5, random), 1e-5)},
      {"reaches", reach},
      {"reaches of an encoder", in_steps(reach, 1e-5)},
      {"binary sequence",
       sampled(n, [&](Index i) { return std::sin(1.0 + std::floor(i / 12.0) * 2.3) > 0.0 ? 1.0 : -1.0; })},
      {"reaches, one trial behind the other", sampled(n,
                                                      [&](Index i) {
                                                        const double u =
                                                            std::clamp(std::fmod(seconds(i), 2.0) - 0.5, 0.0, 1.0);
                                                        return 0.25 * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
                                                      })},
      {"steps", sampled(n, [&](Index i) { return std::fmod(seconds(i), 2.0) < 1.0 ? 0.01 : -0.01; })},
      {"contact now and then", sampled(n, [&](Index i) { return 500.0 * p[i] > 0.0 ? f[i] : 0.0; })},
      {"dead band", sampled(n, [&](Index i) { return std::abs(f[i]) < 1.0 ? 0.0 : f[i]; })},
      {"median filter of 3", median_of(f, 3)},
      {"median filter of 9", median_of(with_noise(f, 0.2, random), 9)},
      {"backlash", with_backlash(p, 0.002)},
      {"backlash of an encoder", in_steps(with_backlash(p, 0.002), 1e-5)},
      {"stick and slip", stick_slip(n, rate)},
      {"stick and slip of an encoder", in_steps(stick_slip(n, rate), 1e-5)},
      {"taps", taps(n, rate)},
      {"clipped", f.cwiseMin(5.0).cwiseMax(-5.0)},
      {"fast sine of an encoder",
       in_steps(sampled(n, [&](Index i) { return 0.01 * std::sin(50.0 * seconds(i)); }), 1e-4)},
      {"chirp of an encoder",
       in_steps(sampled(n, [&](Index i) { return 0.01 * std::sin((0.6 + 0.6 * seconds(i)) * seconds(i)); }), 2e-4)},
  };
}

class EachRate : public testing::TestWithParam<double> {};

TEST_P(EachRate, HonestSignalsAreNotAccused) {
  for (const NamedSignal& signal : honest(GetParam())) {
    const Stale stale = find_stale(signal.values);
    EXPECT_EQ(stale.updates.staleness, Staleness::none) << signal.name << " at " << GetParam() << " Hz";
    EXPECT_TRUE(stale.samples.empty());
  }
}
INSTANTIATE_TEST_SUITE_P(FindStale, EachRate, testing::Values(45.0, 60.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0));

/// A position, an encoder's, a force, a converter's.
std::vector<NamedSignal> moving(double rate) {
  numeric::Random random(3);
  const Vector p = multisine(kSamples, rate, 0.01), f = with_noise(multisine(kSamples, rate, 5.0), 0.05, random);
  return {{"position", p}, {"encoder", in_steps(p, 1e-5)}, {"force", f}, {"converter", in_steps(f, 0.05)}};
}

TEST(FindStale, FindsEachHoldAndItsRate) {
  for (const NamedSignal& signal : moving(1000.0)) {
    for (const double period : {2.0, 3.0, 5.0, 8.0, 20.0, 50.0, 16.67}) {
      const Stale stale = find_stale(held(signal.values, period));
      EXPECT_EQ(stale.updates.staleness, Staleness::held) << signal.name << " every " << period;
      EXPECT_NEAR(stale.updates.interval, period, 0.01 * period) << signal.name;
      EXPECT_NEAR(stale.updates.share, 1.0 - 1.0 / period, 0.01) << signal.name;
    }
  }
}

TEST(FindStale, KnowsWhichSamplesAreMeasurements) {
  const Vector values = held(multisine(kSamples, 1000.0, 0.01), 8.0);
  const Stale stale = find_stale(values);
  for (Index i = 0; i < kSamples; ++i) ASSERT_EQ(stale.samples[static_cast<std::size_t>(i)], i % 8 != 0) << i;
}

TEST(FindStale, FindsValuesThatRepeatNowAndThen) {
  for (const NamedSignal& signal : moving(1000.0)) {
    if (signal.name == "converter") continue;  // whose noise of a step repeats by itself
    numeric::Random random(5);
    Vector values = signal.values;
    for (Index i = 1; i < kSamples; ++i) {
      if (random.uniform() < 0.3) values[i] = values[i - 1];
    }
    EXPECT_EQ(find_stale(values).updates.staleness, Staleness::repeated) << signal.name;
  }
}

TEST(FindStale, FindsUpdatesThatComeAtIrregularTimes) {
  for (const NamedSignal& signal : moving(1000.0)) {
    numeric::Random random(6);
    Vector values = signal.values;
    for (Index i = 0; i < kSamples;) {
      const Index next = std::min(kSamples, i + 6 + static_cast<Index>(random.uniform(0.0, 9.0)));
      values.segment(i, next - i).setConstant(values[i]);
      i = next;
    }
    EXPECT_NE(find_stale(values).updates.staleness, Staleness::none) << signal.name;
  }
}

TEST(FindStale, FindsFreezes) {
  for (const NamedSignal& signal : moving(1000.0)) {
    if (signal.name == "converter") continue;
    Vector values = signal.values;
    for (Index i = 500; i + 100 < kSamples; i += 1000) values.segment(i, 100).setConstant(values[i]);
    const Stale stale = find_stale(values);
    EXPECT_EQ(stale.updates.staleness, Staleness::frozen) << signal.name;
    EXPECT_NEAR(stale.updates.share, 0.099, 0.02) << signal.name;
  }
}

TEST(FindStale, FindsAValueThatStandsForNothing) {
  for (const NamedSignal& signal : moving(1000.0)) {
    for (const double value : {0.0, -1.0, 999.0}) {
      if (value == 0.0 && signal.values.cwiseAbs().maxCoeff() < 0.1) continue;  // the position passes 0 closely
      for (const double share : {0.01, 0.1}) {
        numeric::Random random(8);
        const Vector values = signal.values.unaryExpr([&](double v) { return random.uniform() < share ? value : v; });
        const Stale stale = find_stale(values);
        EXPECT_EQ(stale.updates.staleness, Staleness::placeholder) << signal.name << " " << value;
        EXPECT_EQ(stale.updates.placeholder, value);
        EXPECT_NEAR(stale.updates.share, share, 0.01);
      }
    }
  }
}

TEST(FindStale, FindsASlowChannelFilledWithZeros) {
  for (const NamedSignal& signal : moving(1000.0)) {
    for (const Index every : {2, 3, 8, 20}) {
      const Vector values = sampled(kSamples, [&](Index i) { return i % every == 0 ? signal.values[i] : 0.0; });
      const Stale stale = find_stale(values);
      EXPECT_EQ(stale.updates.staleness, Staleness::placeholder) << signal.name << " every " << every;
      EXPECT_NEAR(stale.updates.interval, static_cast<double>(every), 0.05 * static_cast<double>(every));
    }
  }
}

TEST(FindStale, FindsBurstsOfAPlaceholder) {
  for (const NamedSignal& signal : moving(200.0)) {
    for (const Index length : {2, 4, 8}) {
      Vector values = signal.values;
      for (Index i = 700; i + length < kSamples; i += 550) values.segment(i, length).setZero();
      EXPECT_EQ(find_stale(values).updates.staleness, Staleness::placeholder) << signal.name << " of " << length;
    }
  }
}

TEST(FindStale, PassesOverSamplesThatAreNoNumbers) {
  Vector values = held(multisine(kSamples, 1000.0, 0.01), 5.0);
  values.segment(1000, 7).setConstant(std::nan(""));
  const Stale stale = find_stale(values);
  EXPECT_NE(stale.updates.staleness, Staleness::none);
  EXPECT_FALSE(stale.samples[1003]);
}

}  // namespace stale_samples_test
}  // namespace mbk::recording
