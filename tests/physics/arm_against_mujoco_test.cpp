#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "mbk/base/numeric/random.h"
#include "mbk/simulate/participant/two_link_arm.h"
#include "tests/physics/engine.h"

namespace mbk::participant {
namespace {

/// Upper arm and forearm with hinges at shoulder and elbow. Their centres of mass may lie anywhere, as long as
///   a = I₁ + m₁c₁² + m₂l₁² + c,  b = m₂l₁c₂,  c = I₂ + m₂c₂².
std::string two_links(const TwoLinkArm& arm) {
  const ArmGeometry& geometry = arm.geometry();
  const double l1 = geometry.upper_arm, l2 = geometry.forearm, c1 = 0.4 * l1, c2 = 0.5 * l2, m1 = 1.0;
  const double m2 = arm.inertia().b / (l1 * c2), I2 = arm.inertia().c - m2 * c2 * c2;
  const double I1 = arm.inertia().a - arm.inertia().c - m1 * c1 * c1 - m2 * l1 * l1;
  const auto inertial = [](double centre, double mass, double inertia) {
    return fmt::format(R"(<inertial pos="{0:.17g} 0 0" mass="{1:.17g}" diaginertia="{2:.17g} {2:.17g} {2:.17g}"/>)",
                       centre, mass, inertia);
  };
  return fmt::format(R"(<mujoco><compiler angle="radian"/><option gravity="0 0 0"/>
      <worldbody><body name="upper" pos="{:.17g} {:.17g} 0" euler="0 0 {:.17g}"><joint type="hinge" axis="0 0 1"/>{}
        <body name="fore" pos="{:.17g} 0 0"><joint type="hinge" axis="0 0 1"/>{}
          <site name="hand" pos="{:.17g} 0 0"/></body></body></worldbody></mujoco>)",
                     geometry.shoulder.x(), geometry.shoulder.y(), geometry.rotation, inertial(c1, m1, I1), l1,
                     inertial(c2, m2, I2), l2);
}

TEST(ArmAgainstMujoco, PutsTheHandAndAcceleratesItAlike) {
  TwoLinkArm::Options options;
  options.geometry.rotation = 0.3;
  options.joints.stiffness << 11.0, 3.5, 2.3, 4.8;
  const TwoLinkArm arm = TwoLinkArm::create(options).value();
  const physics::EngineModel model = physics::compiled(two_links(arm));
  const physics::EngineData data(mj_makeData(model.get()));
  const int forearm = mj_name2id(model.get(), mjOBJ_BODY, "fore");
  const Vector2d q0 = joint_angles(options.geometry, options.equilibrium);
  numeric::Random random(11);
  constexpr double kRounding = 1e-14;  // [m]
  constexpr double kRelative = 1e-9;   // both solve the same 2×2 equation in other coordinates
  for (int i = 0; i < 2000; ++i) {
    const Vector2d q(random.uniform(-1.0, 2.0), random.uniform(0.3, 2.8));
    const Vector2d q_rate(random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0));
    const Vector2d force_on_hand(random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0));
    const Vector2d torque = -options.joints.damping * q_rate - options.joints.stiffness * (q - q0);
    for (int joint = 0; joint < 2; ++joint) {
      data->qpos[joint] = q[joint];
      data->qvel[joint] = q_rate[joint];
      data->qfrc_applied[joint] = torque[joint];
    }
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());  // mj_applyFT needs both
    const mjtNum at_hand[3] = {force_on_hand[0], force_on_hand[1], 0.0}, no_torque[3] = {};
    mj_applyFT(model.get(), data.get(), at_hand, no_torque, data->site_xpos, forearm, data->qfrc_applied);
    mj_forward(model.get(), data.get());

    const HandState<2> hand = {hand_position(options.geometry, q), jacobian(options.geometry, q) * q_rate};
    ASSERT_LE((hand.position - Vector2d(data->site_xpos[0], data->site_xpos[1])).norm(), kRounding) << q.transpose();
    const LoadDynamics<2> load = arm.dynamics(hand);
    const Vector2d ours = load.inertia.inverse() * (force_on_hand - load.bias);
    const Vector2d theirs = jacobian(options.geometry, q) * Vector2d(data->qacc[0], data->qacc[1]) +
                            jacobian_rate(options.geometry, q, q_rate) * q_rate;
    ASSERT_LE((theirs - ours).norm(), kRelative * ours.norm())
        << "state " << i << ": q " << q.transpose() << ", rate " << q_rate.transpose();
  }
}

}  // namespace
}  // namespace mbk::participant
