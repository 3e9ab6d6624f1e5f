#include "mbk/model/perturbation/schedule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/allocations.h"

namespace mbk::perturbation {
namespace schedule_test {

constexpr double kPi = std::numbers::pi;

Multisine sine(double amplitude, int harmonic = 1, double phase = 0.0) {
  return Multisine::create(1.0, {{harmonic, amplitude, phase}}).value();
}

Schedule sines() {
  return Schedule::multisine({sine(0.003, 1), sine(0.004, 3, 0.5)}, Quantity::position, Space::hand, 12.0, 2.0).value();
}

Schedule pulses(double amplitude = 0.005, Quantity quantity = Quantity::position) {
  PulseSchedule::Options options;
  options.amplitude = amplitude;
  return Schedule::pulses(options, quantity, 3.0).value();
}

Schedule binary(double angle = 0.5 * kPi) {
  return Schedule::random_binary({}, angle, Quantity::force, 20.0).value();
}

std::vector<Schedule> all() {
  return {sines(), pulses(), binary(), Schedule::rest(5.0).value()};
}

TEST(Schedule, BeginsAtRest) {
  for (const Schedule& schedule : all()) {
    EXPECT_EQ(schedule.at(-1e-9).second, Eigen::Vector2d(0.0, 0.0));
    EXPECT_EQ(schedule.at(0.0).value, Eigen::Vector2d(0.0, 0.0));
    EXPECT_EQ(schedule.at(0.0).first, Eigen::Vector2d(0.0, 0.0));
  }
}

TEST(Schedule, DerivativesAgreeWithCentralDifferencesBetweenBreaks) {
  const double step = 1e-5;
  for (const Schedule& schedule : all()) {
    for (double t = 0.0131; t < schedule.duration(); t += 0.0717) {
      const auto before = schedule.at(t - step), here = schedule.at(t), after = schedule.at(t + step);
      const double unit = 1e-4 * (here.second.norm() + 1.0);  // r̈ may jump within the step, ṙ not
      EXPECT_LT(((after.value - before.value) / (2.0 * step) - here.first).norm(), unit) << t;
    }
  }
}

TEST(Schedule, DoesNotAllocateWhileItRuns) {
  const std::vector<Schedule> schedules = all();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const long before = testing_support::allocations();
  for (const Schedule& schedule : schedules) {
    for (int k = 0; k < 5000; ++k) sum += schedule.at(0.01 * k).second + schedule.reference(0.01 * k);
  }
  const long after = testing_support::allocations();
  EXPECT_EQ(after, before);
  EXPECT_TRUE(sum.allFinite());
  const std::vector<long> counted(static_cast<std::size_t>(after), 1);
  EXPECT_GT(testing_support::allocations(), after) << "the counter does not count " << counted.back();
}

TEST(Schedule, SinesGrowAndThenAreThemselves) {
  const Schedule schedule = sines();
  const auto r = schedule.at(2.3);
  EXPECT_EQ(r.value, Eigen::Vector2d(sine(0.003, 1).at(2.3).value, sine(0.004, 3, 0.5).at(2.3).value));
  EXPECT_EQ(schedule.reference(2.3), r.value);
  EXPECT_NEAR(schedule.at(1.0).value.y(), 0.5 * sine(0.004, 3, 0.5).at(1.0).value, 1e-17);  // half the growth
}

TEST(Schedule, ReferenceIsTheStepsBehindPulsesAndElseTheSignal) {
  const Schedule steps = pulses();
  const auto onset = steps.events().front();
  EXPECT_NEAR(steps.reference(onset.time + 0.1).norm(), 0.005, 1e-17);
  EXPECT_EQ(steps.reference(onset.time - 0.1).norm(), 0.0);
  EXPECT_EQ(binary().reference(3.3), binary().at(3.3).value);
  EXPECT_EQ(binary().facts().crest_factor.x(), 0.0);
}

TEST(Schedule, NamesOnsetAndOffsetOfEveryPulseWithItsAngle) {
  const Schedule schedule = pulses();
  const auto events = schedule.events();
  ASSERT_EQ(events.size(), 32u);
  for (std::size_t i = 0; i < events.size(); i += 2) {
    EXPECT_EQ(events[i].name, "onset");
    EXPECT_EQ(events[i + 1].name, "offset");
    EXPECT_GT(events[i + 1].time, events[i].time);
    const Eigen::Vector2d step = schedule.reference(events[i].time);
    EXPECT_NEAR(std::remainder(std::atan2(step.y(), step.x()) - events[i].value, 2.0 * kPi), 0.0, 1e-15);
  }
  EXPECT_TRUE(sines().events().empty());
  EXPECT_TRUE(binary().events().empty());
}

TEST(Schedule, HasThirtyTwoPulsesInSixteenDirections) {
  PulseSchedule::Options options;
  options.directions = 16;
  EXPECT_EQ(Schedule::pulses(options, Quantity::position, 3.0).value().events().size(), 64u);
}

TEST(ScheduleFacts, OfACircleAreItsClosedForm) {
  // Radius 10 mm at 2 Hz, grown in 1 s: from then on |r|, |ṙ|, |r̈| are constant.
  const double omega = 4.0 * kPi;
  const Schedule circle =
      Schedule::multisine({sine(0.01, 2), sine(0.01, 2, 0.5 * kPi)}, Quantity::position, Space::hand, 100.0, 1.0)
          .value();
  const Facts facts = circle.facts();
  EXPECT_NEAR(facts.peak, 0.01, 1e-14);
  EXPECT_NEAR(facts.axis_peak.x(), 0.01, 1e-14);
  EXPECT_EQ(facts.lowest_frequency, Hertz(2.0));
  EXPECT_EQ(facts.highest_frequency, Hertz(2.0));
  EXPECT_GE(facts.peak_speed, 0.01 * omega * (1.0 - 1e-12));
  EXPECT_LT(facts.peak_speed, 0.01 * (omega + 1.875));  // ġ ≤ 15/8 per second
  // ∫g² over the second of growth is 181/462, so that the mean of |r|² is 1e-4 (99 + 181/462)/100. Simpson's rule with
  // 32 pieces to the period of r² errs by less than 1e-6 of it.
  EXPECT_NEAR(facts.rms, 0.01 * std::sqrt((99.0 + 181.0 / 462.0) / 100.0), 1e-8);
  EXPECT_NEAR(facts.crest_factor.x(), std::sqrt(2.0), 0.01);
}

TEST(ScheduleFacts, OfPulsesAreTheOvershootAndTheFirstAcceleration) {
  const Facts facts = pulses().facts();
  EXPECT_NEAR(facts.peak, 0.005 * (1.0 + std::exp(-0.1 * kPi / std::sqrt(0.99))), 1e-15);
  EXPECT_NEAR(facts.peak_acceleration, 0.005 * 225.0, 1e-12);  // right after the onset
  // ṙ is largest where r̈ = 0: tan ω_d t = √(1−ζ²)/ζ, and there ωₙ A e^{−ζ/√(1−ζ²) acos ζ}
  EXPECT_NEAR(facts.peak_speed, 15.0 * 0.005 * std::exp(-0.1 / std::sqrt(0.99) * std::acos(0.1)), 1e-14);
  EXPECT_NEAR(facts.highest_frequency.value, 15.0 / (2.0 * kPi) * std::sqrt(0.98 + std::sqrt(0.98 * 0.98 + 1.0)),
              1e-12);
}

TEST(ScheduleFacts, AreNotBelowAnySampleOfAFineGrid) {
  for (const Schedule& schedule : all()) {
    const Facts facts = schedule.facts();
    double peak = 0.0, speed = 0.0, acceleration = 0.0;
    for (double t = 0.0; t < schedule.duration(); t += 1e-3) {
      const auto r = schedule.at(t);
      peak = std::max(peak, r.value.norm());
      speed = std::max(speed, r.first.norm());
      acceleration = std::max(acceleration, r.second.norm());
    }
    const double tight = 1.0 + 1e-12;  // rounding; a grid of 1 ms misses less than 1 % at 3 Hz
    EXPECT_LE(peak, facts.peak * tight);
    EXPECT_LE(speed, facts.peak_speed * tight);
    EXPECT_LE(acceleration, facts.peak_acceleration * tight);
    EXPECT_GE(peak, 0.99 * facts.peak);
    EXPECT_GE(speed, 0.99 * facts.peak_speed);
    EXPECT_GE(acceleration, 0.97 * facts.peak_acceleration);
  }
}

TEST(ScheduleFacts, OfRestAreZero) {
  const Facts facts = Schedule::rest(5.0).value().facts();
  EXPECT_EQ(facts.peak, 0.0);
  EXPECT_EQ(facts.rms, 0.0);
  EXPECT_EQ(facts.crest_factor, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(facts.highest_frequency, Hertz(0.0));
}

TEST(ScheduleCheck, NamesTheBrokenLimit) {
  const Schedule schedule = pulses();
  Limits limits;
  EXPECT_TRUE(schedule.check(limits));
  limits.peak = 0.0087;
  EXPECT_TRUE(schedule.check(limits).has_value()) << schedule.check(limits).error().line();
  limits.peak = 0.008;
  const auto peak = schedule.check(limits);
  ASSERT_FALSE(peak);
  EXPECT_EQ(peak.error().kind, ErrorKind::usage);
  EXPECT_NE(peak.error().message.find("0.00864"), std::string::npos) << peak.error().message;
  EXPECT_NE(peak.error().message.find("0.008 m"), std::string::npos) << peak.error().message;
  EXPECT_NE(peak.error().remedy.find("0.925"), std::string::npos) << peak.error().remedy;
  limits.peak.reset();
  limits.speed = 0.05;
  EXPECT_FALSE(schedule.check(limits));
  limits.speed.reset();
  limits.acceleration = 1.0;
  EXPECT_FALSE(schedule.check(limits));
  limits.acceleration.reset();
  limits.bandwidth = Hertz(3.0);
  EXPECT_FALSE(schedule.check(limits));
  limits.bandwidth = Hertz(4.0);
  EXPECT_TRUE(schedule.check(limits));
  limits.peak = NAN;
  EXPECT_FALSE(schedule.check(limits));
}

TEST(ScheduleCheck, KeepsToTheLimitAfterItsOwnRemedy) {
  Limits limits;
  limits.peak = 0.008;
  EXPECT_TRUE(pulses(0.925 * 0.005).check(limits));
}

TEST(ScheduleCheck, NamesAFactorAlsoForAmplitudesFarTooLarge) {
  Limits limits;
  limits.peak = 1e-6;
  EXPECT_NE(pulses(5.0).check(limits).error().remedy.find("1.15e-07"), std::string::npos);
}

TEST(ScheduleCheck, AsksAlongThePathWhetherItCanBeReached) {
  Limits limits;
  limits.reachable = [](const Eigen::Vector2d& d) -> Result<void> {
    if (d.x() > 0.006) return bad_usage("outside");
    return {};
  };
  const auto refused = pulses().check(limits);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "outside");
  EXPECT_NE(refused.error().where.find("displacement"), std::string::npos) << refused.error().where;
  EXPECT_TRUE(sines().check(limits));
  EXPECT_TRUE(pulses(2.0, Quantity::force).check(limits)) << "where a force moves the hand is not known";
}

TEST(Schedule, RefusesBadOptions) {
  const auto multisine = [](double duration, double moving_in) {
    return Schedule::multisine({sine(1.0), sine(1.0)}, Quantity::force, Space::joint, duration, moving_in).has_value();
  };
  EXPECT_TRUE(multisine(10.0, 2.0));
  EXPECT_FALSE(multisine(10.0, 0.0));
  EXPECT_FALSE(multisine(10.0, 11.0));
  EXPECT_FALSE(multisine(0.0, 1.0));
  EXPECT_FALSE(multisine(NAN, 1.0));
  EXPECT_FALSE(multisine(3601.0, 1.0));
  EXPECT_FALSE(
      Schedule::multisine({sine(1.0, 1), sine(1.0, 10'001)}, Quantity::position, Space::hand, 10.0, 1.0).has_value());
  EXPECT_FALSE(Schedule::pulses({}, Quantity::position, 0.5));
  EXPECT_FALSE(Schedule::pulses({}, Quantity::position, INFINITY));
  EXPECT_FALSE(Schedule::random_binary({}, NAN, Quantity::force, 10.0));
  EXPECT_FALSE(Schedule::random_binary({}, 0.0, Quantity::force, -1.0));
  EXPECT_FALSE(Schedule::rest(0.0));
}

TEST(Schedule, UnitsFollowQuantityAndSpace) {
  EXPECT_EQ(unit(Quantity::position, Space::hand), "m");
  EXPECT_EQ(unit(Quantity::position, Space::joint), "rad");
  EXPECT_EQ(unit(Quantity::force, Space::hand), "N");
  EXPECT_EQ(unit(Quantity::force, Space::joint), "N·m");
}

}  // namespace schedule_test
}  // namespace mbk::perturbation
