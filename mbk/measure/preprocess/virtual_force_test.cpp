#include "mbk/measure/preprocess/virtual_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "mbk/measure/preprocess/test_recordings.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/single_joint.h"

namespace mbk::preprocess {
namespace virtual_force_test {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kRate = 1000.0;  // [Hz]
constexpr Index kSamples = 10'000;

robot::DynamicModel planar() {
  robot::DynamicModel model{
      std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{}), {.smoothing = 0.2}, {}, {}};
  model.parameters.resize(9);
  model.parameters << 0.06929, 0.04217, 0.04416, 0.0651, 0.03, 0.01, 0.0739, 0.02, -0.01;
  return model;
}

/// A slow motion of both joints.
robot::JointMotion motion_of_joints() {
  robot::JointMotion motion{Matrix(kSamples, 2), Matrix(kSamples, 2), Matrix(kSamples, 2)};
  for (Index i = 0; i < kSamples; ++i) {
    const double t = static_cast<double>(i) / kRate;
    for (Index joint = 0; joint < 2; ++joint) {
      const double omega = 2.0 * std::numbers::pi * (joint == 0 ? 1.1 : 1.9), middle = joint == 0 ? 0.4 : 0.9;
      motion.position(i, joint) = middle + 0.1 * std::sin(omega * t);
      motion.velocity(i, joint) = 0.1 * omega * std::cos(omega * t);
      motion.acceleration(i, joint) = -0.1 * omega * omega * std::sin(omega * t);
    }
  }
  return motion;
}

/// F_h of the hand on the robot [N].
Matrix force() {
  Matrix all(kSamples, 2);
  for (Index i = 0; i < kSamples; ++i) {
    const double t = static_cast<double>(i) / kRate;
    all.row(i) << 3.0 + std::sin(2.0 * std::numbers::pi * 0.7 * t), -2.0 * std::cos(2.0 * std::numbers::pi * 1.3 * t);
  }
  return all;
}

/// What perfect sensors record of it: τ = W θ − Jᵀ F_h.
Recording recorded(const robot::DynamicModel& model) {
  const robot::JointMotion motion = motion_of_joints();
  const Matrix hand = force();
  Matrix torque = model.torques(motion), acceleration(kSamples, 2);
  for (Index i = 0; i < kSamples; ++i) {
    const robot::JointVector q = motion.position.row(i).transpose(), v = motion.velocity.row(i).transpose();
    const robot::HandJacobian J = model.mechanism->jacobian(q);
    torque.row(i) -= (J.transpose() * hand.row(i).transpose()).transpose();
    acceleration.row(i) =
        (J * motion.acceleration.row(i).transpose() + model.mechanism->jacobian_rate(q, v) * v).transpose();
  }
  Recording recording = testing_support::even_recording(kSamples, kRate,
                                                        {{"joint_1", motion.position.col(0)},
                                                         {"joint_2", motion.position.col(1)},
                                                         {"torque_1", torque.col(0)},
                                                         {"torque_2", torque.col(1)},
                                                         {"acceleration_x", acceleration.col(0)},
                                                         {"acceleration_y", acceleration.col(1)}});
  for (std::size_t k = 4; k < 6; ++k) recording.channels[k].unit = "m/s2";
  return recording;
}

/// A window that leaves what friction makes of a reversal as it is; perfect sensors need no longer one.
Options short_window() {
  Options options{.force_source = ForceSource::virtual_sensor};
  options.smoothing_window = 21;
  return options;
}

Result<VirtualForce> computed(const Recording& recording, const robot::DynamicModel& model,
                              const Options& options = short_window()) {
  return virtual_force(recording, testing_support::facts_of(recording), model, options);
}

Matrix force_of(const VirtualForce& made) {
  Matrix all(made.recording.samples(), 2);
  all << made.recording.find("force_x")->values, made.recording.find("force_y")->values;
  return all;
}

double largest_error(const VirtualForce& made) {
  const Index rows = made.last - made.first;
  return (force_of(made) - force()).middleRows(made.first, rows).cwiseAbs().maxCoeff();
}

constexpr double kSmoothing = 1e-3;  // [N]: what that window takes of them

TEST(VirtualForce, IsTheForceAtTheHandWherePerfectSensorsRecordTheMotion) {
  const robot::DynamicModel model = planar();
  const auto made = computed(recorded(model), model);
  ASSERT_TRUE(made) << made.error().line();
  EXPECT_LT(largest_error(*made), kSmoothing);
  EXPECT_EQ(made->sensitivity.size(), 0);  // nobody said how sure the coefficients are
  EXPECT_EQ(made->standard_error.size(), 0);
  EXPECT_EQ(made->recording.find("force_x")->unit, "N");
  const Matrix velocity = motion_of_joints().velocity;
  EXPECT_LT((made->joint_velocity - velocity).middleRows(made->first, made->last - made->first).cwiseAbs().maxCoeff(),
            1e-4);
}

TEST(VirtualForce, TakesTheTorqueThatActsAfterItsDelay) {
  robot::DynamicModel model = planar();
  Recording early = recorded(model);
  constexpr Index kEarly = 5;  // samples before it acts, a torque is recorded
  for (const char* const name : {"torque_1", "torque_2"}) {
    Vector& torque = testing_support::values_of(early, name);
    torque.head(kSamples - kEarly) = Vector(torque.tail(kSamples - kEarly));
  }
  EXPECT_GT(largest_error(computed(early, model).value()), 10.0 * kSmoothing);
  model.delay = kEarly / kRate;
  const VirtualForce made = computed(early, model).value();
  const Index rows = made.last - made.first - 200;  // the last torques are repeated ones
  EXPECT_LT((force_of(made) - force()).middleRows(made.first + 100, rows).cwiseAbs().maxCoeff(), kSmoothing);
}

TEST(VirtualForce, MayTakeTheAccelerationFromTheSensor) {
  const robot::DynamicModel model = planar();
  Recording recording = recorded(model);
  Options options = short_window();
  options.acceleration = AccelerationSource::sensor;
  EXPECT_LT(largest_error(computed(recording, model, options).value()), kSmoothing);
  testing_support::values_of(recording, "acceleration_x").array() += 1.0;
  // One metre per second squared more, and the force takes the mass at the hand along.
  EXPECT_GT(largest_error(computed(recording, model, options).value()), 0.5);
  EXPECT_LT(largest_error(computed(recording, model).value()), kSmoothing);
  recording.channels.resize(4);
  EXPECT_THAT(computed(recording, model, options).error().line(), HasSubstr("'acceleration_x'"));
}

TEST(VirtualForce, HasTheSensitivityOfRecomputations) {
  robot::DynamicModel model = planar();
  const Recording recording = recorded(model);
  const Index p = model.parameters.size();
  Matrix root = 1e-3 * Matrix::Random(p, p);
  model.covariance = root * root.transpose();
  const VirtualForce made = computed(recording, model).value();
  ASSERT_EQ(made.sensitivity.rows(), kSamples);
  ASSERT_EQ(made.sensitivity.cols(), 2 * p);
  Matrix slopes(kSamples, 2 * p);
  constexpr double kStep = 1e-3;
  for (Index k = 0; k < p; ++k) {
    robot::DynamicModel other = model;
    other.parameters[k] += kStep;
    const Matrix change = (force_of(computed(recording, other).value()) - force_of(made)) / kStep;
    slopes.col(k) = change.col(0);
    slopes.col(p + k) = change.col(1);
  }
  EXPECT_LE((made.sensitivity - slopes).cwiseAbs().maxCoeff(), 1e-9 * slopes.cwiseAbs().maxCoeff());
  for (const Index i : {Index{0}, Index{4321}}) {
    for (Index axis = 0; axis < 2; ++axis) {
      const Vector slope = slopes.row(i).segment(axis * p, p).transpose();
      EXPECT_NEAR(made.standard_error(i, axis), std::sqrt(slope.dot(model.covariance * slope)), 1e-9);
    }
  }
}

TEST(VirtualForce, IsHeldBeforeAndAfterTheSamplesAtWhichItIsKnown) {
  const robot::DynamicModel model = planar();
  Options options = short_window();
  options.window.from_s = 2.0;
  options.window.to_s = 7.0;
  const VirtualForce made = computed(recorded(model), model, options).value();
  constexpr Index kHalfWindow = 10;
  EXPECT_EQ(made.first, 2000 + kHalfWindow);
  EXPECT_NEAR(static_cast<double>(made.last), 7000.0 - kHalfWindow, 1.0);
  const Vector x = made.recording.find("force_x")->values;
  EXPECT_EQ(x[0], x[made.first]);
  EXPECT_EQ(x[made.first - 1], x[made.first]);
  EXPECT_NE(x[made.first + 1], x[made.first]);
  EXPECT_EQ(x[kSamples - 1], x[made.last - 1]);
}

TEST(VirtualForce, TakesThePlaceOfTheSensorsAndKeepsThem) {
  const robot::DynamicModel model = planar();
  Recording recording = recorded(model);
  const Matrix sensed = force().array() + 0.5;
  recording.channels.push_back({"force_x", "N", "base", sensed.col(0)});
  recording.channels.push_back({"force_y", "N", "base", sensed.col(1)});
  const VirtualForce made = computed(recording, model).value();
  EXPECT_EQ(made.sensor_force, sensed);
  EXPECT_LT(largest_error(made), kSmoothing);
  EXPECT_EQ(made.recording.channels.size(), recording.channels.size() + 2);  // the hand's place was not recorded
  const Vector q = motion_of_joints().position.row(77).transpose();
  EXPECT_NEAR(made.recording.find("hand_y")->values[77], model.mechanism->hand_position(q)[1], 1e-12);
  EXPECT_THAT(made.recording.notes, Contains(HasSubstr("virtual sensor")));
}

TEST(VirtualForce, OfTheObserverIsLateAndWithoutStandardErrors) {
  robot::DynamicModel model = planar();
  model.covariance = 1e-8 * Matrix::Identity(9, 9);
  const VirtualForce late = computed(recorded(model), model, {.force_source = ForceSource::observer}).value();
  EXPECT_GT(late.lag, 1e-3);
  EXPECT_EQ(late.sensitivity.size(), 0);
  EXPECT_THAT(late.recording.notes, Contains(HasSubstr("momentum observer")));
  // Late by that much, it is the force but for the ripple of its own filters.
  const auto lag = static_cast<Index>(std::llround(late.lag * kRate));
  const Matrix shifted = force_of(late).middleRows(2000 + lag, 6000) - force().middleRows(2000, 6000);
  const Matrix not_shifted = force_of(late).middleRows(2000, 6000) - force().middleRows(2000, 6000);
  EXPECT_LT(shifted.norm(), 0.3 * not_shifted.norm());
}

TEST(VirtualForce, RefusesTorquesThatMustBeInAnotherUnit) {
  const robot::DynamicModel model = planar();
  for (const auto& [factor, says] : {std::pair(1e3, "force"), std::pair(1e-3, "parameters")}) {
    Recording recording = recorded(model);
    for (const char* const name : {"torque_1", "torque_2"}) testing_support::values_of(recording, name) *= factor;
    const auto refused = computed(recording, model);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().line(), HasSubstr(says));
    EXPECT_THAT(refused.error().line(), HasSubstr("--channels"));
  }
}

TEST(VirtualForce, RefusesWhatIsTooShort) {
  const robot::DynamicModel model = planar();
  Recording recording = recorded(model);
  recording.time = Vector(recording.time.head(99));
  for (Channel& channel : recording.channels) channel.values = Vector(channel.values.head(99));
  EXPECT_THAT(computed(recording, model).error().message, HasSubstr("99 samples"));
}

TEST(VirtualForce, OfOneJointThatTurnsIsATorque) {
  const robot::DynamicModel model{std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{.slides = false}),
                                  {.viscous = false, .coulomb = false, .offset = false},
                                  Vector::Constant(1, 0.2),
                                  {}};
  const robot::JointMotion motion = motion_of_joints();
  const Vector hand = force().col(0);
  const Recording recording = testing_support::even_recording(
      kSamples, kRate, {{"position", motion.position.col(0)}, {"torque_1", 0.2 * motion.acceleration.col(0) - hand}});
  const VirtualForce made = computed(recording, model).value();
  const Channel& reaction = *made.recording.find("reaction");
  EXPECT_EQ(reaction.unit, "N.m");
  const Index rows = made.last - made.first;
  EXPECT_LT((reaction.values - hand).segment(made.first, rows).cwiseAbs().maxCoeff(), kSmoothing);
}

}  // namespace virtual_force_test
}  // namespace mbk::preprocess
