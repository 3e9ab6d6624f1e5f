#include "mbk/experiment/device/wiring.h"

#include <gtest/gtest.h>

namespace mbk::device {
namespace {

TEST(Wiring, ChangesNothingByDefault) {
  RawState raw;
  raw.sequence = 7;
  raw.encoder = {0.7, 0.4};
  raw.force = {1.0, -2.0};
  raw.acceleration = {0.1, 0.2};
  raw.stop = true;
  const State state = Wiring{}.state(raw);
  EXPECT_EQ(state.sequence, 7U);
  EXPECT_EQ(state.joint, raw.encoder);
  EXPECT_EQ(state.force, raw.force);
  EXPECT_EQ(state.acceleration, raw.acceleration);
  EXPECT_TRUE(state.stop);
  EXPECT_EQ(Wiring{}.command({1.0, 2.0}), Vector2d(1.0, 2.0));
}

TEST(Wiring, CountsBecomeAnglesAndTorquesBecomeCommands) {
  Wiring wiring;
  wiring.radians_per_count = {0.001, -0.002};
  wiring.count_offset = {100.0, 50.0};
  wiring.torque_per_command = {0.5, -2.0};
  RawState raw;
  raw.encoder = {1100.0, 300.0};
  const State state = wiring.state(raw);
  EXPECT_NEAR(state.joint[0], 1.0, 1e-12);
  EXPECT_NEAR(state.joint[1], -0.5, 1e-12);
  EXPECT_EQ(wiring.command({1.0, 1.0}), Vector2d(2.0, -0.5));
}

TEST(Wiring, SensorsOnTheLastLinkTurnWithIt) {
  Wiring wiring;
  wiring.force_frame = Wiring::Frame::last_link;
  wiring.force_gain << 2.0, 0.0, 0.0, 2.0;
  wiring.force_offset = {0.5, 0.0};
  RawState raw;
  raw.encoder = {0.0, 0.6};
  raw.force = {2.0, 0.0};  // 3 N along the last link
  const Vector2d force = wiring.state(raw).force;
  EXPECT_NEAR(force.x(), 3.0 * std::sin(0.6), 1e-12);
  EXPECT_NEAR(force.y(), -3.0 * std::cos(0.6), 1e-12);
}

}  // namespace
}  // namespace mbk::device
