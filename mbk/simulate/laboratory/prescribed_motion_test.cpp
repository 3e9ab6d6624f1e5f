#include "mbk/simulate/laboratory/prescribed_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "mbk/base/numeric/dense.h"

namespace mbk::laboratory {
namespace prescribed_motion_test {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr Hertz kRate{1000.0};

PrescribedMotionOptions options(Protocol protocol, std::uint64_t seed = 1, int axes = 2) {
  PrescribedMotionOptions o;
  o.protocol = protocol;
  o.seed = seed;
  if (axes == 1) {
    o.limb = relaxed_arm_one_axis();
    o.home = Vector::Constant(1, 0.02);
  }
  if (axes == 3) {
    o.limb.M = (Matrix(3, 3) << 1.3, -0.9, 0.2, -0.9, 1.9, 0.1, 0.2, 0.1, 1.1).finished();
    o.limb.B = (Matrix(3, 3) << 5.8, -2.1, 1.0, -2.1, 10.6, 0.5, 1.0, 0.5, 7.0).finished();
    o.limb.K = (Matrix(3, 3) << 42.0, -21.0, 10.0, -36.0, 125.0, 5.0, -10.0, 8.0, 80.0).finished();
    o.limb.x0 = Eigen::Vector3d(0.284, 0.017, 0.103);
    o.home = Eigen::Vector3d(0.28, 0.02, 0.1);
  }
  return o;
}

PrescribedMotionSensors perfect() {
  return {.position_quantum = 0.0, .force_noise = 0.0, .coloured_force_noise = 0.0, .acceleration_noise = 0.0};
}

/// Channels whose names begin with `name`, as columns.
Matrix columns(const Recording& recording, const std::string& name) {
  Matrix found(recording.samples(), 0);
  for (const Channel& channel : recording.channels) {
    if (!channel.name.starts_with(name)) continue;
    found.conservativeResize(Eigen::NoChange, found.cols() + 1);
    found.rightCols(1) = channel.values;
  }
  return found;
}

double deviation(const Vector& v) {
  return std::sqrt((v.array() - v.mean()).square().mean());
}

class EveryProtocol : public testing::TestWithParam<std::tuple<Protocol, int>> {
 protected:
  [[nodiscard]] static PrescribedMotionOptions chosen(std::uint64_t seed = 1) {
    return options(std::get<0>(GetParam()), seed, std::get<1>(GetParam()));
  }
};
INSTANTIATE_TEST_SUITE_P(All, EveryProtocol,
                         testing::Combine(testing::Values(Protocol::sinusoidal, Protocol::underdamped),
                                          testing::Values(1, 2, 3)));

TEST_P(EveryProtocol, KeepsItsEquationSampleBySample) {
  PrescribedMotionOptions o = chosen();
  o.sensors = perfect();
  const Recording recording = record_prescribed_motion(o, kRate).value();
  const PrescribedMotion motion = PrescribedMotion::create(o).value();
  const bool one = o.limb.axes() == 1;
  const Matrix x = columns(recording, one ? "position" : "hand"), a = columns(recording, "acceleration");
  const Matrix force = columns(recording, one ? "reaction" : "force");
  for (Index i = 0; i < recording.samples(); ++i) {
    const Vector v = motion.at(recording.time[i]).first;
    const Vector elastic = o.limb.K * (x.row(i).transpose() - o.limb.x0);
    const Vector residual = force.row(i).transpose() + o.limb.M * a.row(i).transpose() + o.limb.B * v + elastic;
    ASSERT_LE(residual.cwiseAbs().maxCoeff(), 64 * kEps * 10.0) << "sample " << i;  // forces stay below 10 N
  }
}

TEST_P(EveryProtocol, VelocityAndAccelerationAreDerivativesOfThePosition) {
  const PrescribedMotion motion = PrescribedMotion::create(chosen()).value();
  std::vector<double> jumps;
  for (const Event& event : motion.events()) jumps.push_back(event.time);
  const double step = 1e-4;
  for (double t = 0.01; t < motion.duration(); t += 0.0137) {
    bool jump = false;  // the acceleration jumps at an onset
    for (const double time : jumps) jump |= std::abs(t - time) <= step;
    if (jump) continue;
    const auto here = motion.at(t), before = motion.at(t - step), after = motion.at(t + step);
    // h²/6 times |r⃛| < 60 m/s³ and |r⃜| < 4000 m/s⁴ (a fast return of a pulse), and rounding of 0.3 m over 2h
    EXPECT_NEAR(((after.value - before.value) / (2.0 * step) - here.first).norm(), 0.0, 1e-7 + 1e-12) << t;
    EXPECT_NEAR(((after.first - before.first) / (2.0 * step) - here.second).norm(), 0.0, 7e-6) << t;
  }
}

TEST_P(EveryProtocol, SameSeedGivesTheSameBytesAndAnotherSeedOthers) {
  const Recording first = record_prescribed_motion(chosen(1), kRate).value();
  const Recording again = record_prescribed_motion(chosen(1), kRate).value();
  const Recording other = record_prescribed_motion(chosen(2), kRate).value();
  ASSERT_EQ(first.channels.size(), again.channels.size());
  for (std::size_t c = 0; c < first.channels.size(); ++c) {
    EXPECT_EQ(first.channels[c].values, again.channels[c].values) << first.channels[c].name;
    EXPECT_NE(first.channels[c].values.tail(20000), other.channels[c].values.tail(20000)) << first.channels[c].name;
  }
  EXPECT_EQ(first.metadata, again.metadata);
}

TEST_P(EveryProtocol, NoiseLeavesEverythingElseAsItWas) {
  PrescribedMotionOptions loud = chosen();
  loud.sensors.force_noise = 0.3;
  loud.sensors.coloured_force_noise = 0.2;
  const Recording quiet = record_prescribed_motion(chosen(), kRate).value();
  const Recording noisy = record_prescribed_motion(loud, kRate).value();
  for (const std::string name : {"position", "hand", "reference", "acceleration"}) {
    EXPECT_EQ(columns(quiet, name), columns(noisy, name)) << name;
  }
}

TEST(PrescribedMotion, SinusoidalLogIsInTheCircleAndFillsThePublishedWindow) {
  const Recording recording = record_prescribed_motion(options(Protocol::sinusoidal), kRate).value();
  EXPECT_GE(recording.samples(), 62000);
  EXPECT_EQ(recording.time[11999], 12.0);
  Matrix path = columns(recording, "reference");
  path.rowwise() -= Eigen::RowVector2d(0.28, 0.02);
  EXPECT_LE(path.rowwise().norm().maxCoeff(), 0.01 + 1e-15);
  const Matrix window = path.middleRows(11999, 50001);
  EXPECT_GT(window.rowwise().norm().maxCoeff(), 0.0099);
  EXPECT_LT(path.topRows(100).cwiseAbs().maxCoeff(), 1e-6);  // moves in from rest
  const Vector spread = numeric::symmetric_eigenvalues(window.transpose() * window);
  EXPECT_GT(spread[0], 0.2 * spread[1]);  // an area, not a line
}

TEST(PrescribedMotion, InSpaceFillsASphere) {
  const PrescribedMotionOptions o = options(Protocol::sinusoidal, 1, 3);
  const Recording recording = record_prescribed_motion(o, kRate).value();
  Matrix path = columns(recording, "reference");
  ASSERT_EQ(path.cols(), 3);
  path.rowwise() -= o.home.transpose();
  EXPECT_LE(path.rowwise().norm().maxCoeff(), 0.01 + 1e-15);
  const Matrix window = path.middleRows(11999, 50001);
  const Vector spread = numeric::symmetric_eigenvalues(window.transpose() * window);
  EXPECT_GT(spread[0], 0.2 * spread[2]);  // a volume, not a plane
}

TEST(PrescribedMotion, UnderdampedLogIsQuietUntilTheFirstOnset) {
  PrescribedMotionOptions o = options(Protocol::underdamped);
  const Recording recording = record_prescribed_motion(o, kRate).value();
  EXPECT_EQ(recording.events.size(), 32u);
  EXPECT_GT(recording.events.front().time, 16.0);
  EXPECT_GE(recording.time[recording.samples() - 1], recording.events.back().time + 2.9);
  const Matrix reference = columns(recording, "reference");
  for (Index i = 0; recording.time[i] < recording.events.front().time; ++i) {
    ASSERT_EQ(reference.row(i).transpose(), o.home) << "sample " << i;
  }
  EXPECT_NEAR(deviation(columns(recording, "force").col(0).head(16000)), 0.02, 0.0006);  // 5/√(2n) of itself
}

TEST(PrescribedMotion, ColouredNoiseHasItsDeviationAndBandwidth) {
  PrescribedMotionOptions o = options(Protocol::underdamped, 1, 1);
  o.sensors = perfect();
  o.sensors.coloured_force_noise = 0.3;
  o.pulses.quiet = 2000.0;
  const Recording recording = record_prescribed_motion(o, kRate).value();
  Vector noise = columns(recording, "reaction").col(0).head(2000000);
  noise.array() -= noise.mean();
  // Correlation time 1/(2πf) = 0.106 s: 9400 independent values in 2000 s, so 4 % is above 5 standard errors
  EXPECT_NEAR(deviation(noise), 0.3, 0.04 * 0.3);
  const Index lag = 106;
  const Index n = noise.size() - lag;
  EXPECT_NEAR(noise.head(n).dot(noise.tail(n)) / noise.squaredNorm(), std::exp(-2.0 * M_PI * 1.5 * 0.106), 0.06);
}

TEST(PrescribedMotion, PositionsAreMultiplesOfTheQuantum) {
  const Recording recording = record_prescribed_motion(options(Protocol::sinusoidal), kRate).value();
  const Vector steps = columns(recording, "hand").col(0) / 2e-6;
  EXPECT_LE((steps.array() - steps.array().round()).abs().maxCoeff(), 1e-9);
}

TEST(PrescribedMotion, MetadataHoldTheTruth) {
  const Recording recording = record_prescribed_motion(options(Protocol::sinusoidal, 12), kRate).value();
  EXPECT_EQ(recording.metadata.at("seed"), "12");
  EXPECT_EQ(recording.metadata.at("protocol"), "sinusoidal");
  EXPECT_EQ(recording.metadata.at("truth_M"),
            "[[1.3260000000000001, -0.93500000000000005], "
            "[-0.93500000000000005, 1.883]]");
}

TEST(PrescribedMotion, RefusesWhatHasNoMeaning) {
  EXPECT_FALSE(record_prescribed_motion(options(Protocol::sinusoidal), Hertz(0.0)));
  EXPECT_FALSE(record_prescribed_motion(options(Protocol::free), kRate));
  PrescribedMotionOptions o = options(Protocol::sinusoidal);
  o.home = Vector::Zero(1);
  EXPECT_THAT(record_prescribed_motion(o, kRate).error().message, testing::HasSubstr("home"));
  o = options(Protocol::sinusoidal);
  o.limb.x0[1] = NAN;
  EXPECT_FALSE(record_prescribed_motion(o, kRate));
  o = options(Protocol::sinusoidal);
  o.sensors.force_noise = -0.1;
  EXPECT_THAT(record_prescribed_motion(o, kRate).error().message,
              AllOf(testing::HasSubstr("noise"), testing::HasSubstr("-0.1")));
}

}  // namespace prescribed_motion_test
}  // namespace mbk::laboratory
