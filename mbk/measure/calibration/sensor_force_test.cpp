#include "mbk/measure/calibration/sensor_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace mbk::calibration {
namespace sensor_force_test {

using testing::HasSubstr;

constexpr double kRounding = 1e-12;

SensorUse use() {
  SensorUse use;
  use.name = "cell.json";
  SensorCalibration& c = use.calibration;
  c.slope = (Matrix(2, 2) << -8.56, 0.1, 0.2, -8.15).finished();
  c.axes.resize(2);
  c.axes[0].name = "x";
  c.axes[1].name = "y";
  c.axes[0].zero_voltage = 0.06;
  c.axes[1].zero_voltage = 0.28;
  c.lever_arm = 0.0688;
  return use;
}

Recording recording() {
  Recording recording;
  recording.time = Vector::LinSpaced(5, 0.0, 0.4);
  Vector x(5), y(5);
  x << 0.06, 0.06, 1.0, 2.0, -1.0;
  y << 0.30, 0.30, 0.5, -1.0, 3.0;
  recording.channels = {{"voltage_x", "V", "", x}, {"voltage_y", "V", "", y}};
  return recording;
}

TEST(ForceFromVoltage, IsSlopeTimesVoltageAboveZero) {
  const auto made = force_from_voltage(recording(), use()).value();
  EXPECT_NEAR(made.find("force_x")->values[2], -8.56 * 0.94 + 0.1 * 0.22, kRounding);
  EXPECT_NEAR(made.find("force_y")->values[2], 0.2 * 0.94 - 8.15 * 0.22, kRounding);
  EXPECT_EQ(made.find("force_x")->unit, "N");
  EXPECT_EQ(made.find("force_x")->frame, "base");
  EXPECT_THAT(made.notes.at(0), AllOf(HasSubstr("force_x"), HasSubstr("force_y"), HasSubstr("cell.json"),
                                      HasSubstr("0.06"), HasSubstr("0.28 V")));
}

TEST(ForceFromVoltage, LeverArmScalesTheSlopeAlone) {
  SensorUse longer = use();
  longer.lever_arm = 2.0 * 0.0688;
  const auto at = force_from_voltage(recording(), use()).value(),
             twice = force_from_voltage(recording(), longer).value();
  EXPECT_LT((2.0 * twice.find("force_x")->values - at.find("force_x")->values).cwiseAbs().maxCoeff(), kRounding);
  Recording silent = recording();
  silent.channels[0].values.setConstant(0.06);
  silent.channels[1].values.setConstant(0.28);
  EXPECT_LT(force_from_voltage(silent, longer)->find("force_y")->values.cwiseAbs().maxCoeff(), kRounding);
}

TEST(ForceFromVoltage, TakesTheZeroThatIsSaidOrTheMeanOfTheStart) {
  SensorUse said = use();
  said.zero_voltage = Eigen::Vector2d(0.06, 0.30);
  SensorUse start = use();
  start.zero_from_s = 0.15;  // two samples
  const auto a = force_from_voltage(recording(), said).value(), b = force_from_voltage(recording(), start).value();
  EXPECT_NEAR(a.find("force_y")->values[0], 0.0, kRounding);
  EXPECT_LT((a.find("force_y")->values - b.find("force_y")->values).cwiseAbs().maxCoeff(), kRounding);
  start.zero_from_s = 9.0;
  EXPECT_EQ(force_from_voltage(recording(), start).error().kind, ErrorKind::usage);
  start.zero_from_s = 0.1;
  start.zero_voltage = Eigen::Vector2d(0.0, 0.0);
  EXPECT_EQ(force_from_voltage(recording(), start).error().kind, ErrorKind::usage);
  said.zero_voltage = Vector::Zero(1);
  EXPECT_EQ(force_from_voltage(recording(), said).error().kind, ErrorKind::usage);
}

TEST(ForceFromVoltage, TurnsWithTheLastLink) {
  const Vector plain_x = force_from_voltage(recording(), use())->find("force_x")->values;
  const Vector plain_y = force_from_voltage(recording(), use())->find("force_y")->values;
  Recording turned = recording();
  turned.channels.push_back({"joint_2", "rad", "joint", Vector::Constant(5, 0.4)});
  const auto made = force_from_voltage(turned, use()).value();
  // Dyck 2013, eq. E.4
  EXPECT_NEAR(made.find("force_x")->values[3], std::sin(0.4) * plain_x[3] + std::cos(0.4) * plain_y[3], kRounding);
  EXPECT_NEAR(made.find("force_y")->values[3], -std::cos(0.4) * plain_x[3] + std::sin(0.4) * plain_y[3], kRounding);
  SensorUse fixed = use();
  fixed.frame = SensorFrame::base;
  EXPECT_EQ(force_from_voltage(turned, fixed)->find("force_x")->values, plain_x);
  fixed.frame = SensorFrame::link;
  EXPECT_THAT(force_from_voltage(recording(), fixed).error().message, HasSubstr("joint_2"));
}

TEST(ForceFromVoltage, MovesALateForceEarlierAndCutsTheEnd) {
  SensorUse late = use();
  late.calibration.slope = Matrix::Identity(2, 2);
  late.calibration.axes[0].zero_voltage = late.calibration.axes[1].zero_voltage = 0.0;
  late.calibration.delay = 0.15;
  late.undo_delay = true;
  Recording ramp = recording();
  ramp.channels[0].values = ramp.time;
  ramp.channels[1].values = 2.0 * ramp.time;
  const auto made = force_from_voltage(ramp, late).value();
  ASSERT_EQ(made.samples(), 3);
  EXPECT_EQ(made.find("voltage_x")->values.size(), 3);
  for (Index i = 0; i < 3; ++i) EXPECT_NEAR(made.find("force_x")->values[i], ramp.time[i] + 0.15, kRounding);
  late.undo_delay = false;
  EXPECT_EQ(force_from_voltage(ramp, late)->samples(), 5);
  EXPECT_THAT(force_from_voltage(ramp, late)->notes.back(), HasSubstr("--sensor-delay undo"));
}

TEST(ForceFromVoltage, ReplacesARecordedForceAndSaysSo) {
  Recording both = recording();
  both.channels.push_back({"force_x", "N", "base", Vector::Ones(5)});
  const auto made = force_from_voltage(both, use()).value();
  EXPECT_EQ(made.channels.size(), 4u);
  EXPECT_NE(made.find("force_x")->values[0], 1.0);
  EXPECT_EQ(made.notes.size(), force_from_voltage(recording(), use())->notes.size() + 1);
}

TEST(ForceFromVoltage, RefusesWhatIsMissing) {
  Recording one = recording();
  one.channels.pop_back();
  EXPECT_THAT(force_from_voltage(one, use()).error().message, HasSubstr("voltage_y"));
  Recording bad = recording();
  bad.channels[0].values[2] = std::nan("");
  EXPECT_THAT(force_from_voltage(bad, use()).error().message, AllOf(HasSubstr("voltage_x"), HasSubstr("sample 3")));
  SensorUse no_arm = use();
  no_arm.calibration.lever_arm.reset();
  no_arm.lever_arm = 0.1;
  EXPECT_EQ(force_from_voltage(recording(), no_arm).error().kind, ErrorKind::usage);
}

}  // namespace sensor_force_test
}  // namespace mbk::calibration
