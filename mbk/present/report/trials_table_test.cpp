#include "mbk/present/report/trials_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace mbk::report {
namespace trials_table_test {

/// Three axes: element i of M, B, K and x₀ is i + 1.
Measurement measured() {
  Measurement one;
  Identification& id = one.identification;
  id.axes = 3;
  id.model = impedance::unstacked(Vector::LinSpaced(30, 1.0, 30.0), 3);
  id.standard_error = impedance::unstacked(Vector::Constant(30, 0.1), 3);
  id.fit = {Eigen::Vector3d(97.1, 98.2, 99.3), Vector::Ones(3), Vector::Ones(3), true};
  id.sources.push_back({"a.mat", "MAT v7", "abc"});
  one.spatial.emplace();
  for (EllipsoidFinding& finding : one.spatial->ellipsoids) {
    for (PrincipalDirection& principal : finding.principal) principal.direction = Eigen::Vector3d(0.6, 0.0, 0.8);
    finding.principal[1] = {41.5, {40.0, 43.0}, Eigen::Vector3d(0.6, 0.0, 0.8), 0.25 * std::numbers::pi};
    finding.volume = 7.5;
    finding.volume95 = {7.0, 8.0};
  }
  return one;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST(TrialsCsv, ThreeAxesHaveAColumnForEachElementAndPrincipalDirection) {
  const Measurement one = measured();
  std::istringstream lines(trials_csv({&one, 1}, SeveralTrials{}));
  std::string head, row;
  std::getline(lines, head);
  std::getline(lines, row);
  const std::vector<std::string> names = cells_of(head), values = cells_of(row);
  const auto value = [&](const std::string& name) {
    const auto found = std::ranges::find(names, name);
    EXPECT_NE(found, names.end()) << name;
    const auto at = static_cast<std::size_t>(found - names.begin());
    return at < values.size() ? values[at] : "";
  };
  EXPECT_EQ(value("m_xx [kg]"), "1");
  EXPECT_EQ(value("m_xz [kg]"), "3");
  EXPECT_EQ(value("b_zx [N·s/m]"), "16");
  EXPECT_EQ(value("k_zz [N/m]"), "27");
  EXPECT_EQ(value("z0 [m]"), "30");
  EXPECT_EQ(value("VAF_z [%]"), "99.3");
  EXPECT_EQ(value("stiffness_principal_2 [N/m]"), "41.5");
  EXPECT_EQ(value("stiffness_principal_2 95 % low [N/m]"), "40");
  EXPECT_EQ(value("stiffness_direction_2_z"), "0.8");
  EXPECT_EQ(value("stiffness_half_angle_2 [°]"), "45");
  EXPECT_EQ(value("stiffness_ellipsoid_volume [(N/m)³]"), "7.5");
}

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(TrialsLatex, ThreeAxesHaveATableForEachMatrix) {
  const std::vector<Measurement> two = {measured(), measured()};
  const std::string text = trials_latex(two, SeveralTrials{});
  EXPECT_EQ(count_of(text, "\\toprule"), 3u);
  for (const char* symbol : {"$M_{xz}$", "$B_{zz}$", "$K_{zy}$"}) EXPECT_EQ(count_of(text, symbol), 1u) << symbol;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("a.mat")) continue;
    EXPECT_EQ(count_of(line, "&"), 12u) << line;  // nine elements, three VAF
  }
}

TEST(TrialsLatex, OneTrialOfThreeAxesHasMatricesOfThreeRows) {
  const Measurement one = measured();
  const std::string text = trials_latex({&one, 1}, SeveralTrials{});
  EXPECT_EQ(count_of(text, "\\begin{bmatrix}"), 4u);
  EXPECT_THAT(text, testing::HasSubstr("along $z$"));
}

}  // namespace trials_table_test
}  // namespace mbk::report
