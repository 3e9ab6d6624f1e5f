#include "mbk/measure/analyse/movement_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mbk::analyse {
namespace movement_quality_test {

constexpr double kDigits = 1e-12;

/// exp(−5t²), t = −1, −0.99 … 0.99.
Vector bell() {
  Vector v(200);
  for (Index i = 0; i < v.size(); ++i) {
    const double t = -1.0 + 0.01 * static_cast<double>(i);
    v[i] = std::exp(-5.0 * t * t);
  }
  return v;
}

/// Place of a minimum-jerk reach of length 1 and duration 1 (Flash & Hogan 1985).
double minimum_jerk(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

TEST(SpectralArcLength, HasThePublishedValueOfABell) {
  EXPECT_NEAR(*spectral_arc_length(bell(), Hertz(100.0)), -1.4140312617104787, kDigits);
}

TEST(LogDimensionlessJerk, HasThePublishedValueOfABell) {
  EXPECT_NEAR(*log_dimensionless_jerk(bell(), Hertz(100.0)), -5.816357414756398, kDigits);
}

TEST(LogDimensionlessJerk, OfAMinimumJerkReachIsTheLogarithmOf204Point8) {
  Vector v(1001);
  for (Index i = 0; i < v.size(); ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    v[i] = 30.0 * t * t * (1.0 - t) * (1.0 - t);
  }
  constexpr double kOneSampleMore = 4e-3;  // the duration is that of n samples, cubed
  EXPECT_NEAR(*log_dimensionless_jerk(v, Hertz(1000.0)), -std::log(204.8), kOneSampleMore);
  EXPECT_NEAR(*spectral_arc_length(v, Hertz(1000.0)), -1.4024, 1e-4);
  EXPECT_NEAR(v.mean() / v.maxCoeff(), 0.5333, 1e-3);
}

TEST(Smoothness, DoesNotDependOnTheSizeOfTheMovement) {
  EXPECT_NEAR(*spectral_arc_length(7.0 * bell(), Hertz(100.0)), *spectral_arc_length(bell(), Hertz(100.0)), kDigits);
  EXPECT_NEAR(*log_dimensionless_jerk(7.0 * bell(), Hertz(100.0)), *log_dimensionless_jerk(bell(), Hertz(100.0)),
              kDigits);
}

TEST(Smoothness, RefusesAConstantSpeed) {
  for (const double speed : {0.0, 0.3}) {
    const Vector constant = Vector::Constant(100, speed);
    EXPECT_EQ(spectral_arc_length(constant, Hertz(100.0)).error().kind, ErrorKind::data);
    EXPECT_EQ(log_dimensionless_jerk(constant, Hertz(100.0)).error().kind, ErrorKind::data);
  }
  EXPECT_FALSE(log_dimensionless_jerk(Vector::LinSpaced(100, 0.0, 1.0 / 0.0), Hertz(100.0)));
  EXPECT_FALSE(spectral_arc_length(bell(), Hertz(10.0)));
  EXPECT_FALSE(spectral_arc_length(Vector::Ones(2), Hertz(100.0)));
}

TEST(CountPeaks, CountsThoseThatStandOut) {
  EXPECT_EQ(count_peaks(bell()), 1);
  EXPECT_EQ(count_peaks(Vector{{0, 1, 0.2, 0.9, 0.1, 0.13, 0.1, 0.5, 0.5}}), 3);
  EXPECT_EQ(count_peaks(Vector{{0, 0.5, 1.0}}), 1);
  EXPECT_EQ(count_peaks(Vector{{1.0, 0.5, 0.0}}), 1);
}

/// Two reaches of 0.2 m in a plane, to and fro, 1 s each, and what the robot does.
struct Session {
  Matrix position = Matrix(5000, 2), force = Matrix(5000, 2), target = Matrix(5000, 2);
  Session() {
    for (Index i = 0; i < 5000; ++i) {
      const double t = 1e-3 * static_cast<double>(i);
      const double way = 0.2 * (minimum_jerk(t - 1.0) - minimum_jerk(t - 3.0));
      position.row(i) << 0.6 * way, 0.8 * way;
      force.row(i) << -3.0, 0.0;
      target.row(i) << (t < 2.5 ? 0.13 : 0.0), (t < 2.5 ? 0.16 : 0.0);
    }
  }
};

TEST(MovementQuality, FindsReachesAndMeasuresThem) {
  const Session session;
  const auto found = movement_quality(session.position, session.force, session.target, Hertz(1000.0));
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_EQ(found->reaches.size(), 2u);
  const Reach& there = found->reaches[0];
  constexpr double kOfThresholds = 0.1;  // 5 % of the peak is reached some way into the movement
  EXPECT_NEAR(there.begin_s, 1.0, kOfThresholds);
  EXPECT_NEAR(there.end_s, 2.0, kOfThresholds);
  EXPECT_EQ(there.peaks, 1);
  EXPECT_NEAR(there.peak_speed, 0.2 * 1.875, 2e-3);
  EXPECT_NEAR(there.distance, 0.2, 2e-3);
  EXPECT_NEAR(*there.path_ratio, 1.0, 1e-6);
  EXPECT_NEAR(*there.endpoint_error, 0.01, 2e-3);
  EXPECT_NEAR(*there.robot_work, 3.0 * 0.12, 6e-3);  // the hand pushes back, the robot moves it
  EXPECT_NEAR(*there.force_angle, std::numbers::pi - std::acos(0.6), 1e-6);
  EXPECT_NEAR(*found->reaches[1].force_angle, std::acos(0.6), 1e-6);
  EXPECT_NEAR(*found->reaches[1].robot_work, -3.0 * 0.12, 6e-3);
}

TEST(MovementQuality, LeavesOutWhatWasNotRecorded) {
  const Session session;
  const auto found = movement_quality(session.position, {}, {}, Hertz(1000.0));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->reaches[0].robot_work || found->reaches[0].force_angle || found->reaches[0].endpoint_error);
}

TEST(MovementQuality, RefusesAHandThatDoesNotReach) {
  EXPECT_EQ(movement_quality(Matrix::Constant(3000, 2, 0.4), {}, {}, Hertz(1000.0)).error().kind, ErrorKind::data);
  const Session session;
  const auto cut = movement_quality(session.position.middleRows(1300, 400), {}, {}, Hertz(1000.0));
  EXPECT_EQ(cut.error().kind, ErrorKind::data);
  Matrix broken = session.position;
  broken(70, 1) = std::nan("");
  EXPECT_NE(movement_quality(broken, {}, {}, Hertz(1000.0)).error().message.find("71"), std::string::npos);
  EXPECT_EQ(movement_quality(session.position, {}, {}, Hertz(1000.0), {.cutoff_hz = 600.0}).error().kind,
            ErrorKind::usage);
}

}  // namespace movement_quality_test
}  // namespace mbk::analyse
