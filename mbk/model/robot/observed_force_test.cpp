#include "mbk/model/robot/observed_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "mbk/model/robot/test_models.h"

namespace mbk::robot {
namespace observed_force_test {

using testing::HasSubstr;

constexpr double kTick = 1e-3;

struct Recorded {
  Matrix position, torque;
};

Recorded recorded(Index samples) {
  const JointMotion motion = Swing{}.sampled(samples, kTick);
  return {motion.position, model_of({}).torques(motion) + Matrix::Constant(samples, 2, 0.1)};
}

TEST(ObserveForce, IsTheObserverStepByStep) {
  const Recorded r = recorded(500);
  const ObservedForces all = observe_force(model_of({}), r.position, r.torque, {}, kTick).value();
  auto observer = EncoderMomentumObserver::create(model_of({}), {}, kTick).value();
  EXPECT_EQ(all.lag, observer.lag());
  for (Index i = 0; i < 500; ++i) {
    const ObservedForce& now = observer.step(r.position.row(i).transpose(), r.torque.row(i).transpose());
    ASSERT_EQ(Vector(all.joint_torque.row(i).transpose()), Vector(now.joint_torque));
    ASSERT_EQ(Vector(all.force_hand_on_robot.row(i).transpose()), Vector(now.force_hand_on_robot));
  }
}

TEST(ObserveForce, KnowsNothingOfLaterSamples) {
  const Recorded r = recorded(500);
  Recorded changed = r;
  changed.position.bottomRows(200).array() += 0.05;
  changed.torque.bottomRows(200).setZero();
  const ObservedForces one = observe_force(model_of({}), r.position, r.torque, {}, kTick).value(),
                       other = observe_force(model_of({}), changed.position, changed.torque, {}, kTick).value();
  EXPECT_EQ(one.force_hand_on_robot.topRows(300), other.force_hand_on_robot.topRows(300));
  EXPECT_NE(one.force_hand_on_robot.bottomRows(200), other.force_hand_on_robot.bottomRows(200));
}

TEST(ObserveForce, HasTheForceAtTheBeginningToAHundredthOnceItIsSettled) {
  const Matrix position = Vector2d(0.4, 0.9).transpose().replicate(300, 1);
  const Vector2d force(2.0, 1.0);
  const Vector2d holding = -jacobian(Geometry{}, {0.4, 0.9}).transpose() * force;
  const ObservedForces all =
      observe_force(model_of({}), position, holding.transpose().replicate(300, 1), {}, kTick).value();
  const Vector missing = (all.force_hand_on_robot.rowwise() - force.transpose()).rowwise().norm() / force.norm();
  EXPECT_LE(missing[all.settled], 0.01);
  EXPECT_GT(missing[all.settled - 2], 0.01);
}

TEST(ObserveForce, IsSettledAtTheEndOfARecordingThatIsTooShort) {
  const Recorded r = recorded(20);
  EXPECT_EQ(observe_force(model_of({}), r.position, r.torque, {}, kTick).value().settled, 20);
}

TEST(ObserveForce, RefusesWhatIsNotThatOfTheRobotAndSaysWhere) {
  const DynamicModel model = model_of({});
  const Recorded r = recorded(50);
  EXPECT_THAT(observe_force(model, r.position.leftCols(1), r.torque, {}, kTick).error().message,
              AllOf(HasSubstr("1 joint"), HasSubstr("50 samples"), HasSubstr("2 joints")));
  EXPECT_FALSE(observe_force(model, r.position, r.torque.topRows(49), {}, kTick));
  Recorded bad = r;
  bad.torque(17, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(observe_force(model, bad.position, bad.torque, {}, kTick).error().message,
              AllOf(HasSubstr("torque_2"), HasSubstr("sample 17")));
  bad = r;
  bad.position.setZero();
  bad.position.col(0).array() += 0.5 * std::numbers::pi;
  const Error singular = observe_force(model, bad.position, bad.torque, {}, kTick).error();
  EXPECT_THAT(singular.line(), AllOf(HasSubstr("sample 0"), HasSubstr("singular")));
  EXPECT_FALSE(observe_force(model, r.position, r.torque, {.gain = -1.0}, kTick));
}

}  // namespace observed_force_test
}  // namespace mbk::robot
