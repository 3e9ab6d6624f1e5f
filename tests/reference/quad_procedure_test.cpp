#include "tests/reference/quad_procedure.h"

#include <gtest/gtest.h>
#include <quadmath.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "tests/reference/quad_filters.h"
#include "tests/reference/read_log.h"

namespace mbk::reference {
namespace {

using laboratory::PrescribedMotionOptions;

std::vector<double> samples(const Recording& recording, const char* channel) {
  const Vector& values = recording.find(channel)->values;
  return {values.begin(), values.end()};
}

Log as_log(const Recording& r) {
  return {samples(r, "hand_x"),         samples(r, "hand_y"),        samples(r, "force_x"),
          samples(r, "force_y"),        samples(r, "reference_x"),   samples(r, "reference_y"),
          samples(r, "acceleration_x"), samples(r, "acceleration_y")};
}

mbk::Protocol of_laboratory(Protocol protocol) {
  return protocol == Protocol::sinusoidal ? mbk::Protocol::sinusoidal : mbk::Protocol::underdamped;
}

PrescribedMotionOptions noise_free(Protocol protocol) {
  PrescribedMotionOptions options;
  options.protocol = of_laboratory(protocol);
  options.sensors = {.position_quantum = 0.0, .force_noise = 0.0, .acceleration_noise = 0.0};
  return options;
}

Log recorded(const PrescribedMotionOptions& options) {
  return as_log(laboratory::record_prescribed_motion(options, Hertz(1000.0)).value());
}

/// Largest |got − expected| over the largest |expected|, as checks of this project count it.
template <class Got, class Expected>
double difference(const Got& got, const Expected& expected) {
  double worst = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    worst = std::max(worst, std::abs(got[i] - expected[i]));
    scale = std::max(scale, std::abs(expected[i]));
  }
  return worst / scale;
}

std::array<double, 4> by_row(const Matrix& m) {
  return {m(0, 0), m(0, 1), m(1, 0), m(1, 1)};
}

void expect_truth(const Answer& answer, const impedance::Model& truth, double tolerance) {
  EXPECT_LE(difference(answer.M, by_row(truth.M)), tolerance);
  EXPECT_LE(difference(answer.B, by_row(truth.B)), tolerance);
  EXPECT_LE(difference(answer.K, by_row(truth.K)), tolerance);
  EXPECT_LE(difference(answer.x0, std::array{truth.x0[0], truth.x0[1]}), tolerance);
}

class Golden : public testing::TestWithParam<std::pair<std::string, Protocol>> {};
INSTANTIATE_TEST_SUITE_P(Logs, Golden,
                         testing::Values(std::pair{std::string("sinusoidal"), Protocol::sinusoidal},
                                         std::pair{std::string("underdamped"), Protocol::underdamped}),
                         [](const auto& log) { return std::string(log.param.first); });

TEST_P(Golden, AgreesToTheLastDigitsOfADouble) {
  const char* folder = std::getenv("MBK_DATA_DIR");
  if (!folder) GTEST_SKIP() << "MBK_DATA_DIR is not set";
  const auto [name, protocol] = GetParam();
  const std::filesystem::path golden = std::filesystem::path(folder) / "golden";
  const auto expected = nlohmann::json::parse(std::ifstream(golden / "expected.json"))[name]["quad"];
  const auto log = read_log((golden / (std::string(name) + ".mat")).string());
  ASSERT_TRUE(log) << log.error().line();
  const auto answers = identify(*log, {.protocol = protocol});
  ASSERT_TRUE(answers) << answers.error().line();
  const Answer& answer = answers->split;
  const double kLastDigit = 4.5e-16;  // both sides are rounded to double: half a unit each, 2.2e-16, of the largest
  EXPECT_LE(difference(answer.M, expected["M"].get<std::vector<double>>()), kLastDigit);
  EXPECT_LE(difference(answer.B, expected["B"].get<std::vector<double>>()), kLastDigit);
  EXPECT_LE(difference(answer.K, expected["K"].get<std::vector<double>>()), kLastDigit);
  EXPECT_LE(difference(answer.x0, expected["x0"].get<std::vector<double>>()), kLastDigit);
  EXPECT_LE(difference(answer.VAF, expected["VAF"].get<std::vector<double>>()), kLastDigit);
}

/// max |H_d(f)/((j2πf)^d H₀(f)) − 1| over d = 1, 2: how far the derivative filters are from the derivatives of the
/// smoothed signal at f. Smoothing alike cancels in the regression, and this is what remains.
double derivative_mismatch(int window, double frequency_hz) {
  const Quad omega = 2 * acosq(-1) * frequency_hz;
  const int h = (window - 1) / 2;
  Quad gain[3] = {0, 0, 0};  // real parts of H₀ and −H₂/ω², imaginary part of H₁/ω: the rest is zero by symmetry
  for (int d = 0; d <= 2; ++d) {
    const Signal weights = savitzky_golay_weights(6, window, d, Quad(1) / 1000);
    for (int j = -h; j <= h; ++j) {
      const Quad angle = omega * j / 1000;
      const Quad basis = d == 0 ? cosq(angle) : d == 1 ? sinq(angle) / omega : -cosq(angle) / (omega * omega);
      gain[d] += weights[static_cast<std::size_t>(j + h)] * basis;
    }
  }
  return static_cast<double>(fmaxq(fabsq(gain[1] / gain[0] - 1), fabsq(gain[2] / gain[0] - 1)));
}

constexpr double kHighestLine = 2.9;     // [Hz] of the sines
constexpr double kHighestOfPulse = 6.0;  // [Hz]: the 5 Hz filter leaves 14 % there, 3 % at 7 Hz

TEST(NoiseFree, GivesTheTruthOfSinesUpToTheSmoothing) {
  const PrescribedMotionOptions options = noise_free(Protocol::sinusoidal);
  const auto answers = identify(recorded(options), {.protocol = Protocol::sinusoidal});
  ASSERT_TRUE(answers) << answers.error().line();
  expect_truth(answers->split, options.limb, derivative_mismatch(101, kHighestLine));
  for (const double vaf : answers->split.VAF) EXPECT_GT(vaf, 99.9999);
}

TEST(NoiseFree, GivesTheTruthOfPulsesUpToTheSmoothing) {
  const PrescribedMotionOptions options = noise_free(Protocol::underdamped);
  const auto answers = identify(recorded(options), {.protocol = Protocol::underdamped});
  ASSERT_TRUE(answers) << answers.error().line();
  expect_truth(answers->split, options.limb, derivative_mismatch(101, kHighestOfPulse));
  expect_truth(answers->all, options.limb, derivative_mismatch(101, kHighestOfPulse));
  EXPECT_NE(answers->split.M, answers->all.M);
  EXPECT_EQ(answers->split.VAF, answers->all.VAF);  // of the split in both
  for (const double vaf : answers->split.VAF) EXPECT_GT(vaf, 99.999);
}

TEST(NoiseFree, Chapter5RemovesTheHandleFromTheInertia) {
  PrescribedMotionOptions options = noise_free(Protocol::sinusoidal);
  const impedance::Model arm = options.limb;
  const double handle_mass = 0.194;  // Λ (Dyck 2013, §3.5.2)
  options.limb.M += handle_mass * Matrix::Identity(2, 2);
  const auto answers =
      identify(recorded(options),
               {.procedure = Procedure::chapter5, .protocol = Protocol::sinusoidal, .handle_mass = handle_mass});
  ASSERT_TRUE(answers) << answers.error().line();
  expect_truth(answers->split, arm, derivative_mismatch(151, kHighestLine));
}

TEST(QuadProcedure, RefusesWhatItCannotRead) {
  Log log;
  EXPECT_FALSE(identify(log, {}));
  log.x = log.y = log.Fx = log.Fy = log.xr = log.yr = std::vector<double>(62000, 1.0);
  log.Fy.pop_back();
  const auto says = [&](const char* fact, const Settings& settings = {}) {
    return identify(log, settings).error().message.find(fact) != std::string::npos;
  };
  EXPECT_TRUE(says("Fy") && says("61999") && says("62000"));
  log.Fy.push_back(NAN);
  EXPECT_TRUE(says("Fy") && says("sample 61999"));
  EXPECT_TRUE(says("mass", {.procedure = Procedure::chapter5}));
  EXPECT_FALSE(read_log("/nowhere/log.mat"));
}

}  // namespace
}  // namespace mbk::reference
