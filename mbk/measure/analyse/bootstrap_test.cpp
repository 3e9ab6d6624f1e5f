#include "mbk/measure/analyse/bootstrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "mbk/base/numeric/block_bootstrap.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::analyse {
namespace bootstrap_test {

constexpr double kPi = std::numbers::pi;

/// An arm whose replicates lie about it in pairs, so that no number that is linear in them has a bias.
Identification arm(const Matrix& K, double error_of_stiffness = 5.0) {
  Identification id;
  id.model.M = Matrix{{1.3, -0.9}, {-0.9, 1.9}};
  id.model.B = Matrix{{6.0, -2.0}, {-2.0, 10.0}};
  id.model.K = K;
  id.model.x0 = Vector::Zero(2);
  id.parameters = {"m_xx", "m_xy", "m_yx", "m_yy", "b_xx", "b_xy", "b_yx",
                   "b_yy", "k_xx", "k_xy", "k_yx", "k_yy", "x0",   "y0"};
  Vector errors(14);
  errors << Vector::Constant(4, 0.02), Vector::Constant(4, 0.3), Vector::Constant(4, error_of_stiffness), 1e-3, 1e-3;
  id.covariance = errors.cwiseAbs2().asDiagonal();
  constexpr Index kPairs = 2000;
  Replicates replicates{Matrix(14, 2 * kPairs), 2.5, 20.0, 4};
  numeric::Random random(1);
  for (Index k = 0; k < kPairs; ++k) {
    Vector step(14);
    for (Index i = 0; i < 14; ++i) step[i] = errors[i] * random.normal();
    replicates.models.col(2 * k) = impedance::stacked(id.model) + step;
    replicates.models.col(2 * k + 1) = impedance::stacked(id.model) - step;
  }
  id.replicates = replicates;
  return id;
}

const Matrix kStiffness{{42.4, -28.6}, {-28.6, 125.3}};

BootstrapFinding finding(const Identification& id, const std::string& name) {
  const auto all = bootstrap_findings(id);
  EXPECT_TRUE(all) << all.error().line();
  const auto found = std::ranges::find(all->findings, name, &BootstrapFinding::name);
  EXPECT_NE(found, all->findings.end()) << name;
  return found == all->findings.end() ? BootstrapFinding{} : *found;
}

TEST(BootstrapFindings, AreThePlainQuantilesStretchedForTheNumberOfBlocks) {
  const Identification id = arm(kStiffness);
  const BootstrapFinding found = finding(id, "k_xx");
  Vector drawn = id.replicates->models.row(8).transpose();
  std::ranges::sort(drawn);
  const double widening = numeric::newey_west_widening(1.0 / 20.0);
  EXPECT_GT(widening, 1.05);
  // Without a bias the quantiles are those of 2.5 and 97.5 %; the last pair may stand on either side of the middle.
  constexpr double kRank = 0.03;
  EXPECT_NEAR(found.interval95.first, 42.4 + widening * (numeric::quantile(drawn, 0.025) - 42.4), kRank);
  EXPECT_NEAR(found.interval95.second, 42.4 + widening * (numeric::quantile(drawn, 0.975) - 42.4), kRank);
  EXPECT_NEAR(found.delta95.first, 42.4 - numeric::kNormal95 * 5.0, 1e-12);
  EXPECT_EQ(found.unit, "N/m");
}

TEST(BootstrapFindings, AgreeWithTheDeltaMethodWhereTheNumbersAreNearlyStraight) {
  const auto all = bootstrap_findings(arm(kStiffness, 0.5));
  ASSERT_TRUE(all);
  EXPECT_EQ(all->findings.size(), 14U + 17U + 1U);
  const double widening = numeric::newey_west_widening(1.0 / 20.0);
  for (const BootstrapFinding& one : all->findings) {
    const double ratio = (one.interval95.second - one.interval95.first) / (one.delta95.second - one.delta95.first);
    EXPECT_NEAR(ratio / widening, 1.0, 0.1) << one.name;
  }
}

// An angle of 180° is one of 0°, and the arctangent of (3.17) turns over at ±90°.
TEST(BootstrapFindings, OfAnOrientationAreNotTornAtTheEndsOfItsRange) {
  for (const auto& [K, about] : {std::pair{Matrix{{200.0, 0.3}, {0.3, 50.0}}, 0.002},
                                 std::pair{Matrix{{200.0, -0.3}, {-0.3, 50.0}}, kPi - 0.002},
                                 std::pair{Matrix{{50.0, 0.3}, {0.3, 200.0}}, kPi / 2.0 - 0.002},
                                 std::pair{Matrix{{50.0, -0.3}, {-0.3, 200.0}}, kPi / 2.0 + 0.002}}) {
    const BootstrapFinding found = finding(arm(K), "stiffness orientation");
    EXPECT_NEAR(found.value, about, 1e-4);
    // dθ = dk_s/(k_xx − k_yy): 5/√2 N/m over 150 N/m.
    const double half = numeric::newey_west_widening(0.05) * numeric::kNormal95 * 5.0 / std::sqrt(2.0) / 150.0;
    EXPECT_NEAR(found.interval95.first, about - half, 0.1 * half);
    EXPECT_NEAR(found.interval95.second, about + half, 0.1 * half);
  }
}

TEST(BootstrapFindings, AreUndefinedWhereAReplicateIs) {
  const Identification id = arm(kStiffness, 20.0);  // the smallest eigenvalue, 33, is negative in some
  EXPECT_TRUE(std::isnan(finding(id, "stiffness area").interval95.first));
  EXPECT_TRUE(std::isnan(finding(id, "stiffness shape").interval95.second));
  EXPECT_LT(finding(id, "stiffness smallest eigenvalue").interval95.first, 0.0);
  EXPECT_TRUE(std::isfinite(finding(id, "inertia area").interval95.first));
}

TEST(BootstrapFindings, OfOneAxisAreItsParametersAndItsExcess) {
  Identification id;
  id.axes = 1;
  id.motion = Motion::rotation;
  id.model = impedance::unstacked((Vector(4) << 0.02, 0.9, 60.0, 0.0).finished(), 1);
  id.parameters = {"m", "b", "k", "x0"};
  id.covariance = Matrix::Identity(4, 4) * 1e-4;
  id.replicates = Replicates{impedance::stacked(id.model).replicate(1, 10), 2.5, 20.0, 1};
  const auto all = bootstrap_findings(id);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->findings.size(), 5U);
  EXPECT_EQ(all->findings[0].unit, "kg·m²");
  EXPECT_EQ(all->findings[4].name, "excess of passivity");
  EXPECT_EQ(all->findings[4].value, 0.9);
}

TEST(BootstrapFindings, NeedABootstrap) {
  Identification id = arm(kStiffness);
  id.replicates.reset();
  EXPECT_FALSE(bootstrap_findings(id));
}

}  // namespace bootstrap_test
}  // namespace mbk::analyse
