#include "mbk/measure/calibration/spring_constant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::calibration {
namespace {

using ::testing::HasSubstr;

/// A slow stretch out and back that a machine recorded, with the truth behind it.
struct Stretching {
  HookFit truth;                ///< deflection 0: a spring without hooks
  double end_m = 0.06;          ///< of the stretch, from `truth.rest`
  double duration_s = 60.0;     ///< out and back
  double noise_N = 0.02;        ///< standard deviation of the force
  double correlation_s = 0.05;  ///< of the noise
  double rate_hz = 100.0;
};

struct Recorded {
  Vector time, position, reaction;
};

Recorded record(const Stretching& what, std::uint64_t seed) {
  numeric::Random random(seed);
  const auto samples = static_cast<Index>(what.duration_s * what.rate_hz);
  Recorded recorded{Vector(samples), Vector(samples), Vector(samples)};
  const double kept = what.correlation_s > 0.0 ? std::exp(-1.0 / (what.rate_hz * what.correlation_s)) : 0.0;
  double noise = what.noise_N * random.normal();
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) / what.rate_hz;
    const double share = 1.0 - std::abs(2.0 * t / what.duration_s - 1.0);
    const double s = what.truth.rest + what.end_m * share;
    const double tension =
        what.truth.deflection > 0.0 ? hook_tension(what.truth, s) : what.truth.stiffness * (s - what.truth.rest);
    recorded.time[i] = t;
    recorded.position[i] = s;
    recorded.reaction[i] = -tension + noise;
    noise = kept * noise + std::sqrt(1.0 - kept * kept) * what.noise_N * random.normal();
  }
  return recorded;
}

HookFit hooks(double stiffness, double deflection, double force) {
  HookFit truth;
  truth.stiffness = stiffness;
  truth.rest = 0.1;
  truth.deflection = deflection;
  truth.force = force;
  return truth;
}

SpringConstant fitted(const Recorded& recorded, const StretchOptions& options = {}) {
  const auto constant = fit_spring_constant(recorded.time, recorded.position, recorded.reaction, options);
  EXPECT_TRUE(constant) << constant.error().line();
  return constant ? *constant : SpringConstant{};
}

TEST(HookTension, PutBackIntoItsEquationGivesTheStretch) {
  for (const double deflection : {1e-4, 1e-3, 5e-3}) {
    const HookFit fit = hooks(150.0, deflection, 0.7);
    for (double s = fit.rest + 1e-5; s < 0.2; s += 0.7e-3) {
      const double T = hook_tension(fit, s);
      EXPECT_NEAR(fit.rest + T / fit.stiffness + deflection * (1 - std::exp(-T / fit.force)), s, 1e-15) << s;
    }
  }
}

TEST(HookTension, GoesThroughZeroWithoutAKink) {
  const HookFit fit = hooks(150.0, 1e-3, 0.7);
  const double h = 1e-7;
  EXPECT_EQ(hook_tension(fit, fit.rest), 0.0);
  EXPECT_NEAR(hook_tension(fit, fit.rest + h) / -hook_tension(fit, fit.rest - h), 1.0, 1e-3);
}

TEST(SpringConstantFit, GivesTheTruthOfASpringWithoutHooksOrNoise) {
  const Recorded recorded = record({.truth = hooks(150.0, 0.0, 1.0), .noise_N = 0.0}, 1);
  const SpringConstant constant = fitted(recorded);
  EXPECT_NEAR(constant.straight.stiffness, 150.0, 1e-9);
  EXPECT_NEAR(constant.straight.rest, 0.1, 1e-12);
  EXPECT_FALSE(constant.hooks);
  EXPECT_NEAR(constant.straight.r_squared, 1.0, 1e-12);
}

TEST(SpringConstantFit, GivesTheTruthOfHooksWithoutNoise) {
  const SpringConstant constant = fitted(record({.truth = hooks(150.0, 0.8e-3, 0.6), .noise_N = 0.0}, 1));
  ASSERT_TRUE(constant.hooks);
  EXPECT_NEAR(constant.hooks->stiffness, 150.0, 1e-4);
  EXPECT_NEAR(constant.hooks->deflection, 0.8e-3, 1e-8);
  EXPECT_NEAR(constant.hooks->force, 0.6, 1e-4);
  EXPECT_NEAR(constant.hooks->rest, 0.1, 1e-8);
}

TEST(SpringConstantFit, OfTheStraightPartIsNotBiasedByTheHooksAndOfTheWholeIs) {
  const SpringConstant constant = fitted(record({.truth = hooks(120.0, 2e-3, 0.8), .end_m = 0.05}, 3));
  ASSERT_TRUE(constant.hooks);
  // hooks add less than 1 % to the compliance where the line begins, and less further on
  EXPECT_NEAR(constant.straight.stiffness, 120.0, 0.005 * 120.0);
  EXPECT_NEAR(constant.hooks->stiffness, 120.0, 0.005 * 120.0);
  // A line through everything must take in 2 mm that the spring alone would not give. Least squares over the whole
  // curve without noise is the twin here.
  const SpringConstant exact = fitted(record({.truth = hooks(120.0, 2e-3, 0.8), .end_m = 0.05, .noise_N = 0.0}, 3));
  EXPECT_GT(std::abs(exact.bias_of_whole()), 0.01);
  EXPECT_NEAR(constant.bias_of_whole(), exact.bias_of_whole(), 0.003);
  EXPECT_THAT(constant.rule, HasSubstr(" 1 %"));
}

TEST(SpringConstantFit, StandardErrorsHoldTheTruthAsOftenAsTheySay) {
  constexpr int kRuns = 300;
  int inside = 0, inside_rest = 0, inside_hooks = 0, seen = 0;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const SpringConstant plain =
        fitted(record({.truth = hooks(150.0, 0.0, 1.0), .noise_N = 0.04, .correlation_s = 0.1, .rate_hz = 25.0}, seed));
    inside += std::abs(plain.whole.stiffness - 150.0) < numeric::kNormal95 * plain.whole.stiffness_error ? 1 : 0;
    inside_rest += std::abs(plain.whole.rest - 0.1) < numeric::kNormal95 * plain.whole.rest_error ? 1 : 0;
    const SpringConstant hooked =
        fitted(record({.truth = hooks(150.0, 1e-3, 0.5), .correlation_s = 0.1, .rate_hz = 25.0}, 1000 + seed));
    if (!hooked.hooks) continue;
    ++seen;
    inside_hooks +=
        std::abs(hooked.hooks->stiffness - 150.0) < numeric::kNormal95 * hooked.hooks->stiffness_error ? 1 : 0;
  }
  EXPECT_EQ(seen, kRuns);
  // 99.9 % interval of 300 draws at 95 %: 0.95 ± 3.3·√(0.95·0.05/300) = 0.91 … 0.99
  for (const int count : {inside, inside_rest, inside_hooks}) {
    EXPECT_GE(count, 0.91 * kRuns);
    EXPECT_LE(count, 0.995 * kRuns);
  }
}

TEST(SpringConstantFit, SeldomSeesHooksThatAreNotThere) {
  constexpr int kRuns = 200;
  int seen = 0;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    seen +=
        fitted(record({.truth = hooks(150.0, 0.0, 1.0), .noise_N = 0.04, .correlation_s = 0.1, .rate_hz = 25.0}, seed))
                .hooks
            ? 1
            : 0;
  }
  EXPECT_LE(seen, kRuns / 50);
}

TEST(SpringConstantFit, IsTheSameOnEitherSideAndFromAnyOrigin) {
  Recorded recorded = record({.truth = hooks(120.0, 2e-3, 0.8), .end_m = 0.05}, 3);
  const SpringConstant constant = fitted(recorded);
  recorded.position = -recorded.position;
  recorded.reaction = -recorded.reaction;
  const SpringConstant turned = fitted(recorded);
  EXPECT_NEAR(turned.straight.stiffness, constant.straight.stiffness, 1e-9);
  EXPECT_NEAR(turned.straight.rest, -constant.straight.rest, 1e-12);
  EXPECT_NEAR(turned.hooks->rest, -constant.hooks->rest, 1e-12);
  recorded.position.array() += 0.3;
  EXPECT_NEAR(fitted(recorded).straight.rest, 0.3 - constant.straight.rest, 1e-7);
}

TEST(SpringConstantFit, AsksForALongerStretchWhereTheHooksBendThroughout) {
  const Recorded recorded = record({.truth = hooks(120.0, 4e-3, 1.2), .end_m = 0.03, .noise_N = 0.002}, 3);
  const auto constant = fit_spring_constant(recorded.time, recorded.position, recorded.reaction);
  ASSERT_FALSE(constant);
  EXPECT_EQ(constant.error().kind, ErrorKind::not_usable);
  EXPECT_THAT(constant.error().line(), HasSubstr("hook"));
}

TEST(SpringConstantFit, RefusesWhatIsNoStretch) {
  const Recorded good = record({.truth = hooks(120.0, 0.0, 1.0)}, 3);
  const auto line = [&](auto change) {
    Recorded recorded = good;
    change(recorded);
    const auto constant = fit_spring_constant(recorded.time, recorded.position, recorded.reaction);
    EXPECT_FALSE(constant);
    return constant ? std::string() : constant.error().line();
  };
  EXPECT_THAT(line([](Recorded& r) { r.reaction = -r.reaction; }), HasSubstr("F=-3"));
  EXPECT_THAT(line([](Recorded& r) { r.reaction[7] = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("sample 8"));
  EXPECT_THAT(line([](Recorded& r) { r.time[9] = r.time[8]; }), HasSubstr("sample 10"));
  EXPECT_THAT(line([](Recorded& r) { r.position.setConstant(0.1); }), HasSubstr("position"));
  EXPECT_THAT(line([](Recorded& r) { r.position.conservativeResize(9); }), HasSubstr("9 positions"));
  EXPECT_THAT(line([](Recorded& r) {
                r = {r.time.head(5), r.position.head(5), r.reaction.head(5)};
              }),
              HasSubstr("5 samples"));
  EXPECT_THAT(line([](Recorded& r) {
                numeric::Random random(1);
                for (double& value : r.reaction) value += 9.0 * random.normal();
              }),
              HasSubstr("variance"));
}

}  // namespace
}  // namespace mbk::calibration
