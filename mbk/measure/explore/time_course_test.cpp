#include "mbk/measure/explore/time_course.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "mbk/base/numeric/dense.h"
#include "mbk/measure/explore/test_limb_trials.h"
#include "mbk/measure/explore/varying_regression.h"

namespace mbk::explore {
namespace time_course_test {

constexpr Index kRows = 7500;  // one minute
constexpr double kBand = 8.0, kMass = 0.5, kDamping = 8.0, kStiffness = 200.0;

double seconds(Index row) {
  return kStep * static_cast<double>(row);
}

/// A limb of one axis whose stiffness is multiplied, with wandering noise.
LimbSignals limb(const std::function<double(double)>& factor, std::uint64_t seed, double drift = 0.0) {
  LimbSignals signals;
  signals.sample_time = kStep;
  const Vector x = 0.02 * binary_motion(kRows, seed);
  signals.position = x;
  signals.velocity = velocity_of(x);
  signals.acceleration = velocity_of(signals.velocity);
  signals.resistance = kMass * signals.acceleration + kDamping * signals.velocity + 0.5 * coloured_noise(kRows, seed);
  for (Index t = 0; t < kRows; ++t) {
    signals.resistance(t, 0) += kStiffness * factor(seconds(t)) * x[t] + drift * seconds(t);
  }
  signals.pieces = {{10, kRows - 10}};  // without the ends of the differences
  signals.first_sample = 0;
  return signals;
}

CourseVariable time_of(const LimbSignals& signals) {
  CourseVariable variable;
  Vector values(signals.position.rows());
  for (Index t = 0; t < values.size(); ++t) values[t] = seconds(t);
  variable.values.push_back(values);
  return variable;
}

TEST(TimeCourse, FollowsAStiffnessThatTriples) {
  const auto factor = [](double t) { return t < 30.0 ? 1.0 : t > 31.0 ? 3.0 : 1.0 + 2.0 * (t - 30.0); };
  const LimbSignals signals = limb(factor, 1);
  const auto found = time_course(signals, time_of(signals), kBand);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_TRUE(found->changes) << found->why;
  EXPECT_FALSE(found->instruments);
  EXPECT_LT(found->p_value, 1e-6);
  for (Index k = 0; k < found->at.size(); ++k) {
    const double t = found->at[k];
    if (std::abs(t - 30.5) < 2.0 || t < found->from + 2.0 || t > found->to - 2.0) continue;
    EXPECT_NEAR(found->K.value(k, 0), kStiffness * factor(t), 0.15 * kStiffness * factor(t)) << t;
  }
}

TEST(TimeCourse, FollowsAChannel) {
  const auto angle = [](double t) { return std::sin(0.5 * t); };
  const LimbSignals signals = limb([&](double t) { return 1.5 + angle(t); }, 2);
  CourseVariable variable = time_of(signals);
  variable.name = "joint_1";
  variable.unit = "rad";
  for (double& value : variable.values.front()) value = angle(value);
  const auto found = time_course(signals, variable, kBand);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_TRUE(found->changes) << found->why;
  EXPECT_EQ(found->unit, "rad");
  for (Index k = 2; k + 2 < found->at.size(); ++k) {
    EXPECT_NEAR(found->K.value(k, 0), kStiffness * (1.5 + found->at[k]), 0.15 * kStiffness) << found->at[k];
  }
}

TEST(TimeCourse, CallsAConstantLimbConstantAlsoWhereTheForceDrifts) {
  int changing = 0;
  for (std::uint64_t seed = 10; seed < 22; ++seed) {
    for (const double drift : {0.0, 0.05}) {
      const LimbSignals signals = limb([](double) { return 1.0; }, seed, drift);
      const auto found = time_course(signals, time_of(signals), kBand);
      ASSERT_TRUE(found) << found.error().line();
      changing += found->changes ? 1 : 0;
      EXPECT_NEAR(found->K.mean(0, 0), kStiffness, 4.0 * found->K.mean_half_width(0, 0) + 2.0);
    }
  }
  EXPECT_LE(changing, 1);
}

TEST(TimeCourse, NeedsAVariableThatChangesAndRows) {
  const LimbSignals signals = limb([](double) { return 1.0; }, 1);
  CourseVariable variable = time_of(signals);
  variable.values.front().setConstant(3.0);
  EXPECT_FALSE(time_course(signals, variable, kBand));
  variable.values.front().setConstant(std::nan(""));
  EXPECT_FALSE(time_course(signals, variable, kBand));
}

/// Least squares on all columns at once.
double plain_bic(const VaryingRows& rows, const SplineBasis& basis) {
  const Matrix Z = varying_columns(rows.Z, basis, rows.s);
  const auto count = static_cast<double>(Z.rows());
  const Vector rest = rows.Y - Z * numeric::householder_solve(Z, rows.Y);
  const auto placed = basis.knots.size();
  return count * std::log(rest.squaredNorm() / count) +
         static_cast<double>(Z.cols() + static_cast<Index>(placed)) * std::log(count);
}

TEST(VaryingRegression, HasTheBicOfPlainLeastSquares) {
  constexpr Index kCount = 1200;
  VaryingRows rows;
  rows.Z = white_noise(kCount, 2, 3);
  rows.Z.col(1).setOnes();
  rows.R = rows.Z;
  rows.s = Vector::LinSpaced(kCount, 0.0, 1.0);
  rows.Y = 0.3 * white_noise(kCount, 1, 9);
  for (Index t = 0; t < kCount; ++t) rows.Y(t, 0) += (rows.s[t] < 0.5 ? 1.0 : 2.0) * rows.Z(t, 0);
  rows.ranges = {{0, kCount}};
  const ChosenSplines chosen = choose_splines(rows, {Vector::Ones(1)}, {2});
  EXPECT_NEAR(chosen.bic_constant, plain_bic(rows, {0, {}}), 1e-6);
  ASSERT_GE(chosen.model.basis.size(), 4);
  const double placed = static_cast<double>(chosen.model.basis.knots.size()) * std::log(static_cast<double>(kCount));
  const double twin = plain_bic(rows, chosen.model.basis);  // knots at equal distances were not placed one by one
  EXPECT_LT(std::min(std::abs(chosen.bic - twin), std::abs(chosen.bic + placed - twin)), 1e-4);
  EXPECT_LT(chosen.bic, chosen.bic_constant);
  const VaryingFit fit = fit_varying(rows, chosen.model, {Vector::Ones(1)});
  const Matrix Z = varying_columns(rows.Z, chosen.model.basis, rows.s);
  EXPECT_LT((fit.coefficients - numeric::householder_solve(Z, rows.Y)).norm(), 1e-8);
}

// In the first half the hand moves along x alone: what K_xy is then nobody can say, and K_xx is not taken from there.
TEST(ChooseSplines, LetsNoFunctionLiveOnRowsThatMoveTheHandAlongOneLine) {
  constexpr Index kCount = 2000;
  for (const bool along_one_line : {true, false}) {
    VaryingRows rows;
    rows.s = Vector::LinSpaced(kCount, 0.0, 1.0);
    rows.Z = Matrix::Ones(kCount, 3);
    rows.Z.col(0) = binary_motion(kCount, 5);
    rows.Z.col(1) = binary_motion(kCount, 6);
    if (along_one_line) {
      rows.Z.col(0).tail(kCount / 2).setZero();
      rows.Z.col(1).head(kCount / 2).setZero();
    }
    rows.R = rows.Z;
    rows.ranges = {{0, kCount}};
    rows.Y = 0.1 * coloured_noise(kCount, 7);
    for (Index t = 0; t < kCount; ++t) rows.Y(t, 0) += (rows.s[t] < 0.25 ? 1.0 : 2.0) * rows.Z(t, 0) + rows.Z(t, 1);
    const ChosenSplines chosen = choose_splines(rows, {Vector::Ones(1)}, {3});
    for (const double knot : chosen.model.basis.knots) {
      EXPECT_TRUE(!along_one_line) << "a knot at " << knot;
    }
    EXPECT_EQ(chosen.model.basis.size() > 4, !along_one_line);
  }
}

}  // namespace time_course_test
}  // namespace mbk::explore
