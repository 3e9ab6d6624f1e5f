#include "mbk/simulate/participant/elbow_joint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace mbk::participant {
namespace elbow_joint_test {

using perturbation::Jet;

constexpr double kTick = 5e-4;
constexpr double kExact = 1e-12;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Extension at constant velocity from an angle, from the first sample on.
Jet<double> ramp(double from, double velocity, int sample) {
  return {from + velocity * kTick * sample, velocity, 0.0};
}

StretchedMuscle with_reflex() {
  StretchedMuscle muscle;
  muscle.threshold = 2.0;
  muscle.velocity_gain = 0.1;
  muscle.gain = 12.0;
  muscle.latency = 0.03;
  return muscle;
}

TEST(ElbowJoint, WithoutReflexIsInertiaViscosityStiffnessAndWeight) {
  ElbowJoint::Options o;
  o.rest = 1.4;
  o.weight = 2.9;
  o.horizontal = 1.5;
  ElbowJoint elbow = ElbowJoint::create(o, 1.6, kTick).value();
  for (const Jet<double>& joint : {Jet<double>{1.6, 0.0, 0.0}, {1.8, 2.0, -30.0}, {1.2, -1.0, 10.0}}) {
    const ElbowJoint::Output output = elbow.step(joint);
    EXPECT_NEAR(output.torque,
                -(o.inertia * joint.second + o.viscosity * joint.first + o.stiffness * (joint.value - 1.4)) +
                    2.9 * std::cos(joint.value - 1.5),
                kExact);
    EXPECT_EQ(output.activation[ElbowJoint::flexor], 0.0);
    EXPECT_EQ(output.activation[ElbowJoint::extensor], 0.0);
  }
  EXPECT_EQ(elbow.impedance().x0[0], 1.4);
  EXPECT_EQ(elbow.impedance().M(0, 0), o.inertia);
}

TEST(ElbowJoint, ThresholdFallsWithVelocityByTheVelocityGain) {
  for (const double velocity : {0.2, 1.0, 3.0}) {
    ElbowJoint::Options o;
    o.muscles[ElbowJoint::flexor] = with_reflex();
    ElbowJoint elbow = ElbowJoint::create(o, 1.2, kTick).value();
    int onset = 0;
    while (elbow.step(ramp(1.2, velocity, onset)).activation[ElbowJoint::flexor] == 0.0) ++onset;
    const double angle = ramp(1.2, velocity, onset).value - velocity * 0.03;  // a latency before
    EXPECT_NEAR(angle, 2.0 - 0.1 * velocity, 2.0 * velocity * kTick);
  }
}

TEST(ElbowJoint, ReflexTorqueIsTheClosedFormOfTwoLagsAfterBothDelays) {
  ElbowJoint::Options o;
  o.muscles[ElbowJoint::flexor] = with_reflex();
  o.activation_time = 0.04;
  o.electromechanical_delay = 0.025;
  ElbowJoint elbow = ElbowJoint::create(o, 1.5, kTick).value();
  ElbowJoint passive = ElbowJoint::create({}, 1.5, kTick).value();
  for (int i = 0; i < 2000; ++i) {  // a step of the angle to 0.25 beyond the threshold
    const Jet<double> joint{i < 200 ? 1.5 : 2.25, 0.0, 0.0};
    const double torque = elbow.step(joint).torque - passive.step(joint).torque;
    const double t = (i - 200) * kTick - 0.055;
    const double rise = t < -0.5 * kTick ? 0.0 : 1.0 - std::exp(-t / 0.04) * (1.0 + t / 0.04);
    const double sampled = 12.0 * 0.25 * kTick / 0.04;  // the lags hold their input for a sample
    EXPECT_NEAR(torque, -12.0 * 0.25 * rise, sampled) << i;
  }
}

TEST(ElbowJoint, ExtensorIsItsMirrorImage) {
  ElbowJoint::Options flexion, extension;
  flexion.muscles[ElbowJoint::extensor] = with_reflex();
  flexion.muscles[ElbowJoint::extensor].threshold = 1.0;
  extension.muscles[ElbowJoint::flexor] = with_reflex();
  flexion.rest = extension.rest = 1.5;
  ElbowJoint one = ElbowJoint::create(flexion, 1.5, kTick).value(),
             other = ElbowJoint::create(extension, 1.5, kTick).value();
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const ElbowJoint::Output a = one.step(ramp(1.5, -1.0, i)), b = other.step(ramp(1.5, 1.0, i));
    EXPECT_NEAR(a.torque, -b.torque, kExact);
    EXPECT_NEAR(a.activation[ElbowJoint::extensor], b.activation[ElbowJoint::flexor], kExact);
    largest = std::max(largest, a.activation[ElbowJoint::extensor]);
  }
  EXPECT_GT(largest, 0.01);
}

TEST(ElbowJoint, RestsBeforeTheMotionWithBackgroundAndTonicReflex) {
  ElbowJoint::Options o;
  o.muscles[ElbowJoint::flexor] = with_reflex();
  o.muscles[ElbowJoint::flexor].background = 0.1;
  o.muscles[ElbowJoint::extensor].background = 0.05;
  o.rest = 2.1;
  ElbowJoint elbow = ElbowJoint::create(o, 2.1, kTick).value();
  for (int i = 0; i < 500; ++i) {
    const ElbowJoint::Output output = elbow.step({2.1, 0.0, 0.0});
    EXPECT_NEAR(output.activation[ElbowJoint::flexor], 0.1 + 12.0 / 60.0 * 0.1, kExact);
    EXPECT_NEAR(output.torque, -(6.0 + 1.2) + 3.0, kExact);
  }
}

TEST(ElbowJoint, RespondsToTheStartOfFastStretchesAtTheStatedTimes) {
  ElbowJoint::Options o;
  o.muscles[ElbowJoint::flexor].responses = {{.latency = 0.025, .duration = 0.02, .activation = 0.1},
                                             {.latency = 0.06, .duration = 0.04, .activation = 0.2}};
  for (const double velocity : {1.0, 0.3, -1.0}) {  // fast, below the trigger speed, shortening
    ElbowJoint elbow = ElbowJoint::create(o, 1.5, kTick).value();
    for (int i = 0; i < 400; ++i) {
      const Jet<double> joint{1.5, i < 100 || i >= 200 ? 0.0 : velocity * std::min(1.0, (i - 99) / 10.0), 0.0};
      const double a = elbow.step(joint).activation[ElbowJoint::flexor];
      const bool first = i >= 150 && i < 190, second = i >= 220 && i < 300;
      EXPECT_EQ(a, velocity < 1.0 ? 0.0 : first ? 0.1 : second ? 0.2 : 0.0) << i << " at " << velocity;
    }
  }
}

TEST(ElbowJoint, StretchesDifferByTheSpreadsAndSeedsRepeatThem) {
  ElbowJoint::Options o;
  o.muscles[ElbowJoint::flexor] = with_reflex();
  o.muscles[ElbowJoint::flexor].threshold_spread = 0.05;
  const auto onsets = [&](std::uint64_t seed) {
    o.seed = seed;
    ElbowJoint elbow = ElbowJoint::create(o, 1.2, kTick).value();
    std::vector<double> found;
    for (int stretch = 0; stretch < 200; ++stretch) {
      double onset = 0.0;
      for (int i = 0; i < 1000; ++i) {
        if (elbow.step(ramp(1.2, 2.0, i)).activation[ElbowJoint::flexor] > 0.0 && onset == 0.0) {
          onset = ramp(1.2, 2.0, i).value;
        }
      }
      for (int i = 0; i < 100; ++i) elbow.step({1.2, 0.0, 0.0});
      found.push_back(onset);
    }
    return found;
  };
  const std::vector<double> first = onsets(1);
  EXPECT_EQ(first, onsets(1));
  EXPECT_NE(first, onsets(2));
  double mean = 0.0, square = 0.0;
  for (const double angle : first) mean += angle / 200.0;
  for (const double angle : first) square += std::pow(angle - mean, 2) / 199.0;
  EXPECT_NEAR(mean, 2.0 - 0.2 + 0.06, 4.0 * 0.05 / std::sqrt(200.0));  // four standard errors
  EXPECT_NEAR(std::sqrt(square), 0.05, 4.0 * 0.05 / std::sqrt(400.0));
}

TEST(ElbowJoint, ActivationIsAtMostOne) {
  ElbowJoint::Options o;
  o.muscles[ElbowJoint::flexor] = with_reflex();
  o.muscles[ElbowJoint::flexor].gain = 1e4;
  ElbowJoint elbow = ElbowJoint::create(o, 1.9, kTick).value();
  double last = 0.0;
  for (int i = 0; i < 1000; ++i) last = elbow.step({2.5, 0.0, 0.0}).activation[ElbowJoint::flexor];
  EXPECT_EQ(last, 1.0);
}

TEST(ElbowJoint, RefusesWhatNoLimbHas) {
  const auto refused = [](const auto& change) {
    ElbowJoint::Options o;
    o.muscles[ElbowJoint::flexor] = with_reflex();
    o.muscles[ElbowJoint::flexor].responses.resize(1);
    change(o, o.muscles[ElbowJoint::flexor], o.muscles[ElbowJoint::flexor].responses.front());
    return !ElbowJoint::create(o, 1.5, kTick);
  };
  using O = ElbowJoint::Options;
  using M = StretchedMuscle;
  using R = StretchResponse;
  EXPECT_FALSE(refused([](O&, M&, R&) {}));
  EXPECT_TRUE(refused([](O& o, M&, R&) { o.inertia = 0.0; }));
  EXPECT_TRUE(refused([](O& o, M&, R&) { o.stiffness = -1.0; }));
  EXPECT_TRUE(refused([](O& o, M&, R&) { o.rest = kNaN; }));
  EXPECT_TRUE(refused([](O& o, M&, R&) { o.activation_time = 0.0; }));
  EXPECT_TRUE(refused([](O&, M& m, R&) { m.largest_torque = 0.0; }));
  EXPECT_TRUE(refused([](O&, M& m, R&) { m.threshold = kNaN; }));
  EXPECT_TRUE(refused([](O&, M& m, R&) { m.latency = -0.01; }));
  EXPECT_TRUE(refused([](O&, M&, R& r) { r.duration = 0.0; }));
  EXPECT_TRUE(refused([](O&, M&, R& r) { r.trigger_speed = 0.0; }));
  EXPECT_FALSE(ElbowJoint::create({}, 1.5, 0.0));
}

}  // namespace elbow_joint_test
}  // namespace mbk::participant
