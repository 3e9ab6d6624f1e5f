#include "mbk/measure/calibration/force_sensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::calibration {
namespace force_sensor_test {

using testing::HasSubstr;

const Eigen::Vector2d kSlope(-8.56, -8.15), kOffset(0.54, 2.3);  // Dyck 2013, eq. E.2
constexpr double kStep = 20.0 / 4096.0;                          // 12 bits over ±10 V [V]

Matrix published_slopes() {
  return kSlope.asDiagonal();
}

/// Loads of ±50 N on one axis after the other, each `repeats` times.
Matrix loads(int repeats, bool both = true) {
  std::vector<Eigen::Vector2d> rows;
  for (int axis = 0; axis < (both ? 2 : 1); ++axis) {
    for (int load = -50; load <= 50; load += 10) {
      for (int k = 0; k < repeats; ++k) rows.push_back(load * Eigen::Vector2d::Unit(axis));
    }
  }
  Matrix F(std::ssize(rows), 2);
  for (std::size_t i = 0; i < rows.size(); ++i) F.row(static_cast<Index>(i)) = rows[i].transpose();
  return F;
}

SensorRun table(const Matrix& force, const Matrix& slope, double noise, std::uint64_t seed, double step = 0.0) {
  numeric::Random random(seed, 1);
  SensorRun run;
  run.source.path = "loads.csv";
  run.axes = {"x", "y"};
  run.force = force;
  const Matrix inverse = numeric::inverse(slope);
  const Vector zero = -inverse * kOffset;
  run.voltage = (force * inverse.transpose()).rowwise() + zero.transpose();
  for (double& v : run.voltage.reshaped()) {
    v += noise * random.normal();
    if (step > 0.0) v = step * std::round(v / step);
  }
  return run;
}

std::vector<std::string_view> codes(const SensorCalibration& calibration) {
  std::vector<std::string_view> all;
  for (const SensorWarning& warning : calibration.warnings) all.push_back(word_of(warning.code));
  return all;
}

Error error_of(const std::vector<SensorRun>& runs, const SensorCalibrationOptions& options = {}) {
  const auto calibration = calibrate_sensor(runs, options);
  EXPECT_FALSE(calibration);
  return calibration ? Error{} : calibration.error();
}

constexpr double kRounding = 1e-10;

TEST(CalibrateSensor, GivesSlopesZerosAndCrosstalkBackFromExactVoltages) {
  const Matrix S = (Matrix(2, 2) << -8.56, 0.12, 0.2, -8.15).finished();
  const auto found = calibrate_sensor({table(loads(1), S, 0.0, 1)}, {});
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_LT((found->slope - S).cwiseAbs().maxCoeff(), kRounding);
  const Matrix C = numeric::inverse(S);
  for (Index i = 0; i < 2; ++i) {
    const SensorAxis& axis = found->axes[static_cast<std::size_t>(i)];
    EXPECT_NEAR(axis.intercept, kOffset[i], kRounding);
    EXPECT_NEAR(axis.zero_voltage, -(C * kOffset)[i], kRounding);
    EXPECT_NEAR(axis.r_squared, 1.0, kRounding);
    EXPECT_NEAR(found->crosstalk(i, 1 - i), C(i, 1 - i) / C(i, i), kRounding);
    EXPECT_EQ(axis.full_scale, 50.0);
    EXPECT_EQ(axis.loads, 11);
  }
  EXPECT_TRUE(codes(*found).empty());
}

/// The same by hand: sums of one axis, the textbook's straight line V = a + C F.
TEST(CalibrateSensor, AgreesWithThePlainSumsOfOneAxis) {
  SensorRun run = table(loads(3, false), published_slopes(), 0.01, 7);
  run.axes = {"x"};
  run.force = run.force.leftCols(1).eval();
  run.voltage = run.voltage.leftCols(1).eval();
  const auto found = calibrate_sensor({run}, {}).value();
  const double N = static_cast<double>(run.force.rows());
  double F = 0, V = 0, FF = 0, FV = 0;
  for (Index i = 0; i < run.force.rows(); ++i) {
    const double f = run.force(i, 0), v = run.voltage(i, 0);
    F += f, V += v, FF += f * f, FV += f * v;
  }
  const double C = (N * FV - F * V) / (N * FF - F * F), a = (V - C * F) / N;
  double rest = 0;
  for (Index i = 0; i < run.force.rows(); ++i) rest += std::pow(run.voltage(i, 0) - a - C * run.force(i, 0), 2);
  const double s2 = rest / (N - 2), error_of_C = std::sqrt(N * s2 / (N * FF - F * F)),
               error_of_a = std::sqrt(s2 * FF / (N * FF - F * F));
  EXPECT_NEAR(found.slope(0, 0), 1.0 / C, kRounding);
  EXPECT_NEAR(found.slope_error(0, 0), error_of_C / (C * C), kRounding);
  EXPECT_NEAR(found.axes[0].zero_voltage, a, kRounding);
  EXPECT_NEAR(found.axes[0].zero_voltage_error, error_of_a, kRounding);
}

TEST(CalibrateSensor, ForceOnVoltageIsFlatterByRSquared) {
  SensorRun run = table(loads(2, false), published_slopes(), 0.5, 3);
  run.axes = {"x"};
  run.force = run.force.leftCols(1).eval();
  run.voltage = run.voltage.leftCols(1).eval();
  const SensorCalibration found = calibrate_sensor({run}, {}).value();
  const ForceOnVoltage& line = found.axes[0].published;
  EXPECT_LT(line.r_squared, 0.995);
  EXPECT_NEAR(line.slope, line.r_squared * found.slope(0, 0), kRounding);
}

/// 95 % of 400 noisy tables: 380 ± 4.4; five standard deviations are allowed.
TEST(CalibrateSensor, StandardErrorsHoldThePublishedFigures) {
  constexpr int kRuns = 400, kMin = 358;
  constexpr double kNoise = 0.04;  // [V]: gives the published standard errors, 0.03 to 0.06 N/V
  const Matrix F = loads(2);
  int slopes[2] = {0, 0}, offsets[2] = {0, 0}, zeros[2] = {0, 0}, crosstalk = 0;
  const double t = 2.02;  // Student, 41 degrees of freedom
  for (int seed = 1; seed <= kRuns; ++seed) {
    const auto found = calibrate_sensor({table(F, published_slopes(), kNoise, static_cast<std::uint64_t>(seed))}, {});
    ASSERT_TRUE(found) << seed;
    for (Index i = 0; i < 2; ++i) {
      const SensorAxis& axis = found->axes[static_cast<std::size_t>(i)];
      slopes[i] += std::abs(found->slope(i, i) - kSlope[i]) < t * found->slope_error(i, i);
      offsets[i] += std::abs(axis.intercept - kOffset[i]) < t * axis.intercept_error;
      zeros[i] += std::abs(axis.zero_voltage + kOffset[i] / kSlope[i]) < t * axis.zero_voltage_error;
    }
    crosstalk += std::abs(found->crosstalk(1, 0)) < t * found->crosstalk_error(1, 0);
  }
  for (const int count : {slopes[0], slopes[1], offsets[0], offsets[1], zeros[0], zeros[1], crosstalk}) {
    EXPECT_GE(count, kMin);
    EXPECT_LE(count, kRuns - 1);
  }
}

TEST(CalibrateSensor, SeesTheStepOfATwelveBitConverterAndItsNewtons) {
  const auto found = calibrate_sensor({table(loads(3), published_slopes(), 0.01, 5, kStep)}, {}).value();
  ASSERT_TRUE(found.axes[0].step);
  EXPECT_NEAR(*found.axes[0].step, kStep, 1e-6 * kStep);
  EXPECT_NEAR(*found.axes[0].step * 8.56, 0.0418, 5e-5);
  EXPECT_NEAR(*found.axes[0].step * 8.56 / std::sqrt(12.0), 0.012, 1e-4);
}

TEST(CalibrateSensor, SaysThatOneStepHidesTheNoise) {
  SensorCalibrationOptions options;
  options.converter = Converter{12, 10.0};
  const auto found =
      calibrate_sensor({table(loads(3), published_slopes(), 0.01 / 8.56 / 10, 5, kStep)}, options).value();
  EXPECT_THAT(codes(found), testing::Contains("noise-below-resolution"));
  options.converter = Converter{10, 10.0};
  EXPECT_THAT(codes(calibrate_sensor({table(loads(3), published_slopes(), 0.01, 5, kStep)}, options).value()),
              testing::Contains("step-contradicts-converter"));
}

TEST(CalibrateSensor, FindsTheNoiseAtConstantLoad) {
  constexpr double kNoise = 0.02;
  const auto found = calibrate_sensor({table(loads(40), published_slopes(), kNoise, 9)}, {}).value();
  EXPECT_NEAR(*found.axes[0].noise, kNoise, 5.0 * kNoise / std::sqrt(2.0 * 880));  // standard error of a deviation
}

TEST(CalibrateSensor, WarnsOfABentLineOfClippingAndOfHysteresis) {
  SensorRun bent = table(loads(2), published_slopes(), 0.001, 1);
  for (Index i = 0; i < bent.force.rows(); ++i) bent.voltage(i, 0) += 5e-5 * bent.force(i, 0) * bent.force(i, 0);
  EXPECT_THAT(codes(calibrate_sensor({bent}, {}).value()), testing::Contains("nonlinear"));

  SensorRun clipped = table(loads(2), published_slopes(), 0.001, 1);
  clipped.voltage = clipped.voltage.cwiseMin(3.0);
  EXPECT_THAT(codes(calibrate_sensor({clipped}, {}).value()), testing::Contains("clipping"));

  SensorRun loose = table(loads(1, false), published_slopes(), 0.0, 1);
  loose.axes = {"x"};
  Matrix up = loose.force.leftCols(1), V = loose.voltage.leftCols(1);
  loose.force.resize(22, 1);
  loose.voltage.resize(22, 1);
  loose.force << up, up.reverse();
  loose.voltage << V.array() + 0.1, V.reverse().array() - 0.1;
  const auto found = calibrate_sensor({loose}, {}).value();
  EXPECT_THAT(codes(found), testing::Contains("hysteresis"));
  EXPECT_NEAR(*found.axes[0].hysteresis, 0.2 * 8.56, 0.02);
}

TEST(CalibrateSensor, WarnsOfFewAndOneSidedLoads) {
  SensorRun run = table(loads(2, true), published_slopes(), 0.001, 1);
  std::vector<Index> rows;
  for (Index i = 0; i < run.force.rows(); ++i) {
    if (run.force.row(i).minCoeff() >= 0.0 && run.force.row(i).maxCoeff() <= 20.0) rows.push_back(i);
  }
  run.force = run.force(rows, Eigen::all).eval();
  run.voltage = run.voltage(rows, Eigen::all).eval();
  const auto warnings = codes(calibrate_sensor({run}, {}).value());
  EXPECT_THAT(warnings, testing::Contains("few-loads"));
  EXPECT_THAT(warnings, testing::Contains("one-sided-loads"));
}

TEST(CalibrateSensor, EachRunHasAZeroOfItsOwnAndTheLastOneCounts) {
  SensorRun first = table(loads(2), published_slopes(), 0.002, 1),
            second = table(loads(2), published_slopes(), 0.002, 2);
  second.voltage.col(0).array() += 0.3;
  const auto found = calibrate_sensor({first, second}, {}).value();
  EXPECT_NEAR(found.slope(0, 0), kSlope[0], 5.0 * found.slope_error(0, 0));
  ASSERT_EQ(found.zero_voltages.size(), 2u);
  EXPECT_NEAR(found.zero_voltages[1][0] - found.zero_voltages[0][0], 0.3, 0.005);
  EXPECT_EQ(found.axes[0].zero_voltage, found.zero_voltages[1][0]);
  EXPECT_THAT(codes(found), testing::Contains("zero-changed"));
}

TEST(CalibrateSensor, RefusesLoadsOnOneLine) {
  SensorRun run = table(loads(2), published_slopes(), 0.001, 1);
  run.force.col(1) = 0.5 * run.force.col(0);
  const Error error = error_of({run});
  EXPECT_EQ(error.kind, ErrorKind::not_usable);
  run.force.col(1).setZero();
  EXPECT_THAT(error_of({run}).line(), AllOf(HasSubstr("load"), HasSubstr("voltage_y")));
  EXPECT_TRUE(calibrate_sensor({table(loads(2), published_slopes(), 0.001, 1)}, {.crosstalk = false}));
}

TEST(CalibrateSensor, RefusesAVoltageThatDoesNotFollow) {
  SensorRun run = table(loads(2), published_slopes(), 0.001, 1);
  run.voltage.col(0).swap(run.voltage.col(1));
  EXPECT_THAT(error_of({run}).message, AllOf(HasSubstr("voltage_x"), HasSubstr("force_x")));
  EXPECT_EQ(error_of({}).kind, ErrorKind::usage);
}

/// A reference at 1 kHz that moves at up to 3 Hz, and a voltage 8.6 ms behind it.
SensorRun moving(double delay, double noise) {
  constexpr Index kSamples = 20'000;
  numeric::Random random(11, 1);
  SensorRun run;
  run.axes = {"x", "y"};
  run.interval = 1e-3;
  run.force.resize(kSamples, 2);
  run.voltage.resize(kSamples, 2);
  const auto force = [](double t) {
    const double w = 2.0 * std::numbers::pi;
    return Eigen::Vector2d(10.0 * std::sin(0.7 * w * t) + 6.0 * std::sin(3.0 * w * t),
                           8.0 * std::sin(1.9 * w * t + 1.0));
  };
  for (Index i = 0; i < kSamples; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    run.force.row(i) = force(t).transpose();
    const Eigen::Vector2d volts = (force(t - delay) - kOffset).cwiseQuotient(kSlope);
    for (Index k = 0; k < 2; ++k) run.voltage(i, k) = volts[k] + noise * random.normal();
  }
  return run;
}

TEST(CalibrateSensor, FindsTheDelayOfAMovingLoadAndTheSlopesBehindIt) {
  constexpr double kDelay = 0.0086;
  const SensorRun run = moving(kDelay, 0.002);
  const auto found = calibrate_sensor({run}, {}).value();
  EXPECT_NEAR(found.delay, kDelay, 2e-4);
  EXPECT_NEAR(found.slope(0, 0), kSlope[0], 2e-3);
  EXPECT_TRUE(found.continuous);
  const auto blind = calibrate_sensor({run}, {.longest_delay = 0.0}).value();
  EXPECT_EQ(blind.delay, 0.0);
  EXPECT_GT(std::abs(blind.slope(0, 0) - kSlope[0]), 0.02);
  EXPECT_EQ(calibrate_sensor({moving(0.0, 0.002)}, {}).value().delay, 0.0);
}

TEST(SensorRun, TurnsTheReferenceIntoTheAxesOfTheLink) {
  Recording recording;
  recording.time = Vector::LinSpaced(3, 0.0, 0.2);
  const Vector theta(Eigen::Vector3d(0.3, 1.2, 2.0));
  Matrix F_S(3, 2);
  F_S << 1, 2, 3, 4, 5, 6;
  Vector fx(3), fy(3);
  for (Index i = 0; i < 3; ++i) {
    const double s = std::sin(theta[i]), c = std::cos(theta[i]);
    fx[i] = s * F_S(i, 0) + c * F_S(i, 1);
    fy[i] = -c * F_S(i, 0) + s * F_S(i, 1);
  }
  recording.channels = {{"force_x", "N", "base", fx},
                        {"force_y", "N", "base", fy},
                        {"voltage_x", "V", "", fx},
                        {"voltage_y", "V", "", fy},
                        {"joint_2", "rad", "joint", theta}};
  const auto run = sensor_run(recording, SensorFrame::automatic);
  ASSERT_TRUE(run);
  EXPECT_LT((run->force - F_S).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_NEAR(*run->interval, 0.1, kRounding);
  EXPECT_EQ(sensor_run(recording, SensorFrame::base)->force.col(0), fx);
  recording.channels.pop_back();
  EXPECT_EQ(sensor_run(recording, SensorFrame::automatic)->force.col(0), fx);
  EXPECT_THAT(sensor_run(recording, SensorFrame::link).error().message, HasSubstr("joint_2"));
}

TEST(SensorRun, RefusesWhatIsNotThereOrNoNumber) {
  Recording recording;
  recording.time = Vector::LinSpaced(2, 0.0, 1.0);
  recording.untimed = true;
  EXPECT_THAT(sensor_run(recording, SensorFrame::automatic).error().message,
              AllOf(HasSubstr("voltage_x"), HasSubstr("voltage_y")));
  recording.channels = {{"voltage_x", "V", "", Vector::Ones(2)}};
  EXPECT_THAT(sensor_run(recording, SensorFrame::automatic).error().message, HasSubstr("force"));
  recording.channels.push_back({"force_x", "N", "base", Vector::Constant(2, std::nan(""))});
  EXPECT_THAT(sensor_run(recording, SensorFrame::automatic).error().message,
              AllOf(HasSubstr("force_x"), HasSubstr("row 1")));
}

TEST(QuantisationStep, IsSeenOnlyWhereThereIsOne) {
  numeric::Random random(1, 1);
  Vector values(40), rounded(40);
  for (Index i = 0; i < 40; ++i) {
    values[i] = random.normal();
    rounded[i] = 0.1 * std::round(values[i] / 0.1);
  }
  EXPECT_FALSE(quantisation_step(values));
  EXPECT_NEAR(quantisation_step(rounded).value(), 0.1, kRounding);
  EXPECT_FALSE(quantisation_step(Vector::LinSpaced(5, 0.0, 1.0)));
  EXPECT_FALSE(quantisation_step(Vector()));
}

}  // namespace force_sensor_test
}  // namespace mbk::calibration
