#include "mbk/measure/identify/transmission_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "mbk/model/robot/single_joint.h"

namespace mbk::identify {
namespace transmission_checks_test {

using ::testing::HasSubstr;

/// One joint whose drive was found to bend, moved up to 2 Hz.
RobotIdentification bending(double resonance_hz, double of_torque, double vaf = 99.0) {
  RobotIdentification found;
  found.model.mechanism = std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{});
  found.preparations.emplace_back();
  found.preparations.back().band_high = Hertz(2.0);
  found.fit.emplace_back();
  found.fit.back().vaf = vaf;
  TransmissionTest test;
  test.elastic.found = true;
  test.elastic.coefficient = -1.0 / std::pow(2.0 * std::numbers::pi * resonance_hz, 2);
  test.elastic.of_torque = of_torque;
  found.transmission.push_back(test);
  warn_of_transmission(found);
  return found;
}

TEST(WarnOfTransmission, NamesASpeedAtWhichTheDriveHardlyBends) {
  const RobotIdentification found = bending(10.0, 0.01);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings[0].message, HasSubstr(" 10 Hz"));
  EXPECT_THAT(found.warnings[0].remedy, HasSubstr("0.45 Hz"));
}

TEST(WarnOfTransmission, AdvisesNoSpeedAtWhichNothingCanBeIdentified) {
  const RobotIdentification found = bending(3.0, 0.5);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings[0].remedy, Not(HasSubstr(" Hz")));
}

TEST(WarnOfTransmission, ReportsNoResonanceWithinTheBandOfTheMotion) {
  EXPECT_TRUE(bending(0.22, 0.1).warnings.empty());
}

TEST(WarnOfTransmission, ReportsNothingOfAModelThatHeldOutDataContradict) {
  EXPECT_TRUE(bending(10.0, 0.01, -832.0).warnings.empty());
}

}  // namespace transmission_checks_test
}  // namespace mbk::identify
