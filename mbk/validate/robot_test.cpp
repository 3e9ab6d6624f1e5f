#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace robot_test {

const ValidationRow& row(const ValidationTable& table, std::string_view what) {
  for (const ValidationRow& one : table.rows) {
    if (one.what.starts_with(what)) return one;
  }
  ADD_FAILURE() << "no row begins with " << what;
  return table.rows.front();
}

TEST(RobotStudy, FindsTheRobotAndThatThePrintedCoriolisSignIsWorse) {
  const auto table = robot_study({.runs = 4, .seed = 301});
  ASSERT_TRUE(table) << table.error().line();
  expect_nothing_refuted(*table);
  // Of a smoothing that rounds off reversals it would be 0.0075 %; the mean of four runs spreads by 0.0012 %.
  EXPECT_LT(row(*table, "bias of alpha3").value, 0.005);
  EXPECT_GT(row(*table, "Coulomb friction left out: error of viscous_1").value, 5.0);  // viscosity takes its part [%]
  EXPECT_GT(row(*table, "Coulomb friction left out: RMSE").value, 2.0);
}

TEST(RobotStudy, IsTheSameOnAnyNumberOfThreads) {
  const auto one = robot_study({.runs = 2, .threads = 1}), two = robot_study({.runs = 2, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(VirtualSensorStudy, FindsForceStiffnessAndMassWithoutASensorAndWorseWithoutFriction) {
  const auto table = virtual_sensor_study({.runs = 1, .seed = 301});
  ASSERT_TRUE(table) << table.error().line();
  expect_nothing_refuted(*table);
  for (const char* axis : {"Fx", "Fy"}) {
    const auto rmse = [&](const std::string& force) {
      return row(*table, force + ": largest RMSE of " + axis + " in a run").value;
    };
    EXPECT_LT(3.0 * rmse("virtual sensor"), rmse("virtual sensor without Coulomb"));
    EXPECT_LT(rmse("virtual sensor"), rmse("momentum observer"));
  }
  ASSERT_EQ(table->charts.size(), 2u);
  EXPECT_EQ(table->charts[0].series.front().x.size(), 15u);  // three elements of five stiffnesses
  EXPECT_EQ(table->charts[1].series.front().x.size(), 5u);
}

}  // namespace robot_test
}  // namespace mbk::validation
