#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "thesis/test_exhibits.h"

namespace mbk::thesis {
namespace {

TEST(ApparatusExhibits, FindTheRobotAndWhatFrictionIsTakenForWithoutCoulomb) {
  const Reproduction all = made({"table-A.1", "figure-A.4"});
  const Exhibit& robot = exhibit_of(all, "table-A.1");
  expect_all_found(robot, "A.1");
  expect_charts(exhibit_of(all, "figure-A.4"), 4);
  const ReproducedTable &viscous = table_of(robot, "A.1"), &by_default = table_of(robot, "A.1 by default");
  for (const char* inertia : {"α1", "α2", "α3"}) EXPECT_LT(std::abs(value_of(viscous, inertia, "error")), 1.0);
  for (const char* friction : {"α4", "α5"}) EXPECT_GT(value_of(viscous, friction, "error"), 5.0);
  for (const ReproducedRow& row : by_default.rows) {
    EXPECT_LT(std::abs(value_of(by_default, row.name, "error")), 0.05) << row.name;
    EXPECT_GT(value_of(by_default, row.name, "standard deviation"), 0.0) << row.name;
  }
  const ReproducedTable& torque = table_of(robot, "A.1 torque");
  EXPECT_GT(value_of(torque, "viscous friction, as published", "VAF τ1"), 99.0);
  EXPECT_GT(value_of(torque, "viscous friction, as published", "VAF τ2"), 90.0);
  EXPECT_GT(value_of(torque, "with Coulomb friction and the printed Coriolis sign", "RMSE τ2"),
            10.0 * value_of(torque, "with Coulomb friction", "RMSE τ2"));
}

TEST(ApparatusExhibits, DrawTheWorkspaceWithItsArea) {
  const Reproduction all = made({"figure-A.2"});
  const Exhibit& exhibit = all.exhibits.front();
  expect_charts(exhibit, 1);
  const Chart& chart = exhibit.charts.front();
  EXPECT_TRUE(chart.equal_scale);
  const ChartSeries& outline = chart.series.front();
  EXPECT_EQ(outline.x.front(), outline.x.back());
  double twice = 0.0;
  for (std::size_t i = 0; i + 1 < outline.x.size(); ++i) {
    twice += outline.x[i] * outline.y[i + 1] - outline.x[i + 1] * outline.y[i];
  }
  const double area = value_of(table_of(exhibit, "A.2"), "area", "value");  // [cm²]
  EXPECT_NEAR(std::abs(twice) / 200.0, area, 0.001 * area);
  EXPECT_GT(value_of(table_of(exhibit, "A.2"), "nearest limit from there", "value"), 5.0);
}

TEST(ApparatusExhibits, CalibrateAStrainGaugeAndShowThatTheConverterIsCoarserThanTheNoise) {
  const Reproduction all = made({"table-E.2", "figure-E.5"});
  const Exhibit& exhibit = exhibit_of(all, "table-E.2");
  expect_all_found(exhibit, "E.2");
  expect_charts(exhibit_of(all, "figure-E.5"), 2);
  const ReproducedTable &exact = table_of(exhibit, "E.2"), &scattered = table_of(exhibit, "E.2 scattered"),
                        &inverted = table_of(exhibit, "E.2 scattered inverted");
  const std::pair<const char*, double> slopes[] = {{"Fx", -8.56}, {"Fy", -8.15}};  // of the simulated sensor [N/V]
  for (const auto& [axis, slope] : slopes) {
    EXPECT_NEAR(value_of(exact, axis, "slope"), slope, 4.0 * value_of(exact, axis, "slope, standard error")) << axis;
    EXPECT_NEAR(value_of(scattered, axis, "slope"), slope, 4.0 * value_of(scattered, axis, "slope, standard error"));
    EXPECT_LT(value_of(exact, axis, "slope, standard error"), 0.1 * value_of(scattered, axis, "slope, standard error"));
    // The published regression is too flat by R².
    EXPECT_NEAR(value_of(scattered, axis, "slope") / value_of(inverted, axis, "slope"), value_of(scattered, axis, "R²"),
                1e-4);
  }
  const ReproducedTable& resolution = table_of(exhibit, "E.2 resolution");
  EXPECT_NEAR(value_of(resolution, "Fx", "one code"), 0.0418, 1e-4);
  EXPECT_NEAR(value_of(resolution, "Fx", "error, noise alone (RMS)"), 0.010, 5e-4);
  EXPECT_NEAR(value_of(resolution, "Fx", "error, converter alone (RMS)"), value_of(resolution, "Fx", "one code / √12"),
              2e-4);
  EXPECT_GT(value_of(resolution, "Fx", "error, both (RMS)"), 0.012);
}

}  // namespace
}  // namespace mbk::thesis
