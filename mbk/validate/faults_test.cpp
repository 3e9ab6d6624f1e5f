#include <gtest/gtest.h>

#include <set>

#include "mbk/simulate/laboratory/simulation.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace {

TEST(Faults, AreOfManyKindsAndReachNearlyEveryReason) {
  std::set<std::string_view> names;
  std::set<safety::Reason> reasons;
  for (const FaultKind& kind : fault_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    reasons.insert(kind.reasons.begin(), kind.reasons.end());
  }
  EXPECT_GE(names.size(), 25U);
  // all but `none`, what only a controller with a fault of its own asks for (gate_test.cpp), and a driver that does not
  // return, which needs a real clock (tests/end_to_end/udp_test.py)
  EXPECT_EQ(reasons.size(), static_cast<std::size_t>(safety::kReasons) - 3);
  EXPECT_FALSE(reasons.contains(safety::Reason::controller_not_finite));
}

/// `mbk validate faults` takes twenty moments of each kind.
TEST(Faults, SwitchTheMotorsOffInTime) {
  const auto table = faults_study({.runs = 1, .seed = 7});
  ASSERT_TRUE(table) << table.error().line();
  expect_nothing_refuted(*table);
  EXPECT_EQ(table->verdict(), RowVerdict::not_shown) << testing::PrintToString(table->notes);  // by one moment of each
}

/// A robot whose every command is seen, with a fault from tick 100 on.
class FaultyRobot : public testing::Test {
 protected:
  FaultyDevice device(DeviceFault fault) { return {*robot_, geometry_, std::move(fault), kOnset, false, 1000}; }
  static constexpr std::uint64_t kOnset = 100;
  protocol::Trial trial_ =
      protocol::read_experiment(fault_experiment(TrialKind::position), "faults.toml", laboratory::read_simulation)
          ->front();
  robot::Geometry geometry_ = trial_.robot.geometry;
  std::unique_ptr<laboratory::SimulatedDevice> robot_ = laboratory::simulated_robot(trial_).value();
};

TEST_F(FaultyRobot, IsTheSimulatedRobotUntilTheFaultBegins) {
  auto twin = laboratory::simulated_robot(trial_).value();
  DeviceFault fault;
  fault.push = [](int) { return Vector2d(20.0, 0.0); };
  FaultyDevice faulty = device(std::move(fault));
  device::State one, other;
  for (std::uint64_t i = 0; i < 2 * kOnset; ++i) {
    const device::Command command{i, {0.1, -0.1}, true};
    ASSERT_TRUE(faulty.read(one) && twin->read(other));
    ASSERT_EQ(one.joint == other.joint && one.force == other.force, i <= kOnset) << i;
    faulty.write(command);
    twin->write(command);
  }
  // the push moves the hand its way
  const Vector2d moved = robot::hand_position(geometry_, one.joint) - robot::hand_position(geometry_, other.joint);
  EXPECT_GT(moved.x(), 1e-3);
  EXPECT_GT(one.force.x(), other.force.x() + 1.0);
  ASSERT_EQ(faulty.received().size(), 2U * kOnset);
  EXPECT_EQ(faulty.received()[5].command.torque, Vector2d(0.1, -0.1));
}

}  // namespace
}  // namespace mbk::validation
