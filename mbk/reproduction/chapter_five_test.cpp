#include <gtest/gtest.h>

#include <cmath>

#include "mbk/reproduction/reproduce.h"
#include "mbk/result/reproduction_json.h"

namespace mbk::reproduction {
namespace {

Source the_source() {
  auto source = read_source(source_text());
  EXPECT_TRUE(source) << source.error().line();
  return *source;
}

Reproduction made(const std::vector<std::string>& only, unsigned threads = 0, bool printed = true) {
  Source source = the_source();
  if (!printed) source.printed.clear();
  ReproduceOptions options;
  options.only = only;
  options.threads = threads;
  auto reproduction = reproduce(source, options);
  EXPECT_TRUE(reproduction) << reproduction.error().line();
  return *reproduction;
}

const Exhibit& exhibit_of(const Reproduction& reproduction, std::string_view id) {
  for (const Exhibit& exhibit : reproduction.exhibits) {
    if (exhibit.id == id) return exhibit;
  }
  ADD_FAILURE() << "no exhibit " << id;
  return reproduction.exhibits.front();
}

const ReproducedTable& table_of(const Exhibit& exhibit, std::string_view id) {
  for (const ReproducedTable& table : exhibit.tables) {
    if (table.id == id) return table;
  }
  ADD_FAILURE() << exhibit.id << " has no table " << id;
  return exhibit.tables.front();
}

const ReproducedCell& cell_of(const ReproducedTable& table, std::string_view row, std::string_view column) {
  for (const ReproducedRow& one : table.rows) {
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      if (one.name == row && table.columns[k].name == column) return one.cells.at(k);
    }
  }
  ADD_FAILURE() << table.id << " has no cell " << row << ", " << column;
  return table.rows.front().cells.front();
}

double value_of(const ReproducedTable& table, std::string_view row, std::string_view column) {
  return cell_of(table, row, column).ours.value_or(NAN);
}

/// Every cell that the source prints stands beside one of ours that is a number.
void expect_all_found(const Exhibit& exhibit, std::string_view id) {
  const Source source = the_source();
  const PrintedTable& printed = source.printed.at(std::string(id));
  const ReproducedTable& ours = table_of(exhibit, id);
  for (const auto& [row, cells] : printed.rows) {
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const ReproducedCell& cell = cell_of(ours, row, printed.columns[k]);
      EXPECT_EQ(cell.printed, cells[k].text) << row << ", " << printed.columns[k];
      EXPECT_TRUE(cell.ours && std::isfinite(*cell.ours)) << row << ", " << printed.columns[k];
      EXPECT_EQ(cell.agreement, Agreement::not_compared);  // simulated
    }
  }
}

void expect_charts(const Exhibit& exhibit, std::size_t count) {
  EXPECT_EQ(exhibit.charts.size(), count);
  constexpr std::size_t kPoints = 600;
  for (const Chart& chart : exhibit.charts) {
    EXPECT_FALSE(chart.x.unit.empty()) << chart.title;
    EXPECT_FALSE(chart.y.unit.empty()) << chart.title;
    for (const ChartSeries& series : chart.series) {
      EXPECT_EQ(series.x.size(), series.y.size()) << series.name;
      EXPECT_GT(series.x.size(), 0u) << series.name;
      EXPECT_LE(series.x.size(), kPoints) << series.name;
    }
  }
}

const char* const kElements[] = {"k_xx", "k_yy", "k_s"};

TEST(RigExhibits, ReconstructedSpringsHaveTheStiffnessThatTheyWereDesignedFor) {
  const Reproduction all = made({"table-3.1", "table-5.1"});
  const Exhibit &of_3 = exhibit_of(all, "table-3.1"), &of_5 = exhibit_of(all, "table-5.1");
  for (const char* id : {"5.1 stiffness", "5.1 mass"}) expect_all_found(of_5, id);
  expect_all_found(of_3, "3.1");
  constexpr double kStiffness = 1.0, kGrid = 0.1;  // [N/m], [mm]
  const ReproducedTable &springs = table_of(of_5, "5.1 stiffness"), &grid = table_of(of_5, "5.1 by grid");
  for (const PrintedRig& rig : the_source().given.stiffnesses) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(value_of(springs, rig.name, kElements[k]), rig.theoretical[k].value, kStiffness) << rig.name;
      EXPECT_NEAR(value_of(grid, rig.name, kElements[k]), rig.theoretical[k].value, kStiffness) << rig.name;
    }
    // A grid of 0.15 mm finds the equilibrium to half a step in each direction.
    EXPECT_NEAR(value_of(grid, rig.name, "x0"), value_of(springs, rig.name, "x0"), kGrid);
  }
  for (const PrintedRig& rig : the_source().given.masses) {
    EXPECT_EQ(value_of(table_of(of_5, "5.1 mass"), rig.name, "m"), rig.theoretical[0].value);
  }
  for (const ReproducedRow& row : table_of(of_3, "3.1").rows) {
    for (const ReproducedCell& cell : row.cells) EXPECT_LT(std::abs(*cell.difference()), kStiffness) << row.name;
  }
}

TEST(RigExhibits, FindRigsUnderPulsesAndThatTheirDamperIsTakenForMass) {
  const Reproduction all = made({"figure-3.8"});
  const Exhibit& exhibit = all.exhibits.front();
  expect_charts(exhibit, 2);
  const ReproducedTable& errors = table_of(exhibit, "3.8 errors");
  ASSERT_EQ(errors.rows.size(), 6u);
  for (const ReproducedRow& row : errors.rows) {
    for (const char* element : kElements) EXPECT_LT(std::abs(value_of(errors, row.name, element)), 8.0) << row.name;
    EXPECT_LT(std::abs(value_of(errors, row.name, "x0")), 0.1) << row.name;  // [mm]
    EXPECT_GT(value_of(errors, row.name, "m"), 0.0) << row.name;
    EXPECT_LT(value_of(errors, row.name, "m"), 0.02) << row.name;
  }
  const ReproducedTable& causes = table_of(exhibit, "3.8 causes");
  EXPECT_GT(value_of(causes, "linear fields, damper of 1 N·s/m", "m"),
            3.0 * std::abs(value_of(causes, "linear fields, no damper", "m")));
}

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

TEST(RigExhibits, AreTheSameWithoutThePrintedNumbers) {
  const Reproduction with = made({"table-5.1"}), without = made({"table-5.1"}, 0, false);
  const ReproducedTable &one = with.exhibits.front().tables.front(), &two = without.exhibits.front().tables.front();
  for (std::size_t i = 0; i < one.rows.size(); ++i) {
    for (std::size_t k = 0; k < one.columns.size(); ++k) {
      EXPECT_EQ(one.rows[i].cells[k].ours, two.rows[i].cells[k].ours);
      EXPECT_TRUE(two.rows[i].cells[k].printed.empty());
    }
  }
}

}  // namespace
}  // namespace mbk::reproduction
