#include "mbk/measure/explore/stretch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/measure/explore/test_signals.h"

namespace mbk::explore {
namespace stretch_test {

constexpr double kRate = 500.0;
constexpr double kFrom = 60.0 * kDegree, kTo = 150.0 * kDegree;

/// A limb without memory: torque is a function of angle, speed and acceleration.
struct Limb {
  double inertia = 0.05, viscosity = 0.2, elasticity = 1.0, offset = 0.3;
  double gain = 0.0, threshold = 110.0 * kDegree, shift = 0.1;  ///< gain (θ − (λ − μ θ')) above the threshold
  [[nodiscard]] double torque(double x, double v, double a) const {
    const double reflex = v > 0.0 ? gain * std::max(x - threshold + shift * v, 0.0) : 0.0;
    return inertia * a + viscosity * v + elasticity * x * x + offset + reflex;
  }
};

/// A rest, the movement with trapezoidal velocity and a rest.
void append(const Limb& limb, double from, double to, double speed, std::vector<double>& x, std::vector<double>& f) {
  const double a = 20.0, ramp = speed / a, way = std::abs(to - from), sign = to > from ? 1.0 : -1.0;
  const double duration = way / speed + ramp;
  for (int i = 0; i < static_cast<int>((duration + 0.2) * kRate); ++i) {
    const double t = i / kRate - 0.1;
    double s = 0.0, v = 0.0, acceleration = 0.0;
    if (t > duration) {
      s = way;
    } else if (t > duration - ramp) {
      s = way - 0.5 * a * (duration - t) * (duration - t), v = a * (duration - t), acceleration = -a;
    } else if (t > ramp) {
      s = 0.5 * speed * ramp + speed * (t - ramp), v = speed;
    } else if (t > 0.0) {
      s = 0.5 * a * t * t, v = a * t, acceleration = a;
    }
    x.push_back(from + sign * s);
    f.push_back(limb.torque(x.back(), sign * v, sign * acceleration));
  }
}

ExplorationTrial trial_of(const std::vector<double>& x, const std::vector<double>& f, double noise = 0.0,
                          unsigned seed = 1) {
  ExplorationTrial trial;
  trial.axes = 1;
  trial.motion = Motion::rotation;
  trial.sample_time = 1.0 / kRate;
  trial.input = Vector::Map(x.data(), static_cast<Index>(x.size()));
  trial.output = Vector::Map(f.data(), static_cast<Index>(f.size()));
  trial.output.col(0) += noise * white_noise(trial.output.rows(), seed);
  return trial;
}

const std::vector<double> kSpeeds = {20.0 * kDegree, 60.0 * kDegree, 100.0 * kDegree, 140.0 * kDegree};

ExplorationTrial many_speeds(const Limb& limb, int repetitions, double noise = 0.0) {
  std::vector<double> x, f;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (const double speed : kSpeeds) {
      append(limb, kFrom, kTo, speed, x, f);
      append(limb, kTo, kFrom, speed, x, f);
    }
  }
  return trial_of(x, f, noise);
}

Result<StretchEstimate> found_in(const std::vector<ExplorationTrial>& trials, const StretchOptions& options = {}) {
  std::vector<Warning> warnings;
  return stretch(trials, options, warnings);
}

TEST(Stretch, FindsStretchesAndReturnsAtEachSpeed) {
  const auto found = found_in({many_speeds({}, 3)});
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_EQ(found->directions.size(), 2u);
  EXPECT_EQ(found->directions[0].direction, 1);
  EXPECT_EQ(found->directions[1].direction, -1);
  for (const StretchDirection& one : found->directions) {
    ASSERT_EQ(one.speeds.size(), kSpeeds.size());
    EXPECT_EQ(one.stretches.size(), 3 * kSpeeds.size());
    for (std::size_t k = 0; k < kSpeeds.size(); ++k) {
      EXPECT_EQ(one.speeds[k].repetitions, 3);
      EXPECT_NEAR(one.speeds[k].speed, kSpeeds[k], 0.01 * kSpeeds[k]);
    }
  }
}

TEST(Stretch, SlopeIsTheViscosityAndThePassiveCurveIsThatOfTheSlowest) {
  const Limb limb;
  const auto found = found_in({many_speeds(limb, 4, 0.02)});
  ASSERT_TRUE(found) << found.error().line();
  const StretchDirection& up = found->directions.front();
  ASSERT_TRUE(up.slope.interval95);
  EXPECT_NEAR(up.slope.value, limb.viscosity, 0.01);
  EXPECT_LT(up.slope.interval95->second - up.slope.interval95->first, 0.05);
  EXPECT_EQ(up.verdict, VelocityDependence::not_shown);
  EXPECT_FALSE(up.reflex_threshold);
  for (Index i = 0; i < up.angle.size(); ++i) {
    EXPECT_NEAR(up.passive[i], limb.torque(up.angle[i], kSpeeds[0], 0.0), 0.02);
  }
  for (std::size_t k = 1; k < up.speeds.size(); ++k) EXPECT_EQ(up.speeds[k].catch_finding, CatchFinding::none);
}

TEST(Stretch, TorqueThatFallsWithSpeedIsNotJudged) {
  std::vector<Warning> warnings;
  const ExplorationTrial trial = many_speeds({.inertia = 0.0, .viscosity = -0.3}, 4, 0.02);
  const auto found = stretch({&trial, 1}, {}, warnings);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_FALSE(found->usable);
  EXPECT_EQ(warnings.front().code, WarningCode::force_sign_reversed);
  const StretchDirection& up = found->directions.front();
  EXPECT_EQ(up.verdict, VelocityDependence::cannot_be_judged);
  for (const StretchSpeed& one : up.speeds) EXPECT_FALSE(one.catch_angle);
}

TEST(Stretch, AnglesWithAccelerationAreNotJudged) {
  const auto found = found_in({many_speeds({.gain = 5.0}, 4, 0.02)}, {.from = kFrom, .to = kTo});
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->directions.front().verdict, VelocityDependence::cannot_be_judged);
}

TEST(Stretch, SpeedsInOrderAreSaidToLookLikeADrift) {
  std::vector<double> x, f;
  for (const double speed : kSpeeds) {
    for (int repetition = 0; repetition < 4; ++repetition) {
      append({}, kFrom, kTo, speed, x, f);
      append({}, kTo, kFrom, speed, x, f);
    }
  }
  const auto says_order = [](const StretchEstimate& found) {
    return std::ranges::any_of(found.limits, [](const std::string& one) { return one.find("drift") != one.npos; });
  };
  EXPECT_TRUE(says_order(*found_in({trial_of(x, f, 0.02)})));
  EXPECT_FALSE(says_order(*found_in({many_speeds({}, 4, 0.02)})));
}

TEST(Stretch, DegreesThatAreReadAsRadiansAreRefused) {
  ExplorationTrial trial = many_speeds({}, 4, 0.02);
  trial.input *= kDegrees;
  const auto found = found_in({trial});
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().line().find(":deg"), std::string::npos);
}

TEST(Stretch, ViscosityAboveTheGivenLimitIsVelocityDependent) {
  const auto trial = many_speeds({.viscosity = 0.5}, 4, 0.02);
  EXPECT_EQ(found_in({trial})->directions.front().verdict, VelocityDependence::not_shown);
  EXPECT_EQ(found_in({trial}, {.viscosity = 0.3})->directions.front().verdict, VelocityDependence::velocity_dependent);
}

/// Without noise, the break of the torque is found to the width of the grid.
TEST(Stretch, CatchIsWhereTheReflexBegins) {
  const Limb limb{.gain = 5.0};
  const auto found = found_in({many_speeds(limb, 4, 0.02)});
  ASSERT_TRUE(found) << found.error().line();
  const StretchDirection& up = found->directions.front();
  EXPECT_EQ(up.verdict, VelocityDependence::velocity_dependent);
  for (std::size_t k = 1; k < up.speeds.size(); ++k) {
    const StretchSpeed& one = up.speeds[k];
    ASSERT_EQ(one.catch_finding, CatchFinding::found) << k;
    EXPECT_NEAR(one.catch_angle->value, limb.threshold - limb.shift * one.speed, 2.0 * kDegree) << k;
  }
  ASSERT_TRUE(up.reflex_threshold);
  EXPECT_NEAR(up.reflex_threshold->value, limb.threshold, 3.0 * kDegree);
  EXPECT_LT(*up.threshold_shift, 0.0);
  EXPECT_EQ(found->directions[1].verdict, VelocityDependence::not_shown);  // the returns
}

TEST(Stretch, ALimbStretchedTheOtherWayIsFoundLikewise) {
  std::vector<double> x, f;
  ExplorationTrial trial = many_speeds({.gain = 5.0}, 4, 0.02);
  const auto up = found_in({trial});
  trial.input *= -1.0;
  trial.output *= -1.0;
  const auto down = found_in({trial});
  ASSERT_TRUE(up && down);
  const StretchDirection &a = up->directions[0], &b = down->directions[0];
  EXPECT_EQ(b.direction, -1);
  EXPECT_EQ(b.verdict, a.verdict);
  EXPECT_NEAR(b.slope.value, a.slope.value, 0.005);
  for (std::size_t k = 1; k < a.speeds.size(); ++k) {
    EXPECT_NEAR(b.speeds[k].catch_angle->value, -a.speeds[k].catch_angle->value, 0.5 * kDegree);
  }
}

/// Over the analysed angles a damper absorbs 2 B v Δθ in stretch and return, elasticity nothing.
TEST(Stretch, WorkOfTheLoopIsThatOfTheDamper) {
  const Limb limb;
  const auto found = found_in({many_speeds(limb, 2)});
  ASSERT_TRUE(found);
  const StretchDirection& up = found->directions.front();
  const double width = up.range.second - up.range.first;
  for (const StretchSpeed& one : up.speeds) {
    ASSERT_TRUE(one.work);
    EXPECT_NEAR(one.work->value, 2.0 * limb.viscosity * one.speed * width, 0.01 * one.work->value + 1e-3);
  }
}

TEST(Stretch, OneStretchOfEachSpeedGivesAnIntervalFromTheLineAndNoCatch) {
  const auto found = found_in({many_speeds({.gain = 5.0}, 1, 0.02)});
  ASSERT_TRUE(found);
  const StretchDirection& up = found->directions.front();
  EXPECT_TRUE(up.slope.interval95);
  EXPECT_NE(up.interval_basis.find("line"), std::string::npos);
  for (const StretchSpeed& one : up.speeds) {
    EXPECT_FALSE(one.mean_torque.interval95);
    EXPECT_EQ(one.catch_finding, CatchFinding::cannot_be_judged);
  }
}

/// Offsets of recordings with one speed each are not averaged away by repetitions in them.
TEST(Stretch, OffsetsOfRecordingsWidenTheInterval) {
  const std::vector<double> offsets = {0.3, -0.2, 0.1, -0.3};
  std::vector<ExplorationTrial> trials;
  for (std::size_t k = 0; k < kSpeeds.size(); ++k) {
    std::vector<double> x, f;
    for (int i = 0; i < 5; ++i) {
      append({.offset = offsets[k]}, kFrom, kTo, kSpeeds[k], x, f);
      append({.offset = offsets[k]}, kTo, kFrom, kSpeeds[k], x, f);
    }
    trials.push_back(trial_of(x, f, 0.02, static_cast<unsigned>(k)));
  }
  const auto found = found_in(trials);
  ASSERT_TRUE(found);
  const StretchDirection& up = found->directions.front();
  ASSERT_TRUE(up.slope.interval95);
  EXPECT_GT(up.slope.interval95->second - up.slope.interval95->first, 0.2);
  EXPECT_LT(up.slope.interval95->first, 0.2);
  EXPECT_GT(up.slope.interval95->second, 0.2);
  EXPECT_NE(up.verdict, VelocityDependence::velocity_dependent);
}

TEST(Stretch, InertiaIsFoundAndAReversedTorqueIsNotUsable) {
  ExplorationTrial trial = many_speeds({}, 3, 0.01);
  std::vector<Warning> warnings;
  auto found = stretch({&trial, 1}, {}, warnings);
  ASSERT_TRUE(found && found->inertia_found);
  EXPECT_TRUE(found->usable);
  EXPECT_TRUE(warnings.empty());
  EXPECT_NEAR(found->inertia_found->value, 0.05, 0.02);
  trial.output *= -1.0;
  found = stretch({&trial, 1}, {}, warnings);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->usable);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings.front().code, WarningCode::force_sign_reversed);
  EXPECT_EQ(found->directions.front().verdict, VelocityDependence::cannot_be_judged);
}

TEST(Stretch, OneSpeedCannotBeJudgedAndASineHasNoConstantVelocity) {
  std::vector<double> x, f;
  for (int i = 0; i < 4; ++i) {
    append({}, kFrom, kTo, 1.0, x, f);
    append({}, kTo, kFrom, 1.0, x, f);
  }
  const auto one = found_in({trial_of(x, f)});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->directions.front().verdict, VelocityDependence::cannot_be_judged);
  x.clear();
  f.clear();
  for (int i = 0; i < 5000; ++i) {
    x.push_back(std::sin(2.0 * i / kRate));
    f.push_back(x.back());
  }
  EXPECT_FALSE(found_in({trial_of(x, f)}));
  EXPECT_FALSE(found_in({many_speeds({}, 2)}, {.from = 2.0, .to = 1.0}));
}

class RealElbow : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("MBK_DATA_DIR");
    if (folder == nullptr) GTEST_SKIP() << "MBK_DATA_DIR is not set";
    for (int speed = 10; speed <= 90; speed += 10) {
      const auto file = std::filesystem::path(folder) / "elbow" / ("v" + std::to_string(speed) + ".csv");
      std::ifstream stream(file);
      if (!stream) GTEST_SKIP() << file << " is missing";
      std::string line;
      std::getline(stream, line);
      std::vector<double> x, f;
      while (std::getline(stream, line)) {
        const auto first = line.find(','), second = line.find(',', first + 1);
        x.push_back(std::stod(line.substr(first + 1)) * kDegree);
        f.push_back(std::stod(line.substr(second + 1)));
      }
      trials.push_back(trial_of(x, f));
    }
  }
  std::vector<ExplorationTrial> trials;
};

TEST_F(RealElbow, HasTheKnownMeanTorques) {
  std::vector<Warning> warnings;
  const auto found = stretch(trials, {.from = 95.0 * kDegree, .to = 150.0 * kDegree}, warnings);
  ASSERT_TRUE(found) << found.error().line();
  const StretchDirection& up = found->directions.front();
  ASSERT_EQ(up.speeds.size(), 9u);
  const double expected[] = {-0.077, -0.041, -0.116, -0.019, -0.017, -0.185, -0.143, -0.107, -0.152};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(up.speeds[k].mean_torque.value, expected[k], 1e-3) << k;
}

TEST_F(RealElbow, IsNotCalledVelocityDependent) {
  for (const double sign : {1.0, -1.0}) {
    for (ExplorationTrial& trial : trials) trial.output *= sign;
    std::vector<Warning> warnings;
    const auto found = stretch(trials, {}, warnings);
    ASSERT_TRUE(found) << found.error().line();
    const StretchDirection& up = found->directions.front();
    EXPECT_EQ(up.direction, 1);
    EXPECT_EQ(up.verdict, sign > 0 ? VelocityDependence::not_shown : VelocityDependence::cannot_be_judged);
    EXPECT_EQ(found->usable, sign > 0.0);
    ASSERT_TRUE(up.slope.interval95);
    EXPECT_LE(up.slope.interval95->first, 0.0);
    EXPECT_GE(up.slope.interval95->second, 0.0);
    EXPECT_FALSE(up.reflex_threshold);
    EXPECT_GE(found->limits.size(), 5u);
  }
}

}  // namespace stretch_test
}  // namespace mbk::explore
