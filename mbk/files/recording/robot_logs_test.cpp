#include "mbk/files/recording/robot_logs.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace robot_logs_test {

using testing::Contains;
using testing::HasSubstr;

constexpr Index kSamples = 20;

/// Values that differ from column to column.
Vector column(double begin) {
  return Vector::LinSpaced(kSamples, begin, begin + 1.0);
}

Contents table(const std::vector<std::pair<std::string, Vector>>& columns) {
  Contents contents;
  contents.format = "CSV";
  contents.table = true;
  for (const auto& [name, values] : columns) contents.arrays.push_back({name, SharedMatrix(Matrix(values))});
  return contents;
}

/// Time, a pose that is turned by 90° about z from the base, and the force under this name.
Contents franka(const std::string& force, bool orientation = true) {
  std::vector<std::pair<std::string, Vector>> columns = {
      {"time", Vector::LinSpaced(kSamples, 500, 500 + kSamples - 1)}};
  const double pose[16] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.4, 0.1, 0.5, 1};
  for (int k = orientation ? 0 : 12; k < 16; ++k) {
    columns.emplace_back(fmt::format("O_T_EE[{}]", k), Vector::Constant(kSamples, pose[k]));
  }
  for (int k = 0; k < 6; ++k) columns.emplace_back(fmt::format("{}[{}]", force, k), column(10.0 * k));
  return table(columns);
}

Result<Recording> read_in_space(Contents contents) {
  ReadOptions options;
  options.axes = 3;
  return assemble(std::move(contents), options);
}

TEST(RobotLogs, AFrankaLogHasThreeAxes) {
  const auto recording = read_in_space(franka("O_F_ext_hat_K"));
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_DOUBLE_EQ(recording->time[1] - recording->time[0], 1e-3);
  EXPECT_EQ(recording->find("hand_x")->values[0], 0.4);
  EXPECT_EQ(recording->find("hand_z")->values[0], 0.5);
  EXPECT_EQ(recording->find("force_x")->values, -column(0));
  EXPECT_EQ(recording->find("force_z")->values, -column(20));  // the robot exerts it
  EXPECT_EQ(recording->find("force_z")->unit, "N");
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("O_F_ext_hat_K"), HasSubstr("base frame"))));
}

TEST(RobotLogs, AForceInTheStiffnessFrameIsTurnedByTheRecordedOrientation) {
  Contents contents = franka("K_F_ext_hat_K");
  const auto turned = read_in_space(contents);
  ASSERT_TRUE(turned) << turned.error().line();
  // x of the end effector is y of the base, its y is -x.
  EXPECT_TRUE(turned->find("force_x")->values.isApprox(column(10)));
  EXPECT_TRUE(turned->find("force_y")->values.isApprox(-column(0)));
  EXPECT_TRUE(turned->find("force_z")->values.isApprox(-column(20)));
  EXPECT_THAT(turned->notes, Contains(AllOf(HasSubstr("K_F_ext_hat_K"), HasSubstr("EE_T_K is missing"))));

  // K turned back by 90° is parallel to the base.
  const double stiffness[16] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  for (int k = 0; k < 16; ++k) {
    contents.arrays.push_back(
        {fmt::format("EE_T_K[{}]", k), SharedMatrix(Matrix(Vector::Constant(kSamples, stiffness[k])))});
  }
  const auto parallel = read_in_space(contents);
  ASSERT_TRUE(parallel) << parallel.error().line();
  EXPECT_TRUE(parallel->find("force_x")->values.isApprox(-column(0)));
  EXPECT_TRUE(parallel->find("force_y")->values.isApprox(-column(10)));
}

TEST(RobotLogs, AForceInAnUnknownFrameIsAskedFor) {
  const auto recording = read_in_space(franka("K_F_ext_hat_K", false));
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("force_x"), nullptr);
  EXPECT_EQ(recording->find("hand_z")->values[0], 0.5);
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("K_F_ext_hat_K"), HasSubstr("--channels"))));
}

TEST(RobotLogs, ALogOfUniversalRobotsHasThreeAxes) {
  std::vector<std::pair<std::string, Vector>> columns = {
      {"timestamp", Vector::LinSpaced(kSamples, 100.0, 100.0 + 0.002 * (kSamples - 1))}};
  for (const char* const name : {"actual_TCP_pose", "actual_TCP_force"}) {
    for (int k = 0; k < 6; ++k) {
      columns.emplace_back(fmt::format("{}_{}", name, k), column(10.0 * k + static_cast<double>(columns.size())));
    }
  }
  const auto recording = read_in_space(table(columns));
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_NEAR(recording->time[1] - recording->time[0], 2e-3, 1e-9);
  EXPECT_EQ(recording->find("hand_z")->values, columns[3].second);
  EXPECT_EQ(recording->find("force_x")->values, columns[7].second);
  EXPECT_EQ(recording->find("force_z")->values, columns[9].second);
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("actual_TCP_force"), HasSubstr("base frame"))));
  EXPECT_FALSE(assemble(table(columns), {}));  // without --axes 3 these are no channels
}

}  // namespace robot_logs_test
}  // namespace mbk::recording
