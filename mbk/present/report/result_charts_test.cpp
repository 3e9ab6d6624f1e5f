#include "mbk/present/report/result_charts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace mbk::report {
namespace result_charts_test {

/// A stiffness with principal values of 400, 200 and 100 N/m along turned axes; inertia and damping are open.
Measurement measured() {
  const Matrix turned = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  Measurement one;
  one.identification.axes = 3;
  one.spatial.emplace();
  for (EllipsoidFinding& finding : one.spatial->ellipsoids) {
    finding.symmetric = turned * Eigen::Vector3d(400.0, 200.0, 100.0).asDiagonal() * turned.transpose();
  }
  one.spatial->ellipsoids[2].closed = true;
  return one;
}

std::vector<std::string> names_of(const std::vector<NamedChart>& charts) {
  std::vector<std::string> names;
  for (const NamedChart& one : charts) names.push_back(one.name);
  return names;
}

TEST(MeasurementCharts, AClosedEllipsoidHasThreeProjectionsAndTheFigureOfThem) {
  const auto charts = measurement_charts(measured(), std::nullopt);
  EXPECT_THAT(names_of(charts), testing::ElementsAre("stiffness-ellipsoid-xy", "stiffness-ellipsoid-xz",
                                                     "stiffness-ellipsoid-yz", "stiffness-ellipsoid"));
  EXPECT_EQ(charts.back().beside.size(), 2u);
  EXPECT_EQ(charts[1].chart.x.label, "along x");
  EXPECT_EQ(charts[1].chart.y.label, "along z");
  EXPECT_EQ(charts[1].chart.x.unit, "N/m");
  Measurement unusable = measured();
  unusable.identification.usable = false;
  EXPECT_TRUE(measurement_charts(unusable, std::nullopt).empty());
}

/// The forces to unit motions in all directions, at steps of 0.016 rad.
std::vector<Eigen::Vector3d> forces_of(const Eigen::Matrix3d& S) {
  constexpr int kSteps = 200;
  std::vector<Eigen::Vector3d> forces;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j < 2 * kSteps; ++j) {
      const double polar = std::numbers::pi * i / kSteps, turn = std::numbers::pi * j / kSteps;
      forces.emplace_back(
          S * Eigen::Vector3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)));
    }
  }
  return forces;
}

TEST(MeasurementCharts, AProjectionIsTheOutlineOfAllForces) {
  const Measurement one = measured();
  const auto forces = forces_of(one.spatial->ellipsoids[2].symmetric);
  const auto charts = measurement_charts(one, std::nullopt);
  constexpr double kSampled = 2e-4;  // the outline has a point every 2°: 1 − cos 1° = 1.5e-4
  const std::array<std::array<Index, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const ChartSeries& outline = charts[k].chart.series.front();
    for (int side = 0; side < 12; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / 12;
      const auto along = [&](double x, double y) { return std::cos(angle) * x + std::sin(angle) * y; };
      double drawn = 0.0, reached = 0.0;
      for (std::size_t i = 0; i < outline.x.size(); ++i) drawn = std::max(drawn, along(outline.x[i], outline.y[i]));
      for (const Eigen::Vector3d& force : forces) {
        reached = std::max(reached, along(force[planes[k][0]], force[planes[k][1]]));
      }
      EXPECT_NEAR(drawn, reached, kSampled * reached) << charts[k].name << " at " << angle;
    }
  }
}

}  // namespace result_charts_test
}  // namespace mbk::report
