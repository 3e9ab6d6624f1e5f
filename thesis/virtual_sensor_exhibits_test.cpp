#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mbk/present/result/reproduction_json.h"
#include "thesis/test_exhibits.h"

namespace mbk::thesis {
namespace {

TEST(VirtualSensorExhibits, ErrMoreWithoutCoulombFrictionInTheModel) {
  const Reproduction all = made({"table-5.4", "table-5.5", "figure-5.4"});
  const Exhibit &errors = exhibit_of(all, "table-5.4"), &vaf = exhibit_of(all, "table-5.5");
  for (const char* id : {"5.4 stiffness", "5.4 mass"}) expect_all_found(errors, id);
  expect_all_found(vaf, "5.5");
  expect_charts(exhibit_of(all, "figure-5.4"), 2);

  const ReproducedTable& linear = table_of(errors, "5.4 linear");
  for (const char* element : kElements) {
    const auto root_sum_square = [&](const std::string& method) {
      double squares = 0.0;
      for (const ReproducedRow& row : linear.rows) {
        squares += std::pow(value_of(linear, row.name, method + " " + element), 2);
      }
      return std::sqrt(squares);
    };
    EXPECT_GT(root_sum_square("method 1"), 2.0 * root_sum_square("method 1 with Coulomb")) << element;
    EXPECT_LT(root_sum_square("method 2"), 0.2) << element;
  }
  // What springs on the disc turn is torque to the robot and nothing to the sensor: theoretical − identified is below
  // 0.
  const ReproducedTable& springs = table_of(errors, "5.4 stiffness");
  EXPECT_LT(value_of(springs, "K5", "method 1 k_xx"), value_of(springs, "K5", "method 2 k_xx") - 3.0);
  for (const ReproducedRow& row : table_of(vaf, "5.5").rows) {
    for (const ReproducedColumn& column : table_of(vaf, "5.5").columns) {
      const double viscous = value_of(table_of(vaf, "5.5"), row.name, column.name);
      EXPECT_GT(viscous, 90.0);
      EXPECT_GT(value_of(table_of(vaf, "5.5 with Coulomb"), row.name, column.name), viscous);
      EXPECT_GT(value_of(table_of(vaf, "5.5 method 2"), row.name, column.name), 99.0);
    }
  }
}

TEST(VirtualSensorExhibits, DrawBothForcesOfARig) {
  const Reproduction all = made({"figure-5.3"});
  expect_charts(all.exhibits.front(), 5);
  for (std::size_t k = 3; k < 5; ++k) {
    const Chart& force = all.exhibits.front().charts.at(k);
    double largest = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < force.series[0].y.size(); ++i) {
      largest = std::max(largest, std::abs(force.series[0].y[i]));
      apart = std::max(apart, std::abs(force.series[0].y[i] - force.series[1].y[i]));
    }
    EXPECT_LT(apart, 1.0);  // [N]
    EXPECT_GT(largest, 3.0 * apart);
  }
}

TEST(VirtualSensorExhibits, FindTheRelaxedArmByBothMethods) {
  const Reproduction all = made({"table-5.6"}, 2);
  EXPECT_EQ(result::to_json(all), result::to_json(made({"table-5.6"}, 1)));  // on any number of threads
  const ReproducedTable& arm = table_of(all.exhibits.front(), "5.6");
  for (const char* diagonal : {"m_xx", "m_yy", "b_xx", "b_yy", "k_xx", "k_yy"}) {
    const double truth = value_of(arm, "simulated arm", diagonal);
    for (const char* method : {"method 1 with Coulomb", "method 2"}) {
      EXPECT_NEAR(value_of(arm, method, diagonal), truth, 0.05 * truth) << method << " " << diagonal;
    }
    EXPECT_GT(cell_of(arm, "method 2", diagonal).spread.value_or(0.0), 0.0);
  }
  for (const char* damping : {"b_xx", "b_yy"}) {  // takes what the model has no Coulomb friction for
    EXPECT_GT(value_of(arm, "method 1", damping), 1.05 * value_of(arm, "method 2", damping));
  }
  for (const char* vaf : {"VAF x", "VAF y"}) EXPECT_GT(value_of(arm, "method 1", vaf), 90.0);
  EXPECT_EQ(table_of(all.exhibits.front(), "5.6 others").rows.size(), 16u);
}

}  // namespace
}  // namespace mbk::thesis
